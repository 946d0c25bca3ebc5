"""The machine out of bodies and of what lies between their nodes, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from frbcli.arrays import Array
from frbcli.rotor.assembly import LinearRotor, Link, assembled, held_rotor
from frbcli.rotor.body import jeffcott_rotor, point_mass
from frbcli.rotor.loads import LinearPart

GRAVITY = 9.81


def springs(x: float, y: float, damping: float = 0.0) -> LinearPart:
    return LinearPart(np.zeros(1), np.diag([x, y])[None], damping * np.eye(2)[None], np.zeros((1, 2, 2)))


def frequencies(machine: LinearRotor) -> Array:
    """(n,) rad/s, undamped, ascending."""
    values = np.linalg.eigvals(np.linalg.solve(machine.mass, machine.stiffness))
    return np.sqrt(np.sort(values.real))


def test_a_rigid_rotor_in_two_linear_supports() -> None:
    """m x'' + 2 k x = 0."""
    supports = [(Link("journal", count=2.0), springs(3e6, 5e6))]
    machine = assembled([point_mass("journal", 4.0, GRAVITY)], parts=supports)
    assert frequencies(machine) == pytest.approx([math.sqrt(2 * k / 4.0) for k in (3e6, 5e6)], rel=1e-9)
    assert held_rotor(machine).shape == pytest.approx([0.0, -4.0 * GRAVITY / (2 * 5e6)], rel=1e-9)


def test_a_rotor_on_a_support_with_mass() -> None:
    """Two masses m and M in series, k between them and K to the ground: m M w^4 - (m (k + K) + M k) w^2 + k K = 0."""
    m, mass, k, ground = 4.0, 1.5, 3e6, 8e6
    bodies = [point_mass("journal", m, GRAVITY), point_mass("support", mass, GRAVITY)]
    parts = [(Link("journal", "support"), springs(k, k)), (Link("support"), springs(ground, ground))]
    machine = assembled(bodies, parts=parts)
    squares = np.sort(np.roots([m * mass, -(m * (k + ground) + mass * k), k * ground]).real)
    assert frequencies(machine) == pytest.approx(np.sqrt(np.repeat(squares, 2)), rel=1e-9)
    sag = (m + mass) * GRAVITY / ground
    assert held_rotor(machine).shape == pytest.approx([0.0, -sag - m * GRAVITY / k, 0.0, -sag], rel=1e-9)


def test_a_jeffcott_rotor_in_its_supports_is_a_chain_in_series() -> None:
    """A massless support of 2 k in series with the shaft c: w^2 = c k' / (m (c + k'))."""
    shaft = jeffcott_rotor(5.0, 1e-9, 2e7, 0.0, 0.0, 0.0, GRAVITY)
    machine = assembled([shaft], parts=[(Link("journal", count=2.0), springs(6e6, 6e6))])
    series = 2e7 * 12e6 / (2e7 + 12e6)
    assert frequencies(machine)[:2] == pytest.approx([math.sqrt(series / 5.0)] * 2, rel=1e-9)


def test_a_film_between_a_journal_and_a_support_on_springs() -> None:
    """The film sees the motion of the journal in its shell, which the support moves: rest is the film's own sag in
    series with that of the springs."""
    bodies = [point_mass("journal", 0.5, GRAVITY), point_mass("shell", 0.2, GRAVITY)]
    machine = assembled(bodies, [Link("journal", "shell")], [(Link("shell"), springs(2e6, 2e6))])
    assert machine.journals.tolist() == [[[1.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, -1.0]]]
    held = held_rotor(machine)
    assert held.load == pytest.approx([0.0, -0.5 * GRAVITY], rel=1e-12)  # on the film, whatever carries its shell
    assert held.stiffness == pytest.approx(np.zeros((2, 2)), abs=1e-6)
    sag = 0.7 * GRAVITY / 2e6
    at = np.array([3e-6, -9e-6])
    assert held.shape + held.following @ at == pytest.approx([at[0], at[1] - sag, 0.0, -sag], rel=1e-9)


def test_damping_between_two_bodies_slows_none_that_moves_with_the_other() -> None:
    bodies = [point_mass("journal", 2.0, GRAVITY), point_mass("shell", 0.2, GRAVITY)]
    machine = assembled(bodies, parts=[(Link("journal", "shell"), springs(0.0, 0.0, damping=300.0))])
    together, apart = np.array([1.0, 0.0, 1.0, 0.0]), np.array([1.0, 0.0, -1.0, 0.0])
    assert not (machine.damping @ together).any()
    assert machine.damping @ apart == pytest.approx([600.0, 0.0, -600.0, 0.0])


def test_an_element_sees_the_coordinates_that_it_asks_for() -> None:
    one = LinearPart(np.zeros(1), np.array([[[7e5]]]), np.zeros((1, 1, 1)), np.zeros((1, 1, 1)))
    machine = assembled([point_mass("journal", 2.0, GRAVITY)], parts=[(Link("journal", sees=("y",)), one)])
    assert machine.stiffness.tolist() == [[0.0, 0.0], [0.0, 7e5]]


def test_a_node_that_no_body_has() -> None:
    with pytest.raises(KeyError):
        assembled([point_mass("journal", 2.0, GRAVITY)], [Link("journal", "housing")])
