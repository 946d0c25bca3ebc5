"""Bearings of one's own: a function gives the force of a whole bearing from displacement, velocity and speed."""
