"""Spectra over time and speed."""
