"""The threshold of a conical whirl in run-ups and by stability, with and without tilt and collar."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from marches import rigid_shaft

import frbcli
from frbcli.case.schema import Case
from frbcli.linear.stability_point import Threshold
from frbcli.scene.tilted import TiltedForm

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
COLLAR = (
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


@pytest.fixture(autouse=True)
def same_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """Machines at rest have the cells of the time loop."""
    monkeypatch.setattr(TiltedForm, "static_cells", ((24, 8), (16, 6)))


@pytest.mark.nightly
@pytest.mark.parametrize("more", [(), TILT, COLLAR], ids=["in line", "tilt", "collar"])
def test_a_conical_whirl_begins_in_run_ups_where_stability_says(more: tuple[str, ...], tmp_path: Path) -> None:
    agree(dumb_bell(*more), [30.0, 80.0], CONE, tmp_path / "run.h5")


@pytest.mark.nightly
def test_the_whirl_of_a_turbocharger_begins_in_run_ups_where_stability_says(tmp_path: Path) -> None:
    """The car turbocharger in single films 32 mm apart that follow its tilt, with its thrust bearing under 40 N."""
    case = frbcli.load_case("turbocharger-car-thrust", [*CAR, *TILT, "axial.load=40 N"])
    agree(case, [250.0, 400.0], OF_THE_CAR, tmp_path / "run.h5")
