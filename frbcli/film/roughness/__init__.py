"""Surfaces that touch: rough ones, by the pressure of their summits over the gap, and smooth ones on elastic shells."""
