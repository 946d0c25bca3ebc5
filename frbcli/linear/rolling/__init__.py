"""The sheet of ball bearings."""
