"""Bearings of one's own: models that a user adds from Python, against closed forms and the program's own film.

Short bearings, half-Sommerfeld (pi film) or Sommerfeld (full film). Their forces on circular centred orbits are in
Szeri, Fluid Film Lubrication, chapter 4, and in Vance, Rotordynamics of Turbomachinery, chapter 6: with the radius R,
the length L of the land, the clearance c and the whirl speed W of a journal that does not spin, along the line of
centres (r) and across it (t),

    pi film:   F_r = -2 mu R L^3 W eps^2 / (c^2 (1 - eps^2)^2),
               F_t = -(pi / 2) mu R L^3 W eps / (c^2 (1 - eps^2)^(3/2)),
    full film: F_r = 0, and twice F_t.

They follow from d/dz (h^3 dp/dz) = 12 mu dh/dt, h = c (1 + eps cos Theta), dh/dt = c eps W sin Theta, integrated over
the half of the turn where the pressure is positive, or over all of it.
"""

from __future__ import annotations

import math
import re
import runpy
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bearing_models import CHOSEN, HALF, MU, C, L, R, damper_case, spring
from films import rectangular
from numba import njit
from paths import DOCS
from scipy.optimize import brentq

import frbcli
from frbcli.cli.main import run as frb
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import InputError
from frbcli.film.bearing_model.checks import model_film
from frbcli.film.bearing_model.model import BearingDimensions, BearingModel
from frbcli.film.gap import Section
from frbcli.film.grid import Mesh
from frbcli.film.rectangles.film import evaluate, make_film
from frbcli.film.rectangles.film_force import film_force
from frbcli.plot.signals import model as described
from frbcli.runs import march
from frbcli.scene.machine.system import make_system

PAGE = DOCS / "adding-a-model.md"
JOURNAL = rectangular(L, 2 * R, C, MU, 1e5, 1e5)


def spring_slopes(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, bearing: Any) -> Any:  # noqa: ARG001
    return -1e6, 2e5, -2e5, -1e6, -100.0, 0.0, 0.0, -100.0


@pytest.fixture(autouse=True)
def added() -> None:
    frbcli.add_bearing(HALF)
    frbcli.add_bearing(CHOSEN)


def film_of(model: BearingModel, bearing: Section = JOURNAL, keys: tuple[float, ...] = ()) -> Any:
    b = bearing
    pressures = (b.ambient_pressure, b.cavitation_pressure, b.ambient_pressure + b.far_pressure)
    size = (b.bearing_width, 2.0 * b.radius, b.clearance, b.viscosity, b.copies, b.width)
    return model_film(model, BearingDimensions(*size, *pressures), keys)


def orbit(eps: float, whirl: float, full: bool) -> tuple[float, float]:
    """F_r, F_t of the head of this file; whirl: W in rad/s."""
    size, s2 = MU * R * L**3 * whirl / C**2, 1.0 - eps**2
    half_turn = 0.5 * math.pi * size * eps / s2**1.5
    return (0.0, -2.0 * half_turn) if full else (-2.0 * size * eps**2 / s2**2, -half_turn)


# --- the squeeze film damper ---
@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("eps", [0.05, 0.4, 0.8])
def test_a_circular_orbit_has_the_known_forces(eps: float, full: bool) -> None:
    motion = f"motion={{ eccentricity = {eps}, angle = '40 deg', whirl_speed = '60 Hz' }}"
    case = damper_case(f"film.damper.film={'full' if full else 'pi'}", motion)
    (result,) = frbcli.rotation(case).results
    assert (result.status, result.theory, result.cavitation, result.field) == ("ok", "damper", "", None)
    assert result.loads is not None
    assert math.isnan(result.loads.p_max)
    x, y = result.loads.force
    c, s = math.cos(math.radians(40.0)), math.sin(math.radians(40.0))
    known = orbit(eps, 120.0 * math.pi, full)
    assert (c * x + s * y, c * y - s * x) == pytest.approx(known, rel=1e-9, abs=1e-9 * math.hypot(x, y))


