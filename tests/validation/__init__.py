"""What frb computes beside what the dissertation prints; `validate.py` writes docs/validation.md from it."""
