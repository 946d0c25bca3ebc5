"""Equation (4.31) on quadratic elements, compiled: its law, its unknowns, its matrix and their elimination."""
