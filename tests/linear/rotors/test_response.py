"""The linear unbalance response against closed forms and against the synchronous motion of a run-up."""

import csv
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Frb
from marches import in_two_bearings

from frbcli.analysis.order_tracking import order_track
from frbcli.arrays import larger_semi_axis
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.linear import response as of_response
from frbcli.linear.response import DOUBTFUL, Response, forced_motion, response
from frbcli.linear.stability import stability_points
from frbcli.plot.machine.response import response_figure
from frbcli.rotor.assembly import jeffcott_rotor
from frbcli.runs.run import runup

MASS, JOURNALS, SHAFT, UNBALANCE, OUTER, INNER = 6.0, 0.1, 5e6, 3e-6, 4.0, 0.7


def test_speeds_that_are_given_are_solved_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without films nobody asks for a curve around the peaks, which took minutes of a shaft with hundreds of modes."""
    solved: list[int] = []

    def counted(case: Case, speeds: Sequence[float], *more: Any) -> Any:
        solved.append(len(speeds))
        return stability_points(case, speeds, *more)

    monkeypatch.setattr(of_response, "stability_points", counted)
    case = load_case("seal")
    few = response(case, [20.0, 50.0])
    assert (solved, len(few.speeds_Hz)) == ([2], 2)
    whole = response(case)
    assert len(solved) == 3
    assert len(whole.speeds_Hz) == sum(solved[1:])


@pytest.mark.parametrize("omega", [50.0, 700.0, 912.0, 3000.0])
def test_a_jeffcott_rotor_on_springs_and_dampers_has_its_closed_form(omega: float) -> None:
    """Equal in x and y, and not cross-coupled: z = x + iy turns forward alone, two equations remain."""
    rotor = in_two_bearings(jeffcott_rotor(MASS, JOURNALS, SHAFT, UNBALANCE, OUTER, INNER, 9.81))
    k, c = 3e6, 2e3
    motion = forced_motion(rotor, omega, (omega, omega**2 * rotor.unbalance), k * np.eye(2)[None], c * np.eye(2)[None])
    spring = SHAFT + 1j * omega * INNER
    disk = spring - MASS * omega**2 + 1j * omega * OUTER
    journal = spring - JOURNALS * omega**2 + 2.0 * (k + 1j * omega * c)  # two bearings
    pull = 1j * UNBALANCE * omega**2  # (2.3) at a constant speed: the heavy spot is a quarter of a turn ahead
    z_disk = pull / (disk - spring**2 / journal)
    z_journal = spring / journal * z_disk
    x_journal, x_disk, y_journal, y_disk = motion
    assert 0.5 * (x_disk + 1j * y_disk) == pytest.approx(z_disk, rel=1e-12)
    assert 0.5 * (x_journal + 1j * y_journal) == pytest.approx(z_journal, rel=1e-12)
    assert abs(x_disk - 1j * y_disk) < 1e-12 * abs(x_disk)


@pytest.fixture(scope="module")
def jeffcott() -> Response:
    return response(load_case("jeffcott"))


def test_a_fast_ramp_follows_it_too(tmp_path: Path) -> None:
    """1000 Hz/s, between the transient of the start and the whirl: within 2 %."""
    ramp = ["speed.from=60 Hz", "speed.to=220 Hz", "speed.duration=0.16 s"]
    fast = load_case("rigid", [*ramp, "start.position=resting", "rotor.unbalance=3 g*mm"])
    run = runup(fast, tmp_path / "run.h5")
    track = order_track(run, 1.0, "journal", revolutions=8)
    found = response(fast)
    seen = (track.speed_Hz > 120.0) & (track.speed_Hz < 200.0)
    mine = np.interp(track.speed_Hz[seen], found.speeds_Hz, np.abs(found.forward[:, 0]))
    assert np.abs(track.forward[seen]) == pytest.approx(mine, rel=0.02)


def test_bearing_forces_balance_the_rotor(jeffcott: Response) -> None:
    """Both bearings carry what accelerates disk, journals and unbalance, less the damping from outside."""
    rotor = load_case("jeffcott").rotor
    for i, speed in enumerate(jeffcott.speeds_Hz):
        omega = 2.0 * math.pi * speed
        journal, disk = jeffcott.motion[i]
        pull = omega**2 * rotor.unbalance * np.array([1j, 1.0])  # type: ignore[union-attr]
        inertia = -(omega**2) * (rotor.journal_mass * journal + rotor.mass * disk)  # type: ignore[union-attr]
        outer = 1j * omega * rotor.external_damping * disk  # type: ignore[union-attr]
        assert 2.0 * jeffcott.forces[i, 0] == pytest.approx(inertia + outer - pull, rel=1e-9)


def test_orbits_are_ellipses_with_the_amplitude_as_larger_semi_axis(jeffcott: Response) -> None:
    place = int(np.argmax(jeffcott.amplitude[:, 1]))
    radius = np.hypot(*jeffcott.orbit(place, 1, 3600).T)
    assert radius.max() == pytest.approx(jeffcott.amplitude[place, 1], rel=1e-5)
    smaller = abs(abs(jeffcott.forward[place, 1]) - abs(jeffcott.backward[place, 1]))
    assert radius.min() == pytest.approx(smaller, rel=1e-3)
    assert any(abs(speed - jeffcott.speeds_Hz[place]) < 2.5 for speed in jeffcott.critical_speeds_Hz)


def test_the_command_writes_table_picture_and_document(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    monkeypatch.chdir(tmp_path)
    frb("runup", "jeffcott", "-o", "run.h5", "--no-picture", "--quiet", "--set", "speed.duration=1 s")
    said = frb("response", "jeffcott", "--run", "run.h5", "--csv", "t.csv", "--json")
    text = frb("response", "jeffcott", "--run", "run.h5", "--csv", "t.csv").out
    document = json.loads(said.out)
    assert {"speed_Hz", "node", "amplitude_m", "phase_deg"} <= set(document["points"][0])
    speeds = 120 + len(document["critical_speeds"])
    assert 2 * 120 < len(document["points"]) <= 2 * (speeds + 6)  # films are solved at their peaks, too
    # one resonance: of the disk at 142 Hz, of the journal at 131 Hz, and listed where more moves
    assert document["critical_speeds_Hz"] == pytest.approx([141.8], abs=1.0)
    assert max(map(len, text.splitlines())) <= 80
    rows = list(csv.DictReader((tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()))
    assert float(rows[-1]["amplitude_m"]) == pytest.approx(document["points"][-1]["amplitude_m"])
    assert (tmp_path / "jeffcott-response.png").read_bytes().startswith(b"\x89PNG")


def test_the_picture_has_the_orbits_at_the_largest_amplitude_and_the_highest_speed(jeffcott: Response) -> None:
    panels = [axes for axes in response_figure(jeffcott).axes if axes.lines]  # without those of the legends
    assert len(panels) == 6
    assert all(panel.get_title(loc="left") for panel in panels)
    for panel, speed in zip(panels[4:], (int(np.argmax(jeffcott.amplitude.max(axis=1))), -1), strict=True):
        assert panel.get_title(loc="left") == f"orbits at {jeffcott.speeds_Hz[speed]:.4g} Hz; dots: mark along x"
        for number, curve in enumerate(panel.lines[::2]):
            reach = np.hypot(*curve.get_data()).max()
            assert reach == pytest.approx(1e6 * jeffcott.amplitude[speed, number], rel=1e-3)


# --- motions that linear coefficients do not describe ---


@pytest.mark.parametrize(("unbalance", "kinds"), [
    ("3 g*mm", {"linear"}), ("400 g*mm", {"linear", "doubtful", "beyond-gap"}),
])  # fmt: skip
def test_motions_beyond_the_gap_are_told(
    unbalance: str, kinds: set[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    """In table, JSON, CSV and picture, by the eccentricity on the orbit about the resting position."""
    monkeypatch.chdir(tmp_path)
    words = ["response", "jeffcott", "--set", "film.theory=short", "--set", f"rotor.unbalance={unbalance}"]
    said = frb(*words, "--json", "--csv", "t.csv", "--no-picture")
    text = frb(*words, "--csv", "t.csv", "--no-picture").out
    document = json.loads(said.out)
    assert {point["validity"] for point in document["points"]} == kinds
    largest = max(film["eccentricity_max"] for film in document["films"])
    for mark, kind in (("?: doubtful at", "doubtful"), ("!: not possible at", "beyond-gap")):
        assert (mark in text) == (kind in kinds)
    assert ("up to an eccentricity of" in text.replace("\n", " ")) == (largest >= 1.0)
    assert max(map(len, text.splitlines())) <= 80
    rows = list(csv.DictReader((tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()))
    assert {row["validity"] for row in rows} == kinds
    found = response(load_case("jeffcott", ["film.theory=short", f"rotor.unbalance={unbalance}"]))
    amplitude = response_figure(found).axes[0]
    assert len(amplitude.patches) >= len(kinds - {"linear"})
    gap = [line for line in amplitude.lines if line.get_label() == "clearance"]
    assert [float(line.get_ydata()[0]) for line in gap] == ([35.0] if kinds != {"linear"} else [])


def test_the_largest_eccentricity_is_that_of_the_orbit_about_the_resting_position() -> None:
    found = response(load_case("jeffcott", ["film.theory=short", "rotor.unbalance=200 g*mm"]), [60.0, 90.0])
    for number, point in enumerate(found.resting):
        orbit = found.orbit(number, found.points.index("journal"), 720) / 35e-6
        places = orbit + point.films[0].displacement
        assert found.eccentricity_max[number, 0] == pytest.approx(np.hypot(*places.T).max(), rel=1e-4)
        left = 1.0 - point.films[0].eccentricity
        assert found.gap_share[number, 0] == pytest.approx(np.hypot(*orbit.T).max() / left, rel=1e-4)


@pytest.mark.parametrize(("name", "unbalance", "to_Hz"), [
    ("jeffcott", 60, 170), pytest.param("rigid", 100, 160, marks=pytest.mark.nightly),
])  # fmt: skip
def test_linear_amplitudes_hold_up_to_the_share_of_the_gap_that_is_called_doubtful(
    name: str, unbalance: int, to_Hz: float
) -> None:
    """Against the nonlinear synchronous response: 4 % up to a tenth of the gap that is left, 15 % up to DOUBTFUL."""
    case = load_case(name, ["film.theory=short", f"rotor.unbalance={unbalance} g*mm", f"speed.to={to_Hz} Hz"])
    nonlinear = limit_cycles(case).synchronous
    found = response(case, [point.speed_Hz for point in nonlinear])
    for number, speed in enumerate(found.speeds_Hz):
        for point in nonlinear:
            if point.speed_Hz != pytest.approx(speed, rel=1e-12):
                continue
            share = found.gap_share[number, 0]
            linear = larger_semi_axis(found.in_films[number, 0])
            error = abs(2.0 * larger_semi_axis(point.harmonics[1, 0]) / linear - 1.0)
            assert error < (0.04 if share < 0.1 else 0.15 if share < DOUBTFUL else math.inf)
    assert found.gap_share.max() > DOUBTFUL
