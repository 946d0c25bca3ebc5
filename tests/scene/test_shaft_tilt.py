"""The tilt of journals that `frb check` states: closed forms of beams, and how it reaches the gap."""

import json
import math

import pytest

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cli.main import run as frb
from frbcli.scene.machine.findings import film_tilts, findings

L, D, E, RHO = 0.2, 0.01, 2.1e11, 7850.0
SECOND, AREA = math.pi / 64.0 * D**4, math.pi / 4.0 * D**2
HEAVY, U, WIDTH, C = 0.4, 2e-6, 0.012, 30e-6


def between_two_films(speed_Hz: float, *more: str) -> Case:
    """A shaft that ends in its bearings, with a disk in the middle."""
    film = f'{{kind = "single-film", width = "{WIDTH} m", diameter = "{D} m", clearance = "{C} m"'
    settings = (
        'rotor={kind = "turbocharger", modes = 60}',
        f'shaft=[{{length = "{L} m", diameter = "{D} m", density = "{RHO} kg/m^3", youngs_modulus = "{E} Pa"}}]',
        f'bearing=[{film}, name = "left", position = "0 m"}}, {film}, name = "right", position = "{L} m"}}]',
        f'disk=[{{position = "{0.5 * L} m", mass = "{HEAVY} kg", unbalance = "{U} kg*m"}}]',
        f"speed.to={speed_Hz} Hz",
    )
    return load_case("jeffcott", [*settings, *more])


def test_a_beam_on_two_supports_bends_by_its_weight() -> None:
    """Slope at the ends of a simply supported beam: q L^3 / (24 E I) by its own weight, F L^2 / (16 E I) by a force in
    the middle; shear does not turn the cross-sections there."""
    tilts = film_tilts(between_two_films(10.0))
    slope = RHO * AREA * 9.81 * L**3 / (24.0 * E * SECOND) + HEAVY * 9.81 * L**2 / (16.0 * E * SECOND)
    assert [film.film for film in tilts] == ["left", "right"]
    assert [film.weight for film in tilts] == pytest.approx([slope, slope], rel=1e-4)
    assert tilts[0].bent == pytest.approx((tilts[0].weight + tilts[0].unbalance) * 0.5 * WIDTH / C)


def test_unbalance_bends_as_a_force_that_turns_does() -> None:
    """Far below the natural frequency U Omega^2 L^2 / (16 E I)."""
    slow = film_tilts(between_two_films(2.0))[0]
    force = U * (2.0 * math.pi * 2.0) ** 2
    assert slow.unbalance == pytest.approx(force * L**2 / (16.0 * E * SECOND), rel=1e-3)
    fast = film_tilts(between_two_films(40.0))[0]
    assert fast.unbalance / slow.unbalance > 1.03 * 400.0  # nearer to the natural frequency


def test_cone_and_what_has_none() -> None:
    tilts = film_tilts(between_two_films(10.0))
    assert tilts[0].cone == pytest.approx(2.0 * C / L)
    assert tilts[0].whirling == pytest.approx(2.0 * C / L * 0.5 * WIDTH / C)
    assert film_tilts(load_case("jeffcott")) == ()  # moves in its plane alone
    assert film_tilts(load_case("seal")) == ()  # without films
    rings = findings(load_case("turbocharger-car")).tilts
    assert [film.film for film in rings] == ["compressor inner", "turbine inner"]  # rings do not tilt
    assert all(film.cone == pytest.approx(2.0 * 50e-6 / 32e-3) for film in rings)


def test_check_tells_a_tilt_that_matters(capsys: pytest.CaptureFixture[str]) -> None:
    assert frb(["check", "turbocharger-car", "--json"]) == 0
    said = capsys.readouterr()
    tilts = json.loads(said.out)["findings"]["tilts"]
    assert tilts[0]["cone_rad"] == pytest.approx(3.125e-3)
    assert frb(["check", "turbocharger-car"]) == 0
    assert "as journals tilt" in capsys.readouterr().out
    assert frb(["check", "jeffcott"]) == 0
    assert "tilt" not in capsys.readouterr().out
