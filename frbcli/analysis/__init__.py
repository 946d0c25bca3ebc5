"""What can be learned from a run."""
