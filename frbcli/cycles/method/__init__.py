"""Equations of equilibria and cycles, their continuation and stability."""
