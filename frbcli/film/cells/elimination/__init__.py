"""Linear equations of cells around a ring, compiled."""
