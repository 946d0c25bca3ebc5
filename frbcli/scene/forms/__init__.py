"""How films can be computed, as plans choose it: forms of films, each with its cost and what it is not made for."""
