"""The scene: what has to be modelled for a case, what is left out, and why. Depends on: case, film, rotor, errors."""
