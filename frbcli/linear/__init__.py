"""Resting positions, stability, natural modes."""
