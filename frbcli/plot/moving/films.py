"""A film of a run on its way, as far as the run has kept it: oil fraction and free gas over the whole gap, at some
moments side by side, or as a moving picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from frbcli.analysis.signals import films, joined, speed_at
from frbcli.case.course.speed import given_speed_unit
from frbcli.plot.moving.writer import DPI, FRAMES, Observer, check_animation, write_animation
from frbcli.plot.run.envelope import at_times
from frbcli.plot.signals import cut, heading
from frbcli.plot.style import BLUE, GREY, LEVEL_MAP, VERMILION, new_figure, styled
from frbcli.results.files.container import refuse
from frbcli.results.kept_films import KeptFilm, kept_film
from frbcli.results.store import Run

MOMENTS = 6  # side by side in a still picture
COLUMNS, COURSE = 256, 400  # of a map around, and points of a curve over time
MAP_HEIGHT, COURSE_HEIGHT, WIDTH = 0.75, 1.5, 8.0  # inches
TICKS = 5  # of a scale, at most
NEARLY_FULL, GAS_FREE = 0.99, 1e-3  # least upper ends of the scales of missing oil and of gas


def film_moments_figure(
    run: Run, film: str | None = None, from_time: float | None = None, to_time: float | None = None
) -> Figure:
    """A film at MOMENTS of those that a run has kept from from_time to to_time in s: a row for each.

    A white line marks the smallest gap. Raises RunFileError if the run has kept none.
    """
    kept, first, last = _frames(run, film, from_time, to_time)
    chosen = _even(first, last, MOMENTS)
    with styled():
        figure, above, maps = _panels(run, kept, len(chosen))
        _draw_course(above, run, kept, first, last)
        for row, frame in zip(maps, chosen, strict=True):
            above.axvline(kept.times[frame], color=GREY, linewidth=0.8)
            _draw_maps(row, kept, frame)
            row[0].set_title(_moment(run, kept, frame), fontsize=8.0, loc="left")
    return figure


def animate_films(
    run: Run, path: str | Path, film: str | None = None, from_time: float | None = None, to_time: float | None = None,
    frames: int = FRAMES, dpi: int = DPI, observe: Observer | None = None, force: bool = False,
) -> Path:  # fmt: skip
    """Write a film as a moving picture of at most `frames` of the moments that a run has kept from from_time to to_time
    in s.

    force: also replace a file that frb did not write. Raises InputError if it cannot be written, RunFileError if
    the run has kept none.
    """
    path = Path(path)
    check_animation(path, force)
    kept, first, last = _frames(run, film, from_time, to_time)
    chosen = _even(first, last, frames)
    with styled():
        figure, above, (row,) = _panels(run, kept, 1)
        _draw_course(above, run, kept, first, last)
        now = above.axvline(kept.times[first], color=VERMILION, linewidth=1.2)
        images, lines = _draw_maps(row, kept, first)
        title = row[0].set_title(_moment(run, kept, first), fontsize=9.0, loc="left")

        def draw(number: int) -> None:
            frame = chosen[number]
            now.set_xdata([kept.times[frame]] * 2)
            for image, values in zip(images, _values(kept), strict=True):
                image.set_data(kept.around(frame, values[frame], COLUMNS).T)
            for line in lines:
                line.set_xdata([np.degrees(kept.narrowest(frame))] * 2)
            title.set_text(_moment(run, kept, frame))

        write_animation(path, figure, draw, len(chosen), dpi, observe, force)
    return path


def _frames(run: Run, film: str | None, from_time: float | None, to_time: float | None) -> tuple[KeptFilm, int, int]:
    """A film with the first of its frames in a span of time, and that after the last."""
    kept = kept_film(run, list(films(run.signals)) or [""], film)
    first, last = kept.between(from_time, to_time)
    if last - first < 2:
        remedy = f"It has {len(kept.times)} from {kept.times[0]:.4g} s to {kept.times[-1]:.4g} s."
        raise refuse(run.path, "has not kept two films between the times asked for.", remedy)
    return kept, first, last


def _even(first: int, last: int, most: int) -> list[int]:
    """At most so many frames, evenly chosen."""
    return [int(frame) for frame in np.unique(np.linspace(first, last - 1, min(most, last - first)).round())]


def _values(kept: KeptFilm) -> list[Any]:
    return [kept.oil] if kept.gas is None else [kept.oil, kept.gas]


def _panels(run: Run, kept: KeptFilm, rows: int) -> tuple[Figure, Axes, Any]:
    """A figure with the course of the film above, and rows of maps with their scales below."""
    title, subtitle = heading([run])
    words = ", ".join(text for text in (subtitle, kept.name.replace("_", " ")) if text)
    height = MAP_HEIGHT * rows + 0.9
    figure = new_figure(title, words, WIDTH, COURSE_HEIGHT + height + 0.5)
    parts: Any = figure.subfigures(2, 1, height_ratios=(COURSE_HEIGHT, height))
    maps = parts[1].subplots(rows, len(_values(kept)), sharex=True, sharey=True, squeeze=False)
    for column, (values, label) in enumerate(
        zip(_values(kept), ("oil fraction", "free gas over the oil, at the pressure of saturation"), strict=False)
    ):
        image = maps[0, column].imshow([[0.0]], cmap=LEVEL_MAP)
        image.set_clim(*_scale(values, column))
        bar = parts[1].colorbar(image, ax=maps[:, column], location="bottom", shrink=0.8, aspect=35,
                                ticks=MaxNLocator(TICKS))  # fmt: skip
        bar.set_label(label, fontsize=8.0)
        bar.outline.set_visible(False)
        maps[-1, column].set_xlabel("φ in °, white: smallest gap; z from 0 to 1 along the section", fontsize=8.0)
    return figure, parts[0].subplots(), maps


def _scale(values: Any, column: int) -> tuple[float, float]:
    """Ends of the colours: of oil fractions up to 1, of free gas from 0 on."""
    return (0.0, max(float(values.max()), GAS_FREE)) if column else (min(float(values.min()), NEARLY_FULL), 1.0)


def _draw_course(axes: Axes, run: Run, kept: KeptFilm, first: int, last: int) -> None:
    """The eccentricity of the film, and its mean oil fraction."""
    times = np.linspace(kept.times[first], kept.times[last - 1], COURSE)
    cut(run, float(times[0]), float(times[-1]))
    for signal, colour in (("eccentricity", BLUE), ("oil_fraction", VERMILION)):
        drawn = at_times(run, run.signal(joined(signal, kept.name)), times)
        axes.plot(times, drawn, color=colour, label=signal.replace("_", " "))
    axes.set_xlim(times[0], times[-1])
    axes.set_ylim(0.0, 1.05)
    axes.set_xlabel("time in s", fontsize=8.0)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small")


def _draw_maps(row: Any, kept: KeptFilm, frame: int) -> tuple[list[Any], list[Any]]:
    """The maps of a frame on their axes, and the lines at the smallest gap."""
    images: list[Any] = []
    lines: list[Any] = []
    for axes, values in zip(row, _values(kept), strict=True):
        axes.grid(visible=False)
        low, high = _scale(values, len(images))
        shown = kept.around(frame, values[frame], COLUMNS).T
        images.append(axes.imshow(shown, cmap=LEVEL_MAP, vmin=low, vmax=high, extent=(0.0, 360.0, 0.0, 1.0),
                                  aspect="auto", origin="lower", interpolation="nearest"))  # fmt: skip
        lines.append(axes.axvline(np.degrees(kept.narrowest(frame)), color="white", linewidth=1.0))
        axes.set_xlim(0.0, 360.0)
        axes.set_ylim(0.0, 1.0)
        axes.set_xticks(range(0, 361, 90))
    row[0].set_ylabel("z", fontsize=8.0)
    return images, lines


def _moment(run: Run, kept: KeptFilm, frame: int) -> str:
    now = float(kept.times[frame])
    speed = given_speed_unit(run.case_text).words(speed_at(run, now), 1)
    return f"{now:.4f} s, {speed}, eccentricity {np.hypot(*kept.places[frame]):.3f}"
