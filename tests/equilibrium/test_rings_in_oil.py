"""Small motions of machines whose rings turn in films that keep their oil: the speeds of the rings follow them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from films import ROUGH

import frbcli
from frbcli.equilibrium import dynamic_films, static_films
from frbcli.equilibrium.ring_speed import across
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines
from frbcli.linear.response import forced_motion
from frbcli.linear.stability_point import eigenvalues, linear_machine, machine_rotor, point_at_rest

SPEED = 60.0
OMEGA = 2.0 * math.pi * SPEED
FEW = (((24, 4), 2.0), ((12, 2), -1.0))


def at_rest(pressure: str, *settings: str, omega: float = OMEGA) -> MachineAtRest:
    """A floating ring in Elrod's films between circumferential grooves."""
    groove = f'{{kind="circumferential-groove", pressure="{pressure}"}}'
    supplies = [f"bearing.{film}.supply={groove}" for film in ("inner", "outer")]
    case = frbcli.load_case("floating-ring", [*supplies, "film.cavitation=elrod", "rotor.unbalance=1 g*mm", *settings])
    return StaticMachines(case, memory=True).at(omega)


@pytest.fixture(autouse=True)
def few_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dynamic_films, "MESHES", FEW)
    monkeypatch.setattr(dynamic_films, "PLACES", 1)
    monkeypatch.setattr(static_films, "CELLS", (48, 6))
    monkeypatch.setattr(static_films, "COARSER", ((24, 4),))


def test_full_films_beside_rings_are_those_without_memory() -> None:
    """Z(s) = K + s C of full films, and their speeds move them as half of a motion across. The machine then is that
    whose state matrix knows of no oil, its ring with it."""
    machine = at_rest("30 bar")
    slopes = [film.own.at(1.0j) for film in machine.dynamic]
    for film, (z, slope) in zip(machine.dynamic, slopes, strict=True):
        size = np.abs(slope[:, :2]).max()
        for s in (0.5j * OMEGA, -0.2 * OMEGA):
            np.testing.assert_allclose(film.own.at(s)[0], z + (s - 1.0j) * slope, atol=1e-9 * abs(s) * size)
    for place, (_, slope) in zip(machine.at_rest.position.journals, slopes, strict=True):
        turned = 0.5 * slope[:, :2] @ across(place)
        np.testing.assert_allclose(slope[:, 2], turned, atol=0.05 * np.abs(turned).max())
    stiffness, damping = (np.array([part(z[:, :2]) for z, _ in slopes]) for part in (np.real, np.imag))
    known = eigenvalues(machine_rotor(machine, frequency=1.0), OMEGA, stiffness, damping)
    found = point_at_rest(machine, SPEED).eigenvalues
    slow = known[known.real > -0.99 * OMEGA]
    assert len(found) >= len(slow) >= 5
    assert np.count_nonzero(slow.imag == 0.0) % 2 == 1  # one of the speed of the ring
    for value in slow:
        assert np.abs(found - value).min() < 1e-7 * abs(value)


@pytest.mark.parametrize(("speed", "surfaces"), [(60.0, ()), (8.0, ROUGH)], ids=["smooth", "rough"])
def test_a_forced_motion_is_that_of_machine_and_oil(speed: float, surfaces: tuple[str, ...]) -> None:
    """With coefficients at the frequency of the force, and the ring that they turn; of summits with their own."""
    omega = 2.0 * math.pi * speed
    machine, nu = at_rest("2 bar", *surfaces, omega=omega), 0.8 * omega
    assert any(film.summits.place.any() for film in machine.dynamic) == bool(surfaces)
    rotor, linear = machine_rotor(machine, frequency=nu), linear_machine(machine)
    z = [film.own.at(1j * nu)[0][:, :2] for film in machine.dynamic]
    load = np.arange(1.0, 1.0 + rotor.size) + 0.0j
    load[-1] = 0.01  # N m on the ring
    found = forced_motion(
        rotor, omega, (nu, load), np.array([each.real for each in z]), np.array([each.imag for each in z]) / nu
    )
    matrix, _ = linear.at(1j * nu, [film.own for film in machine.dynamic])
    expected = np.linalg.solve(matrix, load)
    expected[-1] /= 1j * nu  # its angle, of its speed
    np.testing.assert_allclose(found, expected, rtol=1e-8)
    assert abs(found[-1]) > 0.0
