"""What a run records of its films: their signals, in closed form and as at rest, and the films themselves."""

import math
from pathlib import Path

import numpy as np
import pytest
from marches import planned_system
from PIL import Image
from resumed import assert_resumable

import frbcli
from frbcli import load_case, read_run, runup
from frbcli.case.schema import Case
from frbcli.errors import InputError, RunFileError
from frbcli.film.cells.data import SHEARED
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.plot.motion import quantity_figure
from frbcli.plot.moving import MOMENTS, animate_films, film_moments_figure
from frbcli.results.store import GAS, OIL, KeptFilm, Run, kept_film

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


@pytest.mark.nightly  # a time loop of its own; oil of watched cells: test_given_flow.py
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


FRAMES = 9
KEPT = f'output.films={{ from="10 ms", to="30 ms", frames={FRAMES} }}'
SPEED = ("speed.from=80 Hz", "speed.to=80 Hz", "speed.duration=35 ms", "start.position=resting")
FILM = ("film.cavitation=bubbly", "bearing.supply.pressure=2 bar", "accuracy.mesh=[4, 24]", "rotor.unbalance=60 g*mm")


def case_of(*settings: str) -> Case:
    return load_case("rigid", [*SPEED, *FILM, *settings])


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return runup(case_of(KEPT), tmp_path_factory.mktemp("kept") / "kept.h5")


def test_the_oil_and_the_place_of_each_moment_are_those_of_the_signals(kept: Run) -> None:
    """Of the step that reaches a moment, on cells that turn with the oil."""
    case = case_of(KEPT)
    sheared = planned_system(case).films.loop.cells[0, SHEARED]
    film, times = kept_film(read_run(kept.path), [""]), kept["time_s"]
    asked = np.linspace(0.01, 0.03, FRAMES)
    assert np.all(film.times >= asked)
    assert np.all(film.times < asked + 2e-3)
    assert np.ptp(film.angles) == pytest.approx(np.pi * 80.0 * np.ptp(film.times), rel=1e-9)
    for frame, now in enumerate(film.times):
        before = int(np.searchsorted(times, now, side="right")) - 1
        mean = float((sheared * film.oil[frame]).sum() / sheared.sum())
        assert mean == pytest.approx(kept["oil_fraction"][before], abs=1e-5)
        drawn = [np.interp(now, times, kept[f"journal_{axis}_m"]) / kept.references["clearance_m"] for axis in "xy"]
        assert film.places[frame] == pytest.approx(drawn, abs=1e-4)
    assert film.gas is not None
    assert 0.01 < film.gas.max() < 0.1  # of all its gas, a tenth, the oil has released a part
    assert film.gas.min() > -0.01 * film.gas.max()
    assert film.oil[film.gas > 0.02].mean() < film.oil[film.gas < 0.002].mean() - 0.01


@pytest.mark.bitwise
def test_a_run_with_kept_films_is_the_same_and_may_be_resumed(kept: Run, tmp_path: Path) -> None:
    """Bit for bit, with the films that it has kept."""
    plain = runup(case_of(), tmp_path / "plain.h5")
    for name in plain.signals:
        np.testing.assert_array_equal(kept[name], plain[name], strict=True)
    whole = assert_resumable(case_of(KEPT), tmp_path, 0.02)
    assert whole.checkpoint is not None
    assert {OIL, GAS} <= set(whole.checkpoint)


def test_cells_are_seen_where_they_are_in_the_lab() -> None:
    """A field of the angle in the lab, on uneven cells of a grid that has turned."""
    edges = np.linspace(0.0, 1.0, 200) ** 1.2 * 2.0 * np.pi + 0.3
    turned = 0.5 * (edges[1:] + edges[:-1]) + 4.0
    place = np.array([[0.3, -0.4]])
    values = np.sin(turned)[None, :, None]
    film = KeptFilm("", np.zeros(1), np.array([4.0]), place, edges, values, None)
    even = (np.arange(64) + 0.5) * 2.0 * np.pi / 64
    np.testing.assert_allclose(film.around(0, values[0], 64)[:, 0], np.sin(even), atol=0.03)
    phi = np.linspace(0.0, 2.0 * np.pi, 100_000)
    gap = 1.0 + 0.3 * np.sin(phi) + 0.4 * np.cos(phi)
    assert film.narrowest(0) == pytest.approx(phi[np.argmin(gap)], abs=1e-4)


def test_films_move_in_a_picture(kept: Run, tmp_path: Path) -> None:
    counted: list[tuple[int, int]] = []
    path = animate_films(kept, tmp_path / "a.gif", dpi=50, observe=lambda *told: counted.append(told))
    assert counted[-1] == (FRAMES, FRAMES)
    with Image.open(path) as image:
        assert image.n_frames == FRAMES  # type: ignore[attr-defined]
        first = np.asarray(image.convert("L"), dtype=float)
        image.seek(FRAMES // 2)
        assert np.abs(np.asarray(image.convert("L"), dtype=float) - first).max() > 50.0
    with Image.open(animate_films(kept, tmp_path / "b.gif", from_time=0.015, frames=3, dpi=50)) as image:
        assert image.n_frames == 3  # type: ignore[attr-defined]
    assert path.stat().st_size < 2e6
    figure = film_moments_figure(kept)
    shown = [axes.get_title(loc="left") for axes in figure.axes if axes.get_title(loc="left")]
    assert len(shown) == MOMENTS
    assert "80.0 Hz" in shown[0]
    with pytest.raises(RunFileError, match="has not kept two films"):
        film_moments_figure(kept, from_time=0.032)
    with pytest.raises(RunFileError, match='has no film "outer"'):
        film_moments_figure(kept, "outer")
