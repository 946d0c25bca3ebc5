"""What a run records, and how it is taken up again."""
