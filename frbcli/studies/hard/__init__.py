"""Hard cases: what happens at the limits, each in a process of its own."""
