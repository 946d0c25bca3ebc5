"""The time loop of a film in the published two-phase form."""
