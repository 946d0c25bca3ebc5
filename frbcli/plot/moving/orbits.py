"""The orbits of the journals as a moving picture."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from frbcli.analysis.signals import joined, points, speed_at
from frbcli.case.course.speed import given_speed_unit
from frbcli.plot.moving.writer import DPI, FRAMES, Observer, check_animation, write_animation
from frbcli.plot.run.envelope import at_times
from frbcli.plot.run.orbit import LAST_s
from frbcli.plot.signals import MICRO, cut, ends, heading, motion, shell
from frbcli.plot.style import BLUE, GREY, new_figure, styled
from frbcli.results.store import Run

BETWEEN = 24  # points of the trail per frame
TRAIL = 2.0  # revolutions of the rotor that stay seen


def animate_orbits(
    run: Run, path: str | Path, from_time: float | None = None, to_time: float | None = None, frames: int = FRAMES,
    dpi: int = DPI, observe: Observer | None = None, force: bool = False,
) -> Path:  # fmt: skip
    """Write the orbits of all journals from from_time to to_time in s (default: the last 0.1 s) as a moving picture.

    force: also replace a file that frb did not write. Raises InputError if it cannot be written, RunFileError if
    the run has no samples between these times.
    """
    path = Path(path)
    check_animation(path, force)
    end = ends(run)[1] if to_time is None else to_time
    begin = max(end - LAST_s, 0.0) if from_time is None else from_time
    cut(run, begin, end)
    with styled():
        write_animation(path, *_scene(run, begin, end, frames), frames, dpi, observe, force)
    return path


def _scene(run: Run, begin: float, end: float, frames: int) -> tuple[Figure, Callable[[int], None]]:
    """The figure, and what draws a frame on it by its number."""
    bearings = list(points(run.signals, "journal")) or [""]
    title, subtitle = heading([run])
    figure = new_figure(title, subtitle, 3.8 * len(bearings) + 0.4, 4.4)
    times = np.linspace(begin, end, frames * BETWEEN)
    turn = 1.0 / max(abs(speed_at(run, 0.5 * (begin + end))), 1.0 / (end - begin))
    kept = max(2, int(TRAIL * turn / (times[1] - times[0])))
    lines = []
    for axes, bearing in zip(figure.subplots(1, len(bearings), squeeze=False)[0], bearings, strict=True):
        x, y = (MICRO * at_times(run, part, times) for part in motion(run, joined("journal", bearing)))
        _prepare(axes, bearing, _radius(run, bearing), float(np.max(np.hypot(x, y))))
        trail = axes.plot([], [], color=BLUE, linewidth=1.0)[0]
        dot = axes.plot([], [], color=BLUE, marker="o", markersize=5.0, linestyle="none")[0]
        lines.append((x, y, trail, dot))
    unit = given_speed_unit(run.case_text)
    caption = figure.text(0.99, 0.015, "", ha="right", fontsize=9.0)

    def draw(frame: int) -> None:
        last = (frame + 1) * BETWEEN
        first = max(0, last - kept)
        for x, y, trail, dot in lines:
            trail.set_data(x[first:last], y[first:last])
            dot.set_data(x[last - 1 : last], y[last - 1 : last])
        now = float(times[last - 1])
        caption.set_text(f"{now:.4f} s, {unit.words(speed_at(run, now), 1)}")

    return figure, draw


def _radius(run: Run, bearing: str) -> float:
    """The radius of the circle around a journal in um, 0 without a film."""
    return MICRO * (shell(run, bearing) or 0.0)


def _prepare(axes: Axes, bearing: str, radius: float, reach: float) -> None:
    axes.set_title(bearing)
    if radius > 0.0:
        axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor=GREY, linewidth=1.2))
    widest = 1.08 * max(radius, reach)
    axes.set_xlim(-widest, widest)
    axes.set_ylim(-widest, widest)
    axes.set_aspect("equal")
    axes.set_xlabel("x in µm")
    axes.set_ylabel("y in µm")
