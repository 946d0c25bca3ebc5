"""Limit cycles of machines that tilt, and the conical whirls of their run-ups: small motions are those of stability."""

import math
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from marches import flat_films, rigid_shaft

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cycles.shooting.period_map import PeriodMap, period_map, wet_at
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Rest, Shooting
from frbcli.linear.stability import stability_points
from frbcli.linear.stability_point import Threshold
from frbcli.rotor.assembly import PLANE
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import CYCLES, SPEED_CYCLES, WHIRLS
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.tilted import TiltedForm

MESH = "accuracy.mesh=[4, 24]"  # 24 x 8 cells over the whole width
COARSE = "accuracy.mesh=[2, 16]", ((16, 4), (12, 2))  # and those of machines at rest
SPEED_Hz = 300.0
OMEGA = 2.0 * math.pi * SPEED_Hz
FOLLOWS = ("film.tilt=follows", "disk.0.unbalance=0 g*mm", MESH)
ASIDE = "disk.0.position=12 mm"  # beside the middle of the shaft, so that the journals tilt
COLLAR = (
    'thrust_bearing=[{name = "collar", position = "3 mm", side = "both", inner_radius = "5.5 mm", '
    'outer_radius = "11 mm", pads = 4, pad_angle = "75 deg", taper_angle = "50 deg", taper = "20 um", '
    'end_play = "60 um"}]',
    'axial={load="4 N"}',
    "speed.from=10 Hz",
)
INCLINED = ('bearing.misalignment=["0.5 mrad", "-0.3 mrad"]', "film.theory=finite", "rotor.unbalance=0 g*mm", MESH)


@pytest.fixture(autouse=True)
def same_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """Machines at rest have the cells of the time loop."""
    monkeypatch.setattr(TiltedForm, "static_cells", ((24, 8), (16, 6)))


def at_rest(flow: PeriodMap, omega: float) -> Rest:
    rest = settled(Shooting(flow, omega), omega)
    assert rest is not None
    return rest


@pytest.mark.parametrize(
    ("case", "speed_Hz"),
    [
        (rigid_shaft(*FOLLOWS, ASIDE, "film.cavitation=reynolds", *COLLAR), SPEED_Hz),
        (rigid_shaft(*FOLLOWS, "film.cavitation=reynolds", 'bearing.1.misalignment=["1 mrad", "2 mrad"]'), SPEED_Hz),
        (load_case("jeffcott", [*INCLINED, "film.cavitation=reynolds"]), 120.0),
    ],
    ids=["collar", "shell out of line", "Jeffcott"],
)
def test_small_motions_at_rest_grow_as_in_the_linearised_machine(case: Case, speed_Hz: float) -> None:
    """Forces, moments and the collar are those of stability: cylindrical and conical whirls alike."""
    flow, omega = period_map(case), 2.0 * math.pi * speed_Hz
    rest, point = at_rest(flow, omega), stability_points(case, [speed_Hz])[1][0]
    middles = flow.middles(rest.displacement)
    for film, middle, end in zip(point.films, middles, flow.at_ends(np.hypot(*rest.displacement.T)), strict=True):
        np.testing.assert_allclose(film.displacement, middle, atol=1e-5)
        assert end > np.hypot(*middle) + 1e-4
    s = point.eigenvalues
    slow = s[(np.abs(s.imag) > 0.05 * omega) & (np.abs(s.imag) < 0.95 * omega) & (s.real > -0.2 * omega)]
    assert len(slow) >= 2
    for value in slow:
        assert np.abs(rest.eigenvalues - value).min() < 2e-3 * abs(value)


def in_plane(case: Case, flow: PeriodMap) -> PeriodMap:
    """The same machine and the same cells, and films that do not know of a tilt."""
    flat = flat_films(case, flow.system)
    rotor = make_rotor(case, PLANE)
    system = replace(flow.system, films=flat, rotor=rotor)
    return replace(
        flow, system=system, films=flat.loop, journals=rotor.journals, standing=np.zeros((2, 2)),
        clearances=np.array(flat.clearances),
    )  # fmt: skip


