"""Commands for the machine about its resting position: stability, modes, response, limit cycles."""
