"""Rotors: every kind builds one linear system that the time loop integrates. Depends on: errors. Knows no film."""