def test_a_whirl_settles_to_the_same_and_a_squeeze_has_the_known_force() -> None:
    case = damper_case("motion={ eccentricity = 0.5, frequency = '50 Hz', periods = 20 }")
    (result,) = frbcli.whirl(case).results
    assert result.history is not None
    (x, y), (f_x, f_y) = result.history.displacement[-1], result.history.force[-1]
    known = orbit(0.5, 100.0 * math.pi, False)
    assert ((x * f_x + y * f_y) / 0.5, (x * f_y - y * f_x) / 0.5) == pytest.approx(known, rel=1e-9)
    case = damper_case("film.damper.film=full", "motion={ eccentricity = 0.6, frequency = '50 Hz', periods = 1 }")
    history = frbcli.squeeze(case).results[0].history
    assert history is not None
    eps = np.abs(history.displacement[:, 1])
    rate = -0.6 * 100.0 * math.pi * np.cos(100.0 * math.pi * history.time_s)  # of D_y over C
    # a full film squeezed along the line of centres: pi mu R L^3 (1 + 2 eps^2) / (c^2 (1 - eps^2)^(5/2)) per rate
    known_y = -math.pi * MU * R * L**3 / C**2 * (1.0 + 2.0 * eps**2) / (1.0 - eps**2) ** 2.5 * rate
    assert history.force[:, 1] == pytest.approx(known_y, rel=1e-9, abs=1e-9 * float(np.max(np.abs(known_y))))
    assert history.gap_ratio == pytest.approx(1.0 + history.displacement[:, 1])


def test_a_rigid_rotor_in_dampers_orbits_as_its_unbalance_says(tmp_path: Path) -> None:
    mass, unbalance, k, omega = 20.0, 5e-3, 2e6, 2.0 * math.pi * 60.0
    text = f"""
rotor = {{ kind = "rigid", mass = "{mass} kg", unbalance = "{unbalance} kg*m", gravity = "0 m/s^2" }}
speed = {{ from = "60 Hz", to = "60 Hz", duration = "0.6 s" }}
"""
    case = damper_case(f"film.damper.spring={k} N/m", "accuracy.target=1e-4", text=text)
    run = frbcli.runup(case, tmp_path / "run.h5")

    def missing(eps: float) -> float:
        radial, tangential = orbit(eps, omega, False)
        along = 2.0 * radial - 2.0 * k * C * eps + mass * omega**2 * C * eps
        return math.hypot(along, 2.0 * tangential) - unbalance * omega**2

    eps = brentq(missing, 1e-3, 0.9)
    assert run.status == "finished"
    assert 0.2 < eps < 0.8
    assert run["eccentricity"][-50:] == pytest.approx(eps, rel=1e-4)
    assert run.error["film_force_relative"] is None
    assert 0.0 < run.error["eccentricity"] < 1e-3


def test_dampers_take_the_peak_of_a_jeffcott_rotor_at_its_critical_speed(tmp_path: Path) -> None:
    """Their oil a hundred times thinner, the rotor has its critical speed on shaft and springs in series."""
    text = """
speed = { from = "50 Hz", to = "85 Hz", duration = "2 s" }

[rotor]
kind = "jeffcott"
mass = "20 kg"
journal_mass = "2 kg"
shaft_stiffness = "4e6 N/m"
unbalance = "100 g*mm"
external_damping = "400 N*s/m"
gravity = "0 m/s^2"
"""
    peaks = []
    for viscosity in ("0.0001 Pa*s", "0.01 Pa*s"):
        case = damper_case("film.damper.spring=1e7 N/m", f"oil.viscosity={viscosity}", text=text)
        run = frbcli.runup(case, tmp_path / f"{viscosity[:6]}.h5")
        assert run.status == "finished"
        size = np.hypot(run["disk_x_m"], run["disk_y_m"])
        peaks.append((float(size.max()), float(run["speed_Hz"][size.argmax()])))
    series = math.sqrt(1.0 / (1.0 / 4e6 + 0.5 / 1e7) / 20.0) / (2.0 * math.pi)
    assert peaks[0][1] == pytest.approx(series, rel=0.05)
    assert peaks[1][0] < 0.6 * peaks[0][0]


# --- the journal bearing that the program has, too ---
STATES = [(0.02, 0.01, 30.0, -20.0, 300.0), (0.3, -0.2, 40.0, 10.0, 500.0), (-0.6, 0.7, -90.0, 50.0, 900.0)]


@pytest.mark.parametrize("state", STATES)
def test_force_stiffness_and_damping_are_those_of_the_program(state: tuple[float, ...]) -> None:
    """Central differences in results, one-sided ones in the time loop: their errors."""
    built_in = make_film(JOURNAL, "short", "half-sommerfeld", Mesh(4, 4))
    exact, loop = np.array(film_force(built_in, *state)), np.array(film_force(film_of(HALF), *state))
    d, v = C * np.array(state[:2]), C * np.array(state[2:4])
    found, known = (evaluate(film, C, d, v, state[4]) for film in (film_of(HALF), built_in))
    assert found.force == pytest.approx(known.force, rel=1e-12)
    for part, name in ((slice(2, 6), "by_displacement"), (slice(6, 10), "by_velocity")):
        expected = getattr(known, name)
        size = float(np.max(np.abs(expected)))
        assert np.max(np.abs(getattr(found, name) - expected)) < 2e-9 * size, name
        assert np.max(np.abs(loop[part] - exact[part])) < 3e-7 * float(np.max(np.abs(exact[part]))), name


