"""Measures what the program says of its own error and cost; see report.py."""
