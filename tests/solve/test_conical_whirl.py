"""The threshold of a conical whirl in run-ups and by stability, with and without tilt and collar."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from marches import rigid_shaft

import frbcli
from frbcli.case.schema import Case
from frbcli.scene.forms.tilted import TiltedForm

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


def threshold_in_run_up(case: Case, speeds: tuple[float, float], path: Path) -> float:
    """Where a push on one disk ceases to fade in a ramp and begins to grow, in Hz: the amplitude of the cone, the
    difference of both journals, has its minimum where its rate of growth is zero."""
    duration = 0.8
    run = frbcli.runup(
        case.with_settings(
            f"speed.from={speeds[0]} Hz", f"speed.to={speeds[1]} Hz", f"speed.duration={duration} s",
            "start.position=resting", "output.step=0.1 ms", "accuracy.tolerance=1e-6", {"force": [PUSH]},
        ),
        path,
    )  # fmt: skip
    t = run["time_s"]
    cone = np.hypot(*(run[f"journal_right_{x}_m"] - run[f"journal_left_{x}_m"] for x in "xy"))
    inner = np.flatnonzero((cone[1:-1] > cone[:-2]) & (cone[1:-1] >= cone[2:])) + 1
    inner = inner[t[inner] > 0.05]
    curve = np.polynomial.Polynomial.fit(t[inner], np.log(cone[inner]), 3)
    turns = [float(root.real) for root in curve.deriv().roots() if abs(root.imag) < 1e-9 and 0.1 < root.real < 0.7]
    (least,) = (turn for turn in turns if curve.deriv(2)(turn) > 0.0)
    return speeds[0] + (speeds[1] - speeds[0]) * least / duration


@pytest.mark.nightly
@pytest.mark.parametrize("more", [(), TILT, COLLAR], ids=["in line", "tilt", "collar"])
def test_a_conical_whirl_begins_in_run_ups_where_stability_says(
    more: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(TiltedForm, "static_cells", ((24, 8), (16, 6)))
    case = dumb_bell(*more)
    found = frbcli.stability(case, [30.0, 80.0]).threshold
    assert found is not None
    low, high = 0.8 * found.speed_Hz, 1.2 * found.speed_Hz
    assert threshold_in_run_up(case, (low, high), tmp_path / "run.h5") == pytest.approx(found.speed_Hz, rel=1e-2)
