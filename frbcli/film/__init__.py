"""Films: pressure, forces and their derivatives from the relative motion of journal and shell.

Depends on: errors. Knows no rotor.

Conventions (docs/conventions.md): phi = 0 at the top, counter-clockwise; H = 1 + d . n with n = (sin phi, -cos phi);
forces act on the journal; pressures inside this package are gauge pressures over the ambient pressure p_0, divided by
12 eta / psi^2, so that (3.9) reads  d/dphi(H^3 dP/dphi) + (R/b)^2 d/dz(H^3 dP/dz) = w . n  with P in 1/s.
w = d' - (omega/2) J d is the velocity of the journal as seen from a frame that turns with half the speed: rotation,
squeeze and whirl enter a rectangular film through these two numbers alone (4.5).
"""
