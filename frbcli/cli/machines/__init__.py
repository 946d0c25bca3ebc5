"""What is printed of a machine at rest: stability, modes, response, limit cycles."""