def test_stability_and_run_up_are_those_of_the_program(tmp_path: Path) -> None:
    speeds = ("speed.to=120 Hz", "speed.duration=0.5 s", "rotor.unbalance=2 g*mm")
    built_in, own = (frbcli.load_case("rigid", (f"film.theory={name}", *speeds)) for name in ("short", "short-pi"))
    rests = [frbcli.stability(case, [30.0, 110.0], threshold=True) for case in (built_in, own)]
    for known, found in zip(rests[0].points, rests[1].points, strict=True):
        assert found.films[0].displacement == pytest.approx(known.films[0].displacement, rel=1e-9)
        for name in ("stiffness", "damping"):
            expected = getattr(known.films[0], name)
            assert getattr(found.films[0], name) == pytest.approx(expected, abs=1e-8 * float(np.max(np.abs(expected))))
        assert found.growth == pytest.approx(known.growth, rel=1e-6)
    thresholds = [rest.threshold for rest in rests]
    if thresholds[0] is not None:
        assert thresholds[1].speed_Hz == pytest.approx(thresholds[0].speed_Hz, rel=1e-7)
    runs = [frbcli.runup(case, tmp_path / f"{case.film.theory}.h5") for case in (built_in, own)]
    assert runs[0].status == runs[1].status
    assert runs[0].cost["steps"] == runs[1].cost["steps"]
    for name in ("eccentricity", "journal_x_m", "journal_y_m"):
        expected = runs[0][name]
        assert runs[1][name] == pytest.approx(expected, abs=1e-9 * float(np.max(np.abs(expected))))


def test_a_journal_rests_under_a_load_where_it_does_in_the_film_of_the_program() -> None:
    motion = "motion={ load = '30 N', speed = '20 Hz' }"
    case = frbcli.load_case("bearing", ["film.theory=short-pi", "film.cavitation=half-sommerfeld", motion])
    (found,) = frbcli.rotation(case).results
    assert found.loads is not None
    assert found.loads.force == pytest.approx((0.0, 30.0), abs=1e-3)


def elastic(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, bearing: Any) -> Any:  # noqa: ARG001
    return -1e6 * d_x, -1e6 * d_y


def elastic_slopes(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, bearing: Any) -> Any:  # noqa: ARG001
    return -1e6, 0.0, 0.0, -1e6, 0.0, 0.0, 0.0, 0.0


def test_a_model_without_damping_is_one() -> None:
    frbcli.add_bearing(BearingModel("elastic", "elastic", elastic, elastic_slopes))
    case = frbcli.load_case("rigid", ["film.theory=elastic"])
    decisions = {decision.choice: decision for decision in frbcli.make_plan(case).decisions}
    assert "derivatives by the model" in decisions["film"].reason
    point = frbcli.stability(case, [50.0]).points[0]
    assert point.films[0].stiffness == pytest.approx(np.diag([1e6, 1e6]))
    assert abs(point.oscillating[0].imag) == pytest.approx(math.sqrt(2e6 / 6.1), rel=1e-6)


def test_derivatives_of_a_model_are_taken_as_they_are() -> None:
    told = BearingModel("told", "told", spring, spring_slopes)
    differences = BearingModel("found", "found", spring)
    for central in (0, 1):
        film, other = (film_of(model)._replace(central=central) for model in (told, differences))
        exact, near = (np.array(film_force(one, 0.3, 0.2, 5.0, 1.0, 60.0)) for one in (film, other))
        assert exact[2:] == pytest.approx(C * np.array(spring_slopes(0, 0, 0, 0, 0, None)), rel=1e-14)
        assert near == pytest.approx(exact, abs=1e-6 * C * 1e6)
        assert near[:2] == pytest.approx(exact[:2], rel=1e-15)


def test_a_film_of_the_program_is_compiled_without_bearing_models() -> None:
    built_in = make_film(JOURNAL, "short", "half-sommerfeld", Mesh(4, 4))
    for film, asked in ((built_in, False), (film_of(HALF), True)):
        fresh = njit(error_model="numpy")(film_force.py_func)
        fresh(film, *STATES[0])
        assert all(("model_force" in code) is asked for code in fresh.inspect_llvm().values())

