"""What `frb check` finds before the plan: masses, loads, natural frequencies, Sommerfeld numbers."""

import json
import math

import pytest

from frbcli.case.reading.load import load_case
from frbcli.cli.main import run as frb
from frbcli.scene.machine.findings import findings


def test_of_a_jeffcott_rotor() -> None:
    found = findings(load_case("jeffcott"))
    assert found.mass == pytest.approx(6.1)
    assert found.frequencies_Hz == (pytest.approx(math.sqrt(5e6 / 6.0) / (2.0 * math.pi)),)
    (film,) = found.films
    assert film.load == pytest.approx(0.5 * 6.1 * 9.81)
    assert film.mean_pressure == pytest.approx(film.load / (0.02 * 0.025))
    # (3.14): F psi^2 / (B D eta omega)
    psi, omega = 35e-6 / 0.0125, 2.0 * math.pi * 300.0
    assert film.sommerfeld_number == pytest.approx(film.load * psi**2 / (0.02 * 0.025 * 0.012 * omega))


@pytest.mark.parametrize("name", ["turbocharger-car", "turbocharger-heavy"])
def test_bearings_carry_the_weight_and_outer_films_their_rings(name: str) -> None:
    case = load_case(name)
    found = findings(case)
    inner = sum(film.load for film in found.films if "inner" in film.film)
    assert found.mass is not None
    assert inner == pytest.approx(9.81 * found.mass, rel=1e-9)
    outer = sum(film.load for film in found.films if "outer" in film.film)
    rings = sum(bearing.ring_mass for bearing in case.bearings)  # type: ignore[union-attr]
    assert outer - inner == pytest.approx(9.81 * rings, rel=1e-9)
    solid = sum(0.25 * math.pi * (s.diameter**2 - s.inner_diameter**2) * s.length * s.density for s in case.shaft)
    assert found.mass == pytest.approx(solid + sum(disk.mass for disk in case.disks), rel=1e-9)


def test_a_kinematic_test_has_its_load_or_none(capsys: pytest.CaptureFixture[str]) -> None:
    found = findings(load_case("bearing"))
    assert (found.mass, found.frequencies_Hz) == (None, ())
    assert [film.load for film in found.films] == [29.9]
    assert findings(load_case("squeeze")).films == ()
    assert frb(["check", "bearing", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["findings"]["films"][0]["load_N"] == 29.9


@pytest.mark.parametrize("setting", ["bearing.1.position=42 mm", "shaft.0.youngs_modulus=1e-9 Pa"])
def test_bearings_that_do_not_hold_the_rotor_have_no_static_load(
    setting: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """At one place, or on a shaft like a string: both ended in a traceback."""
    assert frb(["check", "turbocharger-car", "--set", setting]) == 0
    assert "static loads" not in capsys.readouterr().out
    assert frb(["stability", "turbocharger-car", "--set", setting, "--speed", "100 Hz", "--no-picture"]) in (0, 2, 3)


def test_values_are_shown_on_demand_and_fit_the_screen(capsys: pytest.CaptureFixture[str]) -> None:
    assert frb(["check", "turbocharger-heavy"]) == 0
    said = capsys.readouterr().out
    assert "youngs_modulus" not in said
    assert frb(["check", "turbocharger-heavy", "--all"]) == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert "[bearing.0.inner.clearance]" in lines
    assert any(line.startswith("reference_temperature ") for line in lines)
    assert max(map(len, lines)) <= 80


def test_a_name_that_is_nearly_a_command_is_suggested(capsys: pytest.CaptureFixture[str]) -> None:
    assert frb(["stabilty", "jeffcott"]) == 2
    assert 'Did you mean "stability"?' in capsys.readouterr().err
    assert frb(["zzz"]) == 2
    assert "Did you mean" not in capsys.readouterr().err
