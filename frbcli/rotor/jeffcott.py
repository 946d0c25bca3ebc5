"""The symmetric Jeffcott rotor (2.4): a disk on a massless flexible shaft, two equal journals moving as one."""

from __future__ import annotations

import numpy as np

from frbcli.rotor.linear import Array, LinearRotor, planar


def jeffcott_rotor(
    mass: float,
    journal_mass: float,
    shaft_stiffness: float,
    unbalance: float,
    external_damping: float,
    shaft_damping: float,
    gravity: float,
) -> LinearRotor:
    """Masses m_D, m_J in kg, stiffness c in N/m, unbalance U of the disk in kg m, dampings d_o, d_i in N s/m,
    gravity in m/s^2. q = [x_J, x_D, y_J, y_D]."""
    coupling = np.array([[1.0, -1.0], [-1.0, 1.0]])
    weight = -gravity * np.array([journal_mass, mass])
    journal, disk = planar(4, 0, 2), planar(4, 1, 3)
    return LinearRotor(
        mass=_both_planes(np.diag([journal_mass, mass])),
        damping=_both_planes(shaft_damping * coupling + np.diag([0.0, external_damping])),
        gyroscopic=np.zeros((4, 4)),
        stiffness=_both_planes(shaft_stiffness * coupling),
        static_load=np.concatenate([np.zeros(2), weight]),
        unbalance_cos=np.array([0.0, unbalance, 0.0, 0.0]),
        unbalance_sin=np.array([0.0, 0.0, 0.0, unbalance]),
        journals=journal[None],
        multiplicity=np.array([2.0]),
        points=(("journal", journal), ("disk", disk)),
    )


def _both_planes(matrix: Array) -> Array:
    """The (2, 2) matrix of one plane for q = [x_J, x_D, y_J, y_D]."""
    return np.asarray(np.kron(np.eye(2), matrix), dtype=np.float64)
