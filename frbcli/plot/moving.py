"""Moving pictures, GIF, or MP4 where ffmpeg is installed: the orbits of the journals; and a film of a run on its way,
as far as the run has kept it, oil fraction and free gas over the whole gap, also at some moments side by side."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.ticker import MaxNLocator

from frbcli.analysis.signals import films, joined, points, speed_at
from frbcli.case.run import speed_unit_of
from frbcli.plot.motion import LAST_s
from frbcli.plot.signals import MICRO, at_times, cut, ends, heading, motion, shell
from frbcli.plot.style import BLUE, GREY, LEVEL_MAP, VERMILION, new_figure, orbit_axes, refused, styled
from frbcli.results.container import refuse
from frbcli.results.store import KeptFilm, Run, kept_film
from frbcli.results.write import MARK, PICTURES, require_places, written

FORMATS = (".gif", ".mp4")
FRAMES, PER_SECOND = 80, 20
DPI = 90
GIF_ENDS = b";"

Observer = Callable[[int, int], None]  # frames drawn, and how many there are
BETWEEN = 24  # points of the trail per frame
TRAIL = 2.0  # revolutions of the rotor that stay seen
MOMENTS = 6  # side by side in a still picture
COLUMNS, COURSE = 256, 400  # of a map around, and points of a curve over time
MAP_HEIGHT, COURSE_HEIGHT, WIDTH = 0.75, 1.5, 8.0  # inches
TICKS = 5  # of a scale, at most
NEARLY_FULL, GAS_FREE = 0.99, 1e-3  # least upper ends of the scales of missing oil and of gas


def check_animation(path: Path, force: bool = False) -> None:
    """Raises InputError if a moving picture cannot have this name or this place, or its program is missing. force: also
    replace a file that frb did not write."""
    if path.suffix.lower() not in FORMATS:
        raise refused(path, "is not a format of moving pictures.", f"End it with {' or '.join(FORMATS)}.")
    if path.suffix.lower() == ".mp4" and _ffmpeg() is None:
        raise refused(path, "needs the program ffmpeg, which is not here.", "Install it, or end the name with .gif.")
    require_places([(path, PICTURES[path.suffix.lower()])], force=force)


def _ffmpeg() -> str | None:
    """The program ffmpeg, not one of the current folder; None if there is none."""
    program = shutil.which(mpl.rcParams["animation.ffmpeg_path"])
    return program if program is not None and os.path.isabs(program) else None


def write_animation(
    path: Path, figure: Figure, draw: Callable[[int], None], frames: int, dpi: int = DPI,
    observe: Observer | None = None, force: bool = False,
) -> None:  # fmt: skip
    """Write a figure as a moving picture; draw: changes it to a frame of that number; force: see check_animation."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # it would be sought anew for each frame
    moving: Any = FuncAnimation(figure, draw, frames=frames, blit=False)
    as_film = path.suffix.lower() == ".mp4"
    writer: Any = FFMpegWriter(PER_SECOND, metadata={"comment": MARK}) if as_film else PillowWriter(PER_SECOND)
    progress = None if observe is None else lambda frame, _: observe(frame + 1, frames)
    with written(path, PICTURES[path.suffix.lower()], force=force) as part, TemporaryDirectory(prefix="frb-") as folder:
        drawn = Path(folder) / f"moving{path.suffix.lower()}"  # by which its writers know the format
        with mpl.rc_context({"animation.ffmpeg_path": _ffmpeg() or ""}):
            moving.save(str(drawn), writer=writer, dpi=dpi, progress_callback=progress)
        if not as_film:
            _comment(drawn)
        shutil.copyfile(drawn, part)


def _comment(gif: Path) -> None:
    """Put the mark of frb into a GIF, as a comment in front of the byte that ends it."""
    with gif.open("r+b") as file:
        file.seek(-len(GIF_ENDS), os.SEEK_END)
        file.write(b"!\xfe" + bytes([len(MARK)]) + MARK.encode() + b"\0" + GIF_ENDS)


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
        _prepare(axes, bearing, MICRO * (shell(run, bearing) or 0.0), float(np.max(np.hypot(x, y))))
        trail = axes.plot([], [], color=BLUE, linewidth=1.0)[0]
        dot = axes.plot([], [], color=BLUE, marker="o", markersize=5.0, linestyle="none")[0]
        lines.append((x, y, trail, dot))
    unit = speed_unit_of(run)
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


def _prepare(axes: Axes, bearing: str, radius: float, reach: float) -> None:
    axes.set_title(bearing)
    if radius > 0.0:
        axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor=GREY, linewidth=1.2))
    orbit_axes(axes, 1.08 * max(radius, reach))


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
        maps[0, column].set_title(label.partition(",")[0], loc="right", fontsize=8.0)
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
    axes.set(xlim=(times[0], times[-1]), ylim=(0.0, 1.05))
    axes.set_xlabel("time in s", fontsize=8.0)
    axes.set_ylabel("eccentricity,\noil fraction", fontsize=8.0)
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
        axes.set(xlim=(0.0, 360.0), ylim=(0.0, 1.0), xticks=range(0, 361, 90))
    row[0].set_ylabel("z", fontsize=8.0)
    return images, lines


def _moment(run: Run, kept: KeptFilm, frame: int) -> str:
    now = float(kept.times[frame])
    speed = speed_unit_of(run).words(speed_at(run, now), 1)
    return f"{now:.4f} s, {speed}, eccentricity {np.hypot(*kept.places[frame]):.3f}"
