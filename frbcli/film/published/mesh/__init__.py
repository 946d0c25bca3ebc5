"""Quadratic elements on a section."""
