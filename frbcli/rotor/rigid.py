"""The symmetric rigid rotor (2.3): a point mass on two equal bearings."""

from __future__ import annotations

import numpy as np

from frbcli.rotor.linear import LinearRotor, planar


def rigid_rotor(mass: float, unbalance: float, external_damping: float, gravity: float) -> LinearRotor:
    """mass in kg, unbalance U in kg m, external_damping in N s/m, gravity in m/s^2. q = [x_J, y_J]."""
    journal = planar(2, 0, 1)
    return LinearRotor(
        mass=mass * np.eye(2),
        damping=external_damping * np.eye(2),
        gyroscopic=np.zeros((2, 2)),
        stiffness=np.zeros((2, 2)),
        static_load=np.array([0.0, -mass * gravity]),
        unbalance_cos=np.array([unbalance, 0.0]),
        unbalance_sin=np.array([0.0, unbalance]),
        journals=journal[None],
        multiplicity=np.array([2.0]),
        points=(("journal", journal),),
    )
