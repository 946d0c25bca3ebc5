"""Kinematic bearing tests (section 4.2.2): rotation, squeeze, whirl."""
