"""Tests of films that are not solved on cells: the published form, the short bearing, bearing models."""
