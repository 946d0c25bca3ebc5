"""How films can be computed, as plans choose it: one file for each form, with its cost and what it is not made for."""
