"""Multipliers of limit cycles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from cycle_machines import diagram, machine_of, rigid
from marches import planned_system

from frbcli.cycles.method.balance import multipliers, packed, state_space
from frbcli.cycles.method.equilibria import resting_curve


def test_multipliers_next_to_rest_are_those_of_the_eigenvalues() -> None:
    """A cycle of almost no size: exp(lambda T) of the eigenvalues at the Hopf point, 1 for the critical pair."""
    case = rigid(1.313, 2.4, 2.9)
    machine = machine_of(case)
    system = planned_system(case)
    (hopf,) = resting_curve(system, machine, 2.0 * math.pi * case.speed.start, 2.0 * math.pi * case.speed.end).hopf
    motion = np.zeros((3, 2), dtype=complex)
    motion[0], motion[1] = hopf.equilibrium.u, 1e-7 * hopf.mode
    y = np.concatenate([packed(motion), [hopf.nu / machine.pace, hopf.equilibrium.omega / machine.pace]])
    found = np.sort(np.abs(multipliers(machine, state_space(machine), y).values))
    expected = np.sort(np.abs(np.exp(2.0 * math.pi / hopf.nu * hopf.equilibrium.eigenvalues)))
    np.testing.assert_allclose(found, expected, atol=1e-6)


@pytest.mark.parametrize("gamma", [4.538, 1.313])
def test_the_trivial_multiplier_is_one(gamma: float) -> None:
    """To 1e-6, at folds as well, where a second multiplier is 1."""
    points = diagram(gamma, 2.4, 2.9).branches[0].points
    for point in points:
        assert abs(point.multipliers[0] - 1.0) < 1e-6
        if point.kind == "fold":
            assert np.abs(point.multipliers[1:] - 1.0).min() < 1e-5
    assert any(point.kind == "fold" for point in points)