RINGED = ("film.cavitation=half-sommerfeld", "bearing.inner.supply={ kind = 'none' }",
          "bearing.outer.supply={ kind = 'none' }", "speed.from=100 Hz", "speed.to=101 Hz",
          "speed.duration=4 ms", "output.step=1e-4 s")  # fmt: skip


def ring_cases() -> Iterator[frbcli.Case]:
    """A ring between films of the program, and between the same ones as bearing models."""
    return (frbcli.load_case("floating-ring", [f"film.theory={name}", *RINGED]) for name in ("short", "short-pi"))


def test_a_ring_rests_between_bearing_models_as_between_films_of_the_program() -> None:
    """The torques (4.17) on a ring follow from the forces of its films, and from the slip in full gaps."""
    systems = [make_system(case, frbcli.make_plan(case)) for case in ring_cases()]
    built_in, own = (resting_position(system, 200.0 * math.pi) for system in systems)
    assert built_in.ring_speeds[0] > 1.0
    assert own.ring_speeds == pytest.approx(built_in.ring_speeds, rel=1e-6)
    assert own.journals == pytest.approx(built_in.journals, rel=1e-5)


@pytest.mark.nightly
def test_a_ring_turns_between_bearing_models_as_between_films_of_the_program(tmp_path: Path) -> None:
    built_in, own = (frbcli.runup(case, tmp_path / f"{case.film.theory}.h5") for case in ring_cases())
    assert abs(built_in["ring_speed_Hz"][-1]) > 1.0
    np.testing.assert_allclose(own["ring_speed_Hz"], built_in["ring_speed_Hz"], rtol=1e-6, atol=1e-6)
    for name in ("eccentricity_inner", "eccentricity_outer"):
        assert np.max(built_in[name]) > 1e-3
        np.testing.assert_allclose(own[name], built_in[name], atol=1e-6)


# --- the record of a run ---
def interrupt_after(calls: int) -> Callable[[Any], None]:
    left = iter(range(calls - 1, -1, -1))

    def observe(_: Any) -> None:
        if next(left, None) == 0:
            signal.raise_signal(signal.SIGINT)

    return observe

RUN = ("film.theory=short-pi", "speed.to=60 Hz", "speed.duration=0.3 s", "rotor.unbalance=2 g*mm")


def test_a_run_goes_on_with_its_model_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(march, "BUDGET", 60)
    case = frbcli.load_case("rigid", RUN)
    whole, path = frbcli.runup(case, tmp_path / "whole.h5"), tmp_path / "broken.h5"
    assert frbcli.runup(case, path, observe=interrupt_after(3)).status == "interrupted"
    frbcli.add_bearing(BearingModel("short-pi", "another", spring))
    with pytest.raises(InputError, match="was made with another bearing model of the name short-pi"):
        frbcli.runup(case, path, resume=True)
    frbcli.remove_bearing("short-pi")
    with pytest.raises(InputError, match=r"a bearing model that this process does not have.*frbcli\.add_bearing"):
        frbcli.runup(case, path, resume=True)
    frbcli.add_bearing(HALF)
    run = frbcli.runup(case, path, resume=True)
    assert run.status == "finished"
    np.testing.assert_array_equal(run["journal_x_m"], whole["journal_x_m"])


