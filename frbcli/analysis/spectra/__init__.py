"""Spectra of signals over time."""
