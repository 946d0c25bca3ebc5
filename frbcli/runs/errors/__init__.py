"""The errors that a run states."""
