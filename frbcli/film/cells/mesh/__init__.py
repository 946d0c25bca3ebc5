"""Cells on a section: their boundaries, the openings in them, the flow around bores."""
