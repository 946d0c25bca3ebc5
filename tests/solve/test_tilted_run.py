"""Runs in films that follow the tilt of the journals: limits, growth of small motions, contact at an end."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from marches import SPEED, WIDTH, Result, flat_films, march, planned_system, rigid_shaft, start

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.equilibrium.resting import resting_position
from frbcli.linear.stability import stability_points
from frbcli.rotor.assembly import PLANE
from frbcli.rotor.loads import speed_profile
from frbcli.runs.films import tilt_signals
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import System
from frbcli.scene.planning.cell_choice import worst_film
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.tilted import TiltedForm
from frbcli.solve.state import SOLVES, STEPS, Control
from frbcli.studies.accuracy import ladder, planned_rung

MESH = "accuracy.mesh=[4, 24]"  # 24 x 8 cells over the whole width
CONTROL, FINE = Control(1e-6, 24.0, 1e-3, 1e-4, 0.9999, 0.0), Control(1e-9, 60.0, 1e-3, 1e-4, 0.9999, 0.0)
SUPPLIES = {
    "none": (),
    "groove": tuple(
        f'bearing.{side}.supply={{kind="circumferential-groove", pressure="2 bar"}}' for side in (0, 1)
    ),
}
TURNING = {
    "holes that turn": tuple(
        f'bearing.{side}.supply={{kind="bores", count=4, diameter="1 mm", pressure="2 bar", on="journal"}}'
        for side in (0, 1)
    )
}
OMEGA = 2.0 * math.pi * SPEED
Array = np.ndarray


def tilted(*more: str) -> tuple[Case, System]:
    case = rigid_shaft("film.tilt=follows", MESH, *more)
    return case, planned_system(case)


def run(system: System, duration: float, q: Array, limits: Control = CONTROL) -> Result:
    profile = speed_profile((0.0, duration), (OMEGA, OMEGA))
    return march(system, profile, limits, start(system, profile, q), "esdirk3")


def in_plane(case: Case, system: System) -> System:
    """The same machine and the same cells, and films that do not know of a tilt."""
    return replace(system, films=flat_films(case, system), rotor=make_rotor(case, PLANE))


@pytest.mark.bitwise
@pytest.mark.parametrize(
    ("law", "supply"),
    [
        *((law, supply) for law in ("half-sommerfeld", "reynolds", "elrod") for supply in SUPPLIES),
        ("bubbly", "groove"),
        pytest.param("half-sommerfeld", "holes that turn", marks=pytest.mark.nightly),
        pytest.param("bubbly", "none", marks=pytest.mark.nightly),
    ],
)
def test_translation_is_as_without_tilt(law: str, supply: str) -> None:
    """The weight and the unbalance lie in the middle of a rigid symmetric rotor: nothing tilts. Beside holes that turn
    Newton's method leaves a difference that falls with the tolerance."""
    case, system = tilted(f"film.cavitation={law}", *(SUPPLIES | TURNING)[supply])
    # Beside the centre: there a film stands on the kink of its law, and the first correction is a matter of round-off.
    aside = np.linalg.pinv(system.rotor.journals[:, :2].reshape(4, -1)) @ np.tile([0.1, -0.3], 2) * system.clearances[0]
    duration = 1.5e-3 if law in ("elrod", "bubbly") else 10e-3  # fronts that cross cells amplify round-off
    limits = CONTROL
    if supply in TURNING:
        duration, limits = 3e-4, CONTROL._replace(tolerance=1e-9)
    found, flat = (run(each, duration, aside, limits) for each in (system, in_plane(case, system)))
    journals = (make_rotor(case, PLANE).journals @ each.q.T / system.clearances[0] for each in (found, flat))
    one, other = journals
    assert np.abs(other).max() > 0.05
    assert np.abs(one - other).max() < 1e-9
    assert np.abs(system.rotor.journals[:, 2:] @ found.q.T).max() < 1e-9 * system.clearances[0] / WIDTH
    for number in (STEPS, SOLVES):
        assert found.numbers[number] == flat.numbers[number]
    assert any(system.remembering) == (law in ("elrod", "bubbly"))