@pytest.mark.parametrize(
    "oil",
    [
        ("film.cavitation=half-sommerfeld",),
        pytest.param(("film.cavitation=elrod", "oil.ambient_pressure=1.1 bar"), marks=pytest.mark.nightly),
        pytest.param(("film.cavitation=bubbly",), marks=pytest.mark.nightly),
    ],
    ids=["half-sommerfeld", "elrod", "bubbly"],
)
def test_a_machine_that_moves_in_its_plane_has_the_map_of_films_without_tilt(oil: tuple[str, ...]) -> None:
    """The weight lies in the middle of a rigid symmetric rotor: nothing tilts. The map is the same to round-off, with
    the oil that films keep."""
    case = rigid_shaft(*FOLLOWS, *oil)
    tilted, plane = period_map(case), in_plane(case, period_map(case))
    aside = np.linalg.pinv(tilted.journals.reshape(8, -1)) @ np.tile([0.2, -0.3], 4) * tilted.scale
    ends = [
        flow.passage(wet_at(flow, aside, np.zeros(len(aside)), OMEGA), 5e-3, OMEGA, 300) for flow in (tilted, plane)
    ]
    orbits = [flow.middles(end.displacements) for flow, end in zip((tilted, plane), ends, strict=True)]
    assert np.ptp(orbits[0]) > 0.1
    assert np.abs(orbits[0] - orbits[1]).max() < 1e-9
    assert np.abs(ends[0].end.v - ends[1].end.v).max() < 1e-9 * OMEGA * tilted.scale
    assert np.abs(ends[0].end.content - ends[1].end.content).max() < 1e-8
    assert tilted.held.any() == plane.held.any() == (oil[0] != "film.cavitation=half-sommerfeld")


def test_cycles_over_other_numbers_do_not_follow_and_whirls_with_unbalance_do() -> None:
    tilted, inclined = rigid_shaft("film.tilt=follows"), load_case("rigid", [*INCLINED, "rotor.unbalance=3 g*mm"])
    oil = tilted.with_settings("film.cavitation=elrod"), inclined.with_settings("film.cavitation=two-phase")
    for case, key in ((tilted, "film.tilt"), (inclined, "bearing.misalignment")):
        assert key in [fault.key for fault in faults(case, CYCLES)]
    for case in (tilted, inclined, *oil):
        assert not faults(case, SPEED_CYCLES)
        unbalanced = case.with_settings("disk.0.unbalance=1 g*mm") if case.disks else case
        assert not faults(unbalanced, WHIRLS)


