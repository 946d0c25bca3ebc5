"""Balancing by influence coefficients: correction masses from the synchronous motion of a run."""
