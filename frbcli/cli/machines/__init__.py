"""Commands for bearings, and for the machine about its static equilibrium: stability, modes, response, limit cycles."""
