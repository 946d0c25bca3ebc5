"""What a run records of its films by choice, held to balances, closed forms and the sheet of the bearing."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from marches import planned_system

import frbcli
from frbcli.errors import InputError, RunFileError
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.plot.motion import quantity_figure
from frbcli.results.store import Run

PLAIN = ["force", "film-thickness", "power", "torque"]
STEADY = ["speed.from=60 Hz", "speed.to=60 Hz", "rotor.unbalance=0 g*mm"]
SHORT = ["film.theory=short", "speed.from=20 Hz", "speed.to=60 Hz", "speed.duration=0.1 s"]
ELROD = [
    "film.cavitation=elrod", "accuracy.mesh=[4, 24]", "speed.duration=0.6 s", "rotor.external_damping=3000 N*s/m",
]  # fmt: skip


def run_of(case: str, folder: Path, settings: list[str], kinds: list[str]) -> Run:
    told = "[" + ", ".join(f'"{kind}"' for kind in kinds) + "]"
    return frbcli.runup(frbcli.load_case(case, [*settings, f"output.signals={told}"]), folder / "run.h5", force=True)


def test_nothing_changes_where_nothing_is_asked_for(tmp_path: Path) -> None:
    plain, more = (run_of("jeffcott", tmp_path, SHORT, kinds) for kinds in ([], PLAIN))
    assert set(more.signals) - set(plain.signals) == {
        "film_force_x_N", "film_force_y_N", "film_thickness_m", "power_W", "torque_N_m",
    }  # fmt: skip
    for name in plain.signals:
        np.testing.assert_array_equal(plain[name], more[name])
    assert plain.cost["steps"] == more.cost["steps"]


def test_the_short_bearing_in_closed_form(tmp_path: Path) -> None:
    """Without cavitation: forces are those of the recorded motion; what goes into the film is sheared (Couette) and
    squeezed away (Poiseuille), h^3 / (12 eta) times the square of the pressure gradient."""
    settings = [*SHORT, "film.cavitation=sommerfeld", "rotor.unbalance=30 g*mm", "rotor.external_damping=1000 N*s/m"]
    run = run_of("rigid", tmp_path, settings, PLAIN)
    case = frbcli.load_case("rigid", settings)
    system = planned_system(case)
    t, omega = run["time_s"], 2.0 * math.pi * run["speed_Hz"]
    place = np.column_stack([run["journal_x_m"], run["journal_y_m"]])
    rate = np.gradient(place, t, axis=0)
    force = np.column_stack([run["film_force_x_N"], run["film_force_y_N"]])
    later = range(60, len(t) - 1, 37)
    for k in later:
        told = system.films.force(0, place[k], rate[k], omega[k]).force
        np.testing.assert_allclose(force[k], told, atol=2e-3 * np.abs(force).max())

    film, eta = system.films.sections[0], system.films.sections[0].viscosity
    c, radius, b = film.clearance, film.radius, film.width
    phi = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
    for k in later:
        d, v = place[k] / c, rate[k] / c
        gap = 1.0 + d[0] * np.sin(phi) - d[1] * np.cos(phi)
        w = v - 0.5 * omega[k] * np.array([-d[1], d[0]])
        parabola = -((b / radius) ** 2) * (w[0] * np.sin(phi) - w[1] * np.cos(phi)) / (2.0 * gap**3)
        slope = 12.0 * eta * (radius / c) ** 2 * parabola / b  # times 1 - 2 z, whose square has the mean 1/3
        squeezed = film.copies * radius * b * 2 * math.pi * np.mean((c * gap) ** 3 * slope**2) / (36.0 * eta)
        sheared = eta * (radius * omega[k]) ** 2 * radius * film.bearing_width * 2 * math.pi * np.mean(1.0 / gap) / c
        assert run["power_W"][k] == pytest.approx(sheared + squeezed, rel=1e-3)
        push = -0.5 * (place[k, 0] * force[k, 1] - place[k, 1] * force[k, 0])
        assert run["torque_N_m"][k] == pytest.approx(push - sheared / omega[k], rel=1e-4)
        assert run["film_thickness_m"][k] == pytest.approx(c * gap.min(), rel=1e-4)


def test_at_rest_films_carry_the_weight_and_lose_what_the_sheet_says(tmp_path: Path) -> None:
    run = run_of("jeffcott", tmp_path, [*STEADY, "speed.duration=50 ms", "start.position=resting"], PLAIN)
    found = frbcli.load_case("jeffcott", STEADY)
    sheet = bearing_sheet(found, [60.0]).points[0]
    assert run["film_force_y_N"][-1] == pytest.approx(-sheet.load[1], rel=1e-8)
    assert abs(run["film_force_x_N"][-1]) < 1e-6 * -sheet.load[1]
    assert run["torque_N_m"][-1] == pytest.approx(sheet.torque, rel=2e-4)
    assert run["power_W"][-1] == pytest.approx(sheet.power, rel=2e-4)
    assert run["film_thickness_m"][-1] == pytest.approx(sheet.film_thickness_min, rel=3e-4)


@pytest.mark.parametrize(
    ("case", "bound"),
    [
        ("jeffcott", 1e-3),
        pytest.param("axial-groove", 0.02, marks=pytest.mark.nightly),
    ],
)
def test_oil_that_leaves_tabulated_films_at_rest(case: str, bound: float, tmp_path: Path) -> None:
    run = run_of(case, tmp_path, [*STEADY, "speed.duration=20 ms", "start.position=resting"], ["oil-flow"])
    sheet = bearing_sheet(frbcli.load_case(case, STEADY), [60.0]).points[0]
    assert run["oil_flow_m3_s"][-1] == pytest.approx(sheet.side_flow, rel=bound)


def test_oil_that_leaves_short_films_in_motion(tmp_path: Path) -> None:
    """Half-Sommerfeld: of a land of width b, R b/2 times the integral of max(-w . n, 0), 2 |w|, leaves through its one
    open end."""
    run = run_of("rigid", tmp_path, [*SHORT, "rotor.unbalance=30 g*mm"], ["oil-flow"])
    case = frbcli.load_case("rigid", SHORT)
    film = planned_system(case).films.sections[0]
    place = np.column_stack([run["journal_x_m"], run["journal_y_m"]])
    rate, omega = np.gradient(place, run["time_s"], axis=0), 2.0 * math.pi * run["speed_Hz"]
    w = rate - 0.5 * omega[:, None] * np.column_stack([-place[:, 1], place[:, 0]])
    expected = film.copies * film.width * film.radius * np.hypot(*w.T)
    inner = slice(60, -1)
    assert np.ptp(expected[inner]) > 0.1 * expected.max()
    np.testing.assert_allclose(run["oil_flow_m3_s"][inner], expected[inner], atol=3e-3 * expected.max())


@pytest.mark.nightly  # a time loop of its own; oil of watched cells: test_given_flow_run.py
def test_films_on_cells_settle_to_the_sheet(tmp_path: Path) -> None:
    """In the mean over a turn of the cells, at half the speed of the rotor: 24 of them leave a ripple of 1e-3 of the
    force, whose phase follows the steps, and with them round-off. 100 steps per revolution resolve it."""
    fine = [*STEADY, *ELROD, "accuracy.steps_per_revolution=100"]
    run = run_of("jeffcott-supply-2bar", tmp_path, fine, [*PLAIN, "oil-flow"])
    sheet = bearing_sheet(frbcli.load_case("jeffcott-supply-2bar", [*STEADY, *ELROD]), [60.0]).points[0]
    turn = run["time_s"] > run["time_s"][-1] - 2.0 / 60.0
    force, torque, power, flow = (
        np.mean(run[name][turn]) for name in ("film_force_y_N", "torque_N_m", "power_W", "oil_flow_m3_s")
    )
    assert force == pytest.approx(-sheet.load[1], rel=1e-4)
    assert torque == pytest.approx(sheet.torque, rel=1e-3)
    assert power == pytest.approx(sheet.power, rel=1e-3)
    assert flow == pytest.approx(sheet.side_flow, rel=2e-2)


def test_what_a_run_cannot_record_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="tables of the penalty model"):
        run_of("jeffcott", tmp_path, ["film.cavitation=penalty"], ["oil-flow"])
    with pytest.raises(InputError, match="co-simulation"):
        run_of("jeffcott", tmp_path, [*SHORT, "film.coupling=co-simulation"], ["force"])
    with pytest.raises(InputError, match=r"output\.signals"):
        run_of("jeffcott", tmp_path, SHORT, ["colour"])


def test_what_was_not_recorded_is_not_drawn(tmp_path: Path) -> None:
    run = run_of("jeffcott", tmp_path, SHORT, ["force"])
    figure = quantity_figure([run], "force")
    assert [axes.get_ylabel() for axes in figure.axes] == [f"force {a} in N" for a in "xy"]
    with pytest.raises(RunFileError, match=r"output\.signals"):
        quantity_figure([run], "power")
