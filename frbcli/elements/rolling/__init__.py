"""Ball bearings: Hertz contacts, balls between grooves, forces of the rings, rest, rating life, and their element."""
