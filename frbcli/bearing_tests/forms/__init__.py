"""Tests of films that are not solved on cells: the short bearing."""
