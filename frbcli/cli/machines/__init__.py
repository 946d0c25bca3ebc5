"""Commands for the machine about its static equilibrium: stability, modes, response, limit cycles."""