def test_a_run_is_read_and_drawn_without_its_model(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.h5"
    assert described(frbcli.runup(frbcli.load_case("rigid", RUN), path)) == "short, pi film"
    frbcli.remove_bearing("short-pi")
    run = frbcli.read_run(path)
    assert described(run) == "short-pi"
    assert run.versions["bearing_model"].startswith("short-pi, added from Python; forces ")
    for words in (["waterfall", str(path)], ["plot", str(path)], ["plot", str(path), "--what", "summary"]):
        assert frb(words) == 0
    case = tmp_path / "case.toml"
    case.write_text(run.case_text, encoding="utf-8")
    assert frb(["runup", str(case), "-o", str(path), "--resume"]) == 2
    told = " ".join(capsys.readouterr().err.split())
    assert 'film.theory = "short-pi" (line' in told
    assert "frbcli.add_bearing" in told


def test_models_are_compared_with_those_of_the_program(tmp_path: Path) -> None:
    case = frbcli.load_case("rigid", ("speed.to=20 Hz", "speed.duration=20 ms"))
    found = frbcli.compare(case, theories=["short", "short-pi"], keep=tmp_path)
    assert [result.variant.name for result in found.results] == ["half-sommerfeld short", "short-pi"]
    assert found.results[1].deviation.largest < 1e-8
    with pytest.raises(InputError, match="do not have the bearing model short-pi"):
        frbcli.sweep(frbcli.load_case("rigid", RUN), {"rotor.mass": ["5 kg", "6 kg"]}, directory=tmp_path / "sweep")


# --- the page, and what a model costs ---
def test_the_bearing_of_the_page_is_a_squeeze_film_damper(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    section = PAGE.read_text(encoding="utf-8").partition("## A bearing of your own")[2]
    example = re.search(r"```python\n(.*?)```", section, re.DOTALL)
    assert example
    (tmp_path / "page.py").write_text(example[1], encoding="utf-8")
    names = runpy.run_path(str(tmp_path / "page.py"))
    assert names["run"].status == "finished"
    assert (tmp_path / "damper.h5").exists()
    for full in (False, True):
        film = f"film.squeeze-film-damper.film={'full' if full else 'pi'}"
        case = damper_case(
            "film.theory=squeeze-film-damper", film, "motion={ eccentricity = 0.5, whirl_speed = '60 Hz' }"
        )
        loads = frbcli.rotation(case).results[0].loads
        assert loads is not None
        assert loads.force == pytest.approx(orbit(0.5, 120.0 * math.pi, full), rel=1e-3, abs=1e-3)


@pytest.mark.nightly
@pytest.mark.timing
def test_a_run_with_a_model_takes_about_twice_the_time_of_the_film_of_the_program(tmp_path: Path) -> None:
    """By paired runs, CPU time of the time loop; the model has no derivatives of its own."""
    speeds = ("speed.to=150 Hz", "speed.duration=2 s", "rotor.unbalance=1 g*mm")
    cases = [frbcli.load_case("rigid", (f"film.theory={name}", *speeds)) for name in ("short", "short-pi")]
    spent: list[list[float]] = [[], []]
    for _ in range(7):
        for times, case in zip(spent, cases, strict=True):
            run = frbcli.runup(case, tmp_path / "run.h5", force=True)
            times.append(float(run.cost["cpu_s"]))
    ratio = min(spent[1]) / min(spent[0])
    sys.stdout.write(f"a bearing model takes {ratio:.2f} of the time of the program's short film\n")
    assert ratio < 2.5


# --- its sheet and its ladder ---
def test_the_sheet_of_a_model_is_that_of_the_program(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    built_in, own = (frbcli.load_case("rigid", (f"film.theory={name}", "speed.to=120 Hz")) for name in
                     ("short", "short-pi"))  # fmt: skip
    for make in (lambda case: frbcli.bearing_sheet(case, [110.0]), lambda case: frbcli.sommerfeld_chart(case, [0.4])):
        (known,), (found,) = make(built_in).points, make(own).points
        for name in ("displacement", "film_thickness_min", "sommerfeld_number"):
            assert getattr(found, name) == pytest.approx(getattr(known, name), rel=1e-9)
        for name in ("stiffness", "damping"):
            expected = getattr(known, name)
            assert getattr(found, name) == pytest.approx(expected, abs=2e-9 * float(np.max(np.abs(expected))))
        assert known.power > 0.0
        assert all(math.isnan(getattr(found, name)) for name in ("torque", "power", "side_flow", "p_max"))
    picture = tmp_path / "sheet.png"
    settings = ["--set", "film.theory=short-pi", "--speed", "30 Hz", "--speed", "110 Hz"]
    assert frb(["bearing", "rigid", *settings, "-o", str(picture)]) == 0
    assert picture.stat().st_size > 0
    assert "short, pi film" in capsys.readouterr().out


def test_the_ladder_of_a_model_is_of_tolerances() -> None:
    case = frbcli.load_case("rigid", ("film.theory=short-pi", "speed.to=120 Hz"))
    found = frbcli.accuracy(case, until=0.02)
    assert {(item.rung.theory, item.rung.mesh) for item in found.ladder} == {("short-pi", None)}
    by_tolerance = sorted(found.ladder, key=lambda item: item.rung.tolerance)
    assert len(by_tolerance) == 4
    assert by_tolerance[0].error.eccentricity_largest < by_tolerance[-1].error.eccentricity_largest
    assert found.reference.rung.tolerance < by_tolerance[0].rung.tolerance
    with pytest.raises(InputError, match="--theory = finite: is not known"):
        frbcli.accuracy(case, until=0.02, theories=["finite"])


def test_a_sheet_asks_what_a_run_asks_of_a_model() -> None:
    bores = 'bearing.supply={kind="bores", count=6, diameter="2 mm", pressure="2 bar"}'
    with pytest.raises(InputError, match="a supply that a bearing model cannot represent"):
        frbcli.bearing_sheet(damper_case(bores, "motion={ load = '30 N', speed = '20 Hz' }"), [20.0])
