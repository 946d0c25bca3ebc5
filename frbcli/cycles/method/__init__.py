"""The machine, its equations of equilibria and cycles, their continuation and stability."""