@pytest.mark.nightly
def test_a_diagram_agrees_with_stability_and_with_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk beside the middle: the Hopf point is the threshold of stability, up to the size of the disturbances, 0.5 %
    of the clearance at an eccentricity of 1.6 %. At a constant speed a run ends in the stable cycle."""
    speed, (mesh, static) = 230.0, COARSE
    monkeypatch.setattr(TiltedForm, "static_cells", static)
    case = rigid_shaft(
        *FOLLOWS, ASIDE, mesh, "film.cavitation=half-sommerfeld", "speed.from=222 Hz", "speed.to=250 Hz",
    )  # fmt: skip
    found = frbcli.limit_cycles(case, [speed])
    (hopf,) = found.of("hopf")
    threshold = frbcli.stability(case, [235.0, 250.0], threshold=True).threshold
    assert threshold is not None
    assert hopf.speed_Hz == pytest.approx(threshold.speed_Hz, rel=5e-4)
    assert hopf.frequency_Hz == pytest.approx(threshold.frequency_Hz, rel=1e-3)
    asked = [point for branch in found.branches for point in branch.points if point.kind == "asked"]
    (cycle,) = (point for point in asked if point.stable)
    table = found.to_pandas()
    assert table["end_eccentricity_max_left"].max() >= cycle.end_eccentricity_max[0]
    run = frbcli.runup(
        case.with_settings(
            f"speed.from={speed} Hz", f"speed.to={speed} Hz", "speed.duration=2 s", "output.step=0.1 ms",
            "start.displacement=[0.8, 0]", "accuracy.tolerance=1e-6",
        ),
        tmp_path / "run.h5",
    )  # fmt: skip
    late = run["time_s"] > 1.5
    for number, film in enumerate(("left", "right")):
        assert run[f"eccentricity_{film}"][late].max() == pytest.approx(cycle.eccentricity_max[number], rel=1e-3)
        end = run[f"end_eccentricity_{film}"][late].max()
        assert end == pytest.approx(cycle.end_eccentricity_max[number], rel=1e-3)


LENGTH, SPAN = 60e-3, 8e-3
DISK = (
    '{{name = "{}", position = "{} mm", mass = "20 g", polar_inertia = "0.3 kg*mm^2", '
    'diametral_inertia = "0.2 kg*mm^2"}}'
)
PUSH = {
    "at": "rear",
    "force": ["0.1 N", "0 N"],
    "over_time": {"time": [0.0, 2e-3, 4e-3, 10.0], "x": [0.0, 1.0, 0.0, 0.0]},
}
TILT = ("film.tilt=follows",)
SMALL_COLLAR = (
    'thrust_bearing=[{name = "collar", position = "15 mm", side = "both", inner_radius = "5.5 mm", '
    'outer_radius = "9 mm", pads = 4, pad_angle = "75 deg", taper_angle = "50 deg", taper = "20 um", '
    'end_play = "200 um"}]',
    'axial={load="0.02 N"}',
)


def dumb_bell(*more: str) -> Case:
    """A shaft with a disk at each end, rigid and mirrored, in two bearings 5 mm wide and 8 mm apart: its conical whirl
    is the first one to grow."""
    return rigid_shaft(
        f'shaft=[{{length = "{LENGTH} m", diameter = "10 mm", density = "7850 kg/m^3", youngs_modulus = "2.1e11 Pa"}}]',
        f"bearing.0.position={0.5 * (LENGTH - SPAN)} m", f"bearing.1.position={0.5 * (LENGTH + SPAN)} m",
        f"disk=[{DISK.format('front', 5)}, {DISK.format('rear', 55)}]", "film.cavitation=half-sommerfeld",
        "accuracy.mesh=[4, 24]", *more,
    )  # fmt: skip


FILM = 'kind = "single-film", width = "5 mm", diameter = "7 mm", clearance = "15 um"'
CAR = (
    f'bearing=[{{name = "left", position = "42 mm", {FILM}}}, {{name = "right", position = "74 mm", {FILM}}}]',
    "disk.1.unbalance=0 g*mm", "disk.2.unbalance=0 g*mm", "accuracy.mesh=[4, 24]",
)  # fmt: skip
CAR_PUSH = PUSH | {"at": "compressor", "force": ["1 N", "0 N"]}


class Whirl(NamedTuple):
    """How a whirl is set going, and the shares of both journals that it is seen by: a cone by their difference."""

    push: dict[str, object]
    left: float
    right: float


CONE, OF_THE_CAR = Whirl(PUSH, -1.0, 1.0), Whirl(CAR_PUSH, 1.0, 0.0)


def threshold_in_run_up(case: Case, found: Threshold, whirl: Whirl, path: Path) -> float:
    """Where a push on one disk ceases to fade in a ramp and begins to grow, in Hz: the amplitude of a whirl has its
    minimum where its rate of growth is zero.

    Second differences over half a period of the whirl do not see the resting position, which moves along the ramp."""
    duration, step = 0.8, 1e-4
    low, high = 0.8 * found.speed_Hz, 1.2 * found.speed_Hz
    run = frbcli.runup(
        case.with_settings(
            f"speed.from={low} Hz", f"speed.to={high} Hz", f"speed.duration={duration} s",
            "start.position=resting", f"output.step={step} s", "accuracy.tolerance=1e-6", {"force": [whirl.push]},
        ),
        path,
    )  # fmt: skip
    half = round(0.5 / (found.frequency_Hz * step))
    left, right = (np.array([run[f"journal_{name}_{x}_m"] for x in "xy"]) for name in ("left", "right"))
    seen = whirl.left * left + whirl.right * right
    size = np.hypot(*(seen[:, 2 * half :] - 2.0 * seen[:, half:-half] + seen[:, : -2 * half]))
    t = run["time_s"][half:-half]
    inner = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
    inner = inner[t[inner] > 0.05]
    curve = np.polynomial.Polynomial.fit(t[inner], np.log(size[inner]), 3)
    turns = [float(root.real) for root in curve.deriv().roots() if abs(root.imag) < 1e-9 and 0.1 < root.real < 0.7]
    (least,) = (turn for turn in turns if curve.deriv(2)(turn) > 0.0)
    return low + (high - low) * least / duration


def agree(case: Case, speeds: list[float], whirl: Whirl, path: Path) -> None:
    found = frbcli.stability(case, speeds, threshold=True).threshold
    assert found is not None
    assert threshold_in_run_up(case, found, whirl, path) == pytest.approx(found.speed_Hz, rel=1e-2)


@pytest.mark.nightly
@pytest.mark.parametrize("more", [(), TILT, SMALL_COLLAR], ids=["in line", "tilt", "collar"])
def test_a_conical_whirl_begins_in_run_ups_where_stability_says(more: tuple[str, ...], tmp_path: Path) -> None:
    agree(dumb_bell(*more), [30.0, 80.0], CONE, tmp_path / "run.h5")


@pytest.mark.nightly
def test_the_whirl_of_a_turbocharger_begins_in_run_ups_where_stability_says(tmp_path: Path) -> None:
    """The car turbocharger in single films 32 mm apart that follow its tilt, with its thrust bearing under 40 N."""
    case = frbcli.load_case("turbocharger-car-thrust", [*CAR, *TILT, "axial.load=40 N"])
    agree(case, [250.0, 400.0], OF_THE_CAR, tmp_path / "run.h5")