def test_small_motions_grow_as_the_eigenvalues_say(monkeypatch: pytest.MonkeyPatch) -> None:
    """The conical motion of a run about its rest on the same cells, beside that of the linearised machine."""
    monkeypatch.setattr(TiltedForm, "static_cells", ((24, 8), (16, 6)))
    case, system = tilted("film.cavitation=sommerfeld", "disk.0.unbalance=0 g*mm")
    point = stability_points(case, [SPEED])[1][0]
    rest = resting_position(system, OMEGA)
    q = rest.displacements.copy()
    tilts = np.linalg.pinv(system.rotor.journals.reshape(8, -1)) @ np.tile([0.0, 0.0, 1.0, 0.0], 2)
    moved = system.rotor.journals @ tilts
    assert np.abs(moved[:, 2] - 1.0).max() < 1.0
    q += 1e-4 * system.clearances[0] / WIDTH * tilts
    found = run(system, 30e-3, q, FINE).q
    tilt = (system.rotor.journals[0, 2:] @ (found - rest.displacements).T)[:, 50:]
    signal = tilt[0] + 1j * tilt[1]
    fitted = slowest(signal, 1e-4)
    nearest = point.eigenvalues[np.argmin(np.abs(point.eigenvalues - fitted))]
    assert abs(fitted - nearest) < 1e-2 * abs(nearest)


def test_shells_out_of_line_hold_the_journals_where_they_rest() -> None:
    """A run that begins at rest in them stays there."""
    tilts = (f'bearing.{side}.misalignment=["{tilt} rad", "5e-4 rad"]' for side, tilt in ((0, 1e-3), (1, -6e-4)))
    _, system = tilted("film.cavitation=half-sommerfeld", "disk.0.unbalance=0 g*mm", *tilts)
    rest = resting_position(system, OMEGA)
    found = run(system, 5e-3, rest.displacements).q
    assert np.abs(rest.journals[:, 2:]).min() > 0.02 * system.clearances[0] / WIDTH
    moved = system.films.seen(system.rotor.journals) @ (found - rest.displacements).T
    assert np.abs(moved).max() < 1e-5 * system.clearances[0]
    signals = tilt_signals(system, found)
    assert signals["tilt_left_x_rad"] == pytest.approx(rest.journals[0, 2], rel=1e-4)
    ends = np.hypot(*np.swapaxes(system.films.ends(rest.journals), 0, 1))
    assert signals["end_eccentricity_right"] == pytest.approx(ends[2:].max(), rel=1e-4)
    parallel = resting_position(tilted("film.cavitation=half-sommerfeld")[1], OMEGA)
    apart = system.rotor.journals[:, :2] @ (rest.displacements - parallel.displacements)
    assert np.abs(apart).max() > 1e-3 * system.clearances[0]


def inclined(kind: str, side: float, *more: str) -> System:
    """A rotor that moves in its plane in a shell that is not in line, inclined to the one or the other side."""
    shell = f'bearing.misalignment=["{side * 0.5} mrad", "{side * -0.3} mrad"]'
    case = load_case(kind, ["film.theory=finite", "film.cavitation=half-sommerfeld", MESH, shell, *more])
    return planned_system(case)


def test_a_rotor_that_does_not_tilt_stays_at_rest_in_a_shell_out_of_line() -> None:
    """Both of its films carry it, and no moment turns it. A shell inclined the other way is the mirror image, in which
    the rotor moves alike."""
    system, mirrored = (inclined("rigid", side, "rotor.unbalance=0") for side in (1.0, -1.0))
    rest = resting_position(system, OMEGA)
    found = run(system, 5e-3, rest.displacements).q
    clearance = system.clearances[0]
    assert np.abs(system.films.seen(system.rotor.journals) @ (found - rest.displacements).T).max() < 1e-5 * clearance
    assert 2.0 * rest.films[0].force[1] == pytest.approx(-system.rotor.static_load.sum(), rel=1e-6)
    assert np.abs(rest.films[0].force[2:]).max() > 0.0
    flat = resting_position(inclined("rigid", 1e-6), OMEGA)
    assert np.abs(rest.journals[0, :2] - flat.journals[0, :2]).max() > 1e-3 * clearance
    other = resting_position(mirrored, OMEGA)
    assert other.journals[0, :2] == pytest.approx(rest.journals[0, :2], abs=1e-7 * clearance)
    assert other.journals[0, 2:] == pytest.approx(-rest.journals[0, 2:], rel=1e-12)


def test_small_motions_in_a_shell_out_of_line_grow_as_the_eigenvalues_say(monkeypatch: pytest.MonkeyPatch) -> None:
    """The whirl of a Jeffcott rotor about its rest on the same cells, beside the linearised machine."""
    monkeypatch.setattr(TiltedForm, "static_cells", ((24, 8), (16, 6)))
    case = load_case("jeffcott", ["film.theory=finite", "film.cavitation=sommerfeld", MESH, "rotor.unbalance=0 g*mm",
                                  'bearing.misalignment=["0.8 mrad", "0.3 mrad"]'])  # fmt: skip
    system = planned_system(case)
    point = stability_points(case, [SPEED])[1][0]
    rest, journal = resting_position(system, OMEGA).displacements, system.rotor.journals[0, :2]
    aside = 1e-4 * system.clearances[0] * np.linalg.pinv(journal) @ np.array([1.0, 0.0])
    found = run(system, 40e-3, rest + aside, FINE).q
    x, y = (journal @ (found - rest).T)[:, 100:]
    fitted = slowest(x + 1j * y, 1e-4, 16)
    nearest = point.eigenvalues[np.argmin(np.abs(point.eigenvalues - fitted))]
    assert abs(fitted - nearest) < 1e-3 * abs(nearest)


