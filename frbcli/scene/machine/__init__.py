"""The machine of a planned case: rotor, films, heat."""
