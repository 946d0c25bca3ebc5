"""One implicit stage of a step, compiled: the rotor's inverse, Newton's method for the journals, their contact."""
