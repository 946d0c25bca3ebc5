"""The time loop of a co-simulation (section 5.2.1): rotor and films advanced in turn."""
