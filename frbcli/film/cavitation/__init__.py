"""Cavitation models, a class each: how pressure, oil fraction and oil from nowhere hang together in a cell.

Every law is written in one unknown w per cell, in which it is neither steep nor flat anywhere:

    w = (p - p_cav) / p_reference - (what the law gives up where it cavitates),

so that w > 0 is the scaled pressure of a full film and w < 0 is, nearly, the missing oil (theta - 1) or the source
that the law needs. Newton's method then does not feel how steep theta(p) is.
"""
