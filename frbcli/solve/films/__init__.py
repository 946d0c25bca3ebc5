"""The films in the time loop, compiled: one file for each kind that has a state."""
