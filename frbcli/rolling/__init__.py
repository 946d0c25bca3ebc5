"""Ball bearings: Hertz contacts, equilibrium of balls, force and stiffness of the rings; knows no rotor and no case."""
