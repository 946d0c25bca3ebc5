"""Penalty films without openings, tabulated over eccentricity, direction of motion and speed."""