def test_a_run_tells_the_given_tilt(tmp_path: Path) -> None:
    settings = ["film.theory=finite", MESH, 'bearing.misalignment=["0.5 mrad", "-0.3 mrad"]', "speed.from=100 Hz",
                "speed.to=100 Hz", "speed.duration=5 ms", "output.step=1 ms"]  # fmt: skip
    found = frbcli.runup(load_case("jeffcott", settings), tmp_path / "run.h5")
    assert found["tilt_x_rad"] == pytest.approx(-5e-4, rel=1e-9)
    assert found["tilt_y_rad"] == pytest.approx(3e-4, rel=1e-9)
    assert np.all(found["end_eccentricity"] > found["eccentricity"])


def test_plan_counts_cells_over_the_whole_width() -> None:
    """A film that follows the tilt has as many cells on each half of its width as are asked for, and else eight over
    the whole of it for five on each half of one that does not."""
    for target in (5e-3, 3e-3):
        setting = f"accuracy.target={target!r}"
        case = rigid_shaft("film.tilt=follows", setting)
        flat, follows = make_plan(rigid_shaft("film.solution=cells", setting)), make_plan(case)
        assert flat.cells is not None
        assert follows.cells is not None
        assert follows.tolerance == flat.tolerance
        assert follows.film_error <= target
        assert follows.cells[1] < 2 * flat.cells[1]
        worst = worst_film(case, follows.eccentricity)
        assert follows.film_error == worst.of((follows.cells[0], 5 / 8 * follows.cells[1]))
    given = make_plan(rigid_shaft("film.tilt=follows", "accuracy.mesh=[6, 48]"))
    assert given.cells == (48, 12)


SHELL = 'bearing.misalignment=["0.5 mrad", "0 mrad"]'


@pytest.mark.parametrize(
    "case",
    [rigid_shaft("film.tilt=follows"), load_case("jeffcott", ["film.theory=finite", SHELL])],
    ids=["journals", "shell"],
)
def test_a_ladder_counts_cells_as_the_plan_does(case: Case) -> None:
    """The rung of the plan, written as the setting of a case, is the plan again."""
    plan = make_plan(case)
    own = planned_rung(plan)
    assert own.mesh is not None
    assert make_plan(case.with_settings(f"accuracy.mesh=[{own.mesh[0]}, {own.mesh[1]}]")).cells == plan.cells
    assert own in list(ladder(case, own))


def slowest(signal: Array, step: float, order: int = 8) -> complex:
    """The exponent of what is left of a signal at its end, by linear prediction (Prony)."""
    rows = np.array([signal[i : i + order] for i in range(len(signal) - order)])
    taps = np.linalg.lstsq(rows, signal[order:], rcond=1e-10)[0]
    roots = np.roots(np.concatenate([[1.0], -taps[::-1]]))
    basis = roots[None, :] ** np.arange(len(signal))[:, None]
    weights = np.linalg.lstsq(basis, signal, rcond=1e-12)[0]
    largest = np.argmax(np.abs(weights * basis[len(signal) // 2]))
    return complex(np.log(roots[largest]) / step)


def test_a_journal_touches_at_its_end(tmp_path: Path) -> None:
    """A heavy disk beside the bearings tilts the journals until one touches, long before its middle does."""
    case = rigid_shaft(
        "film.tilt=follows", "film.cavitation=half-sommerfeld", MESH, "disk.0.position=20 mm", "disk.0.mass=3 kg",
        "speed.duration=0.1 s", "output.step=0.1 ms",
    )  # fmt: skip
    found = frbcli.runup(case, tmp_path / "run.h5")
    assert found.status == "contact"
    assert found["end_eccentricity_right"].max() > 0.9
    assert found["eccentricity_right"][-1] < found["end_eccentricity_right"][-1]
    assert [event["kind"] for event in found.events][-1] == "contact"
    assert np.hypot(found["tilt_right_x_rad"], found["tilt_right_y_rad"]).max() > 0.1 * 30e-6 / WIDTH
