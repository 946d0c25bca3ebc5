"""The machine out of bodies and of what lies between their nodes, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.errors import NotConverged
from frbcli.rotor.assembly import Link, assembled, held_rotor, point_mass
from frbcli.rotor.loads import LinearPart
from frbcli.scene.machine.rotor import make_rotor

GRAVITY = 9.81


def springs(x: float, y: float, damping: float = 0.0) -> LinearPart:
    return LinearPart(np.zeros(1), np.diag([x, y])[None], damping * np.eye(2)[None], np.zeros((1, 2, 2)))


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


def test_an_element_sees_the_coordinates_that_it_asks_for() -> None:
    one = LinearPart(np.zeros(1), np.array([[[7e5]]]), np.zeros((1, 1, 1)), np.zeros((1, 1, 1)))
    machine = assembled([point_mass("journal", 2.0, GRAVITY)], parts=[(Link("journal", sees=("y",)), one)])
    assert machine.stiffness.tolist() == [[0.0, 0.0], [0.0, 7e5]]


def test_a_node_that_no_body_has() -> None:
    with pytest.raises(KeyError):
        assembled([point_mass("journal", 2.0, GRAVITY)], [Link("journal", "housing")])


def test_bearings_at_one_place_hold_no_rotor_whatever_the_last_digits_say() -> None:
    """On the shaft of a turbocharger; a micrometre apart they hold it, and carry its weight together."""
    at = "bearing.1.position={} mm"
    rotor, apart = (make_rotor(load_case("turbocharger-car", [at.format(place)])) for place in ("42", "42.001"))
    with pytest.raises(NotConverged, match="different positions"):
        held_rotor(rotor)
    carried = held_rotor(apart).load.reshape(-1, 2).sum(axis=0)
    placed = held_rotor(make_rotor(load_case("turbocharger-car"))).load.reshape(-1, 2).sum(axis=0)
    assert carried == pytest.approx(placed, rel=1e-6)
