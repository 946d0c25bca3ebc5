"""Stiffness and damping of films at rest: the same in every command, right, and with an error that holds."""

import json
import math

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cli.main import run as frb
from frbcli.equilibrium import static_films
from frbcli.equilibrium.static_machine import StaticMachines

SPEED_Hz = 50.0
ONE_SPEED = (f"speed.from={SPEED_Hz} Hz", f"speed.to={SPEED_Hz} Hz")
LAWS = ("reynolds", "penalty", "half-sommerfeld")


def one_speed(name: str, law: str, *settings: str) -> Case:
    return load_case(name, [f"film.cavitation={law}", *ONE_SPEED, *settings])


def plain(position: str) -> str:
    """A bearing of a turbocharger."""
    size = "width='5 mm', diameter='7 mm', clearance='20 um'"
    return f"{{kind='single-film', name='at{position}', position='{position} mm', {size}}}"


def same(case: Case) -> None:
    """Coefficients of the bearing sheet, of stability and of the response agree to 1e-9, and so do their errors."""
    sheet = frbcli.bearing_sheet(case, [SPEED_Hz]).points
    (stable,) = frbcli.stability(case, [SPEED_Hz]).points
    (response,) = frbcli.response(case, [SPEED_Hz]).resting
    for state, *films in zip(sheet, stable.films, response.films, strict=True):
        assert 0.0 < state.error < 0.05
        assert state.stiffness is not None
        assert state.damping is not None
        for film in films:
            assert film.stiffness == pytest.approx(state.stiffness, abs=1e-9 * np.abs(state.stiffness).max())
            assert film.damping == pytest.approx(state.damping, abs=1e-9 * np.abs(state.damping).max())
            assert film.error == pytest.approx(state.error, rel=1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_coefficients_are_the_same_in_every_command(law: str) -> None:
    same(one_speed("jeffcott", law, "rotor.unbalance=3 g*mm"))


@pytest.mark.parametrize("law", LAWS)
def test_coefficients_of_a_turbocharger_are_the_same_in_every_command(law: str) -> None:
    same(one_speed("turbocharger-car", law, f"bearing=[{plain('42')}, {plain('74')}]"))


@pytest.mark.nightly
@pytest.mark.parametrize("law", LAWS)
def test_coefficients_of_films_of_rings_are_the_same_in_every_command(law: str) -> None:
    """Inner films with feed holes."""
    same(one_speed("turbocharger-car", law))


@pytest.mark.parametrize(
    ("name", "law", "speed_Hz"),
    [("jeffcott", "reynolds", 3.0), ("jeffcott", "penalty", 10.0)],
)
def test_the_stated_error_of_films_on_cells_holds(
    name: str, law: str, speed_Hz: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = load_case(name, [f"film.cavitation={law}"])
    (film,) = StaticMachines(case).at(2.0 * math.pi * speed_Hz).films
    monkeypatch.setattr(static_films, "CELLS", (288, 30))
    (fine,) = StaticMachines(case).at(2.0 * math.pi * speed_Hz, with_error=False).films
    for mine, exact in ((film.stiffness, fine.stiffness), (film.damping, fine.damping)):
        assert np.abs(mine - exact).max() < film.error * np.abs(exact).max()
    assert film.error < 0.02


@pytest.mark.parametrize(("name", "most"), [("jeffcott", 3e-4), ("jeffcott-supply-2bar", 0.01), ("axial-groove", 1e-3)])
def test_the_stated_error_of_tabulated_films_holds(name: str, most: float, monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_case(name)
    found = [StaticMachines(case).at(2.0 * math.pi * speed).films[0] for speed in (5.0, 40.0, 100.0)]
    monkeypatch.setattr(static_films, "FINER", 5)
    for film, speed in zip(found, (5.0, 40.0, 100.0), strict=True):
        true = StaticMachines(case).at(2.0 * math.pi * speed).films[0].error / static_films.FINER_SHARE
        assert true <= film.error < most


def test_commands_state_the_error_of_their_coefficients(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--set", "film.cavitation=reynolds", "--speed", "50 Hz", "--no-picture"]
    words += [word for setting in ONE_SPEED for word in ("--set", setting)]
    found = {}
    for command, key in (("bearing", "points"), ("stability", "points"), ("response", "coefficients")):
        assert frb([command, "jeffcott", *words]) == 0
        assert "stiffness and damping" in capsys.readouterr().out.replace("\n", " ")
        assert frb([command, "jeffcott", *words, "--json"]) == 0
        (found[command],) = json.loads(capsys.readouterr().out)[key]
    errors = {point["error"]["coefficients_relative"] for point in found.values()}
    assert len({round(error, 12) for error in errors}) == 1
    assert 0.0 < errors.pop() < 0.03
    stiffness = [np.array(point["stiffness_N_m"]) for point in found.values()]
    for other in stiffness[1:]:
        assert other == pytest.approx(stiffness[0], abs=1e-9 * np.abs(stiffness[0]).max())
