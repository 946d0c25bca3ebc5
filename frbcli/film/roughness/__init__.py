"""Rough surfaces that touch: pressure of their summits over the gap, boundary friction."""
