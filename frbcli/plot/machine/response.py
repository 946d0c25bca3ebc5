"""The linear unbalance response: Bode and polar diagrams of the points, forces of the bearings, and orbits; and the
undamped critical speed map, with the stiffness of the films of the case over it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.order_tracking import OrderTrack
from frbcli.arrays import Array, larger_semi_axis
from frbcli.linear.modes import CriticalMap
from frbcli.linear.response import BEYOND_GAP, DOUBTFUL_MOTION, SOUND, UNBALANCE, Response
from frbcli.plot.style import (
    BAND,
    BLACK,
    BLUE,
    COLOURS,
    GREY,
    ORANGE,
    VERMILION,
    legend_below,
    legend_beside,
    new_figure,
    styled,
)

MICRO = 1e6
STABLE, GROWING = "-", (0, (1, 1.5))  # lines of motions that are seen, and of those that a whirl hides
GAP = (0, (4, 2))  # line of a clearance
SHADES = {DOUBTFUL_MOTION: 0.12, BEYOND_GAP: 0.3}
LABELS = {DOUBTFUL_MOTION: "linear coefficients doubtful", BEYOND_GAP: "an orbit leaves its gap"}
DASHES = ("-", (0, (5, 2)), (0, (5, 1, 1, 1)))  # of more points than there are colours

FEW = 10  # speeds of films: they are marked, as fewer than two are no line
FILM_DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)))
FILM_MARKS = ("o", "D", "^")
APART = 0.04  # of the range of speeds: numbers of critical speeds that are nearer stand above each other
MARGIN = 1.02  # of the axis of the speeds over the highest one
NAME_COLUMNS, NAME_HEIGHT = (6, 28), 13.0  # points right of a critical map, and between names of its modes
LAID_OUT, POINTS_PER_INCH = 0.85, 72.0  # height of axes over the height before titles and legends have their room
LABEL_HEIGHT, LEVELS = 14, 4  # points between these numbers, and how many stand above each other


def response_figure(motion: Response, tracks: Sequence[OrderTrack] = ()) -> Figure:
    """Amplitude and phase over the rotor speed, the forward motion in the complex plane, the bearing forces, and the
    orbits at two speeds, see _orbit_speeds.

    Dotted where a whirl grows, so that the motion is not seen. tracks: synchronous motion in a run, of points of the
    response by their signals, drawn over it as thin black lines.
    """
    case = motion.case
    with styled():
        grows = ", dotted where a whirl grows and hides it" if (motion.growth > 0.0).any() else ""
        figure = new_figure(case.heading, f"linear {motion.what} about the static equilibrium{grows}", 9.6, 10.8)
        amplitude, polar, phase, force, first, second = figure.subplots(3, 2).ravel()
        draw_amplitude(amplitude, motion)
        for number in range(len(motion.points)):
            colour, dash = _line_of(number)
            _line(phase, motion, motion.phase_deg[:, number], colour, dash, None)
            _polar(polar, motion, number, colour, dash)
        sizes = larger_semi_axis(motion.forces)
        for number, name in enumerate(motion.bearings):
            _line(force, motion, sizes[:, number], *_line_of(number), name.replace("_", " ") or "bearing")
        for track in tracks:
            size = np.abs(track.forward) + np.abs(track.backward)
            amplitude.plot(track.speed_Hz, MICRO * size, color=BLACK, linewidth=0.6, label=f"{track.signal} in the run")
        phase.set_ylabel("phase of the forward motion in °")
        force.set_ylabel("force amplitude of a bearing in N")
        for panel in (phase, force):
            _speed_axis(panel, motion)
            _doubts(panel, motion)
        for panel in (amplitude, force):
            panel.set_ylim(bottom=0.0)
        polar.set_aspect("equal", adjustable="datalim")
        polar.set_xlabel(f"forward motion in phase with the {'mark' if motion.excitation == UNBALANCE else 'load'}, µm")
        polar.set_ylabel("90° ahead, µm")
        names = (
            "Bode diagram: amplitude", "polar diagram; dots: highest speed", "Bode diagram: phase", "bearing forces"
        )  # fmt: skip
        for panel, name in zip((amplitude, polar, phase, force), names, strict=True):
            panel.set_title(name)
        for panel, speed in zip((first, second), _orbit_speeds(motion), strict=False):
            _orbits(panel, motion, speed)
        if len(_orbit_speeds(motion)) < 2:
            second.set_visible(False)
        legend_below(figure, amplitude, columns=4)
        legend_beside(force)
    return figure


def _orbit_speeds(motion: Response) -> list[int]:
    """The numbers of the speeds of the orbits, ascending: the speed of the largest amplitude and the highest one, or
    where both are one, the middle one and the highest."""
    last = len(motion.speeds_Hz) - 1
    largest = int(np.argmax(motion.amplitude.max(axis=1)))
    return sorted({largest if largest != last else last // 2, last})


def draw_amplitude(axes: Axes, motion: Response) -> None:
    """The larger semi-axes of all points over the rotor speed on axes of a figure, with bands of their expected errors
    and the critical speeds."""
    for number, name in enumerate(motion.points):
        size, error = (MICRO * values[:, number] for values in (motion.amplitude, motion.amplitude_error))
        _line(axes, motion, size, *_line_of(number), name.replace("_", " "))
        axes.fill_between(
            motion.speeds_Hz, size - error, size + error, color=_line_of(number)[0], alpha=BAND, linewidth=0.0
        )
    close = APART * float(np.ptp(motion.speeds_Hz))
    for number, peak in enumerate(motion.critical_speeds, start=1):
        above = sum(peak.speed_Hz - other.speed_Hz < close for other in motion.critical_speeds[: number - 1]) % LEVELS
        factor = "" if peak.amplification_factor is None else f", factor {peak.amplification_factor:.3g}"
        words = f"{number}: {motion.case.speed_unit.words(peak.speed_Hz)}, {peak.direction}{factor}"
        axes.axvline(peak.speed_Hz, color=GREY, linewidth=0.6, linestyle=(0, (4, 3)), label=words)
        # at the bottom, since the curves are high there
        axes.annotate(str(number), (peak.speed_Hz, 0.0), (0, 8 + LABEL_HEIGHT * above),
                      xycoords=("data", "axes fraction"), textcoords="offset points", fontsize=7, ha="center",
                      va="center", bbox={"boxstyle": "circle,pad=0.2", "facecolor": "white", "edgecolor": GREY}
                      )  # fmt: skip
    if set(motion.validity) != {SOUND}:
        _doubts(axes, motion, labelled=True)
        for number, clearance in enumerate(np.unique(motion.clearances, axis=1).T):
            label = None if number else "clearance"
            axes.plot(motion.speeds_Hz, MICRO * clearance, color=BLACK, linewidth=0.8, linestyle=GAP, label=label)
    axes.set_ylabel("amplitude in µm (larger semi-axis)")
    _speed_axis(axes, motion)
    axes.set_ylim(bottom=0.0)


def _doubts(axes: Axes, motion: Response, labelled: bool = False) -> None:
    """Shades the speeds at which linear coefficients are doubtful, darker where an orbit leaves its gap."""
    speeds = motion.speeds_Hz
    edges = np.concatenate([speeds[:1], 0.5 * (speeds[1:] + speeds[:-1]), speeds[-1:]])
    for kind, depth in SHADES.items():
        there = np.array([validity == kind for validity in motion.validity])
        begins = np.flatnonzero(there & ~np.insert(there[:-1], 0, False))
        ends = np.flatnonzero(there & ~np.append(there[1:], False))
        for number, (begin, end) in enumerate(zip(begins, ends, strict=True)):
            label = LABELS[kind] if labelled and number == 0 else None
            axes.axvspan(edges[begin], edges[end + 1], color=GREY, alpha=depth, linewidth=0.0, zorder=0.2, label=label)


def _orbits(axes: Axes, motion: Response, speed: int) -> None:
    """The orbits of all points about their static equilibrium at a speed, by its number; a dot where each is while the
    mark of the rotor points along x, or the angle of the load that excites alone is 0."""
    for number in range(len(motion.points)):
        colour, dash = _line_of(number)
        x, y = MICRO * motion.orbit(speed, number).T
        axes.plot(np.append(x, x[0]), np.append(y, y[0]), color=colour,
                  linestyle=GROWING if motion.growth[speed] > 0.0 else dash)  # fmt: skip
        axes.plot(x[0], y[0], color=colour, marker="o", markersize=4.0)
    axes.set_aspect("equal", adjustable="datalim")
    dots = "mark along x" if motion.excitation == UNBALANCE else f"{motion.excitation} at angle 0"
    axes.set(title=f"orbits at {motion.case.speed_unit.words(motion.speeds_Hz[speed])}; dots: {dots}", xlabel="x in µm")
    axes.set_ylabel("y in µm")


def _speed_axis(axes: Axes, motion: Response) -> None:
    axes.set(xlabel="rotor speed in Hz", xlim=(0.0, MARGIN * float(motion.speeds_Hz[-1])))


def _line_of(number: int) -> tuple[str, object]:
    """Colour and dashes."""
    return COLOURS[number % len(COLOURS)], DASHES[number // len(COLOURS) % len(DASHES)]


def _line(axes: Axes, motion: Response, values: Array, colour: str, dash: object, label: str | None) -> None:
    """A curve over the speed, dotted where a whirl grows."""
    grows = motion.growth > 0.0
    alone = "o" if len(motion.speeds_Hz) == 1 else ""  # no line goes through one speed
    style: dict[str, Any] = {"color": colour, "marker": alone}
    axes.plot(motion.speeds_Hz, np.where(grows, np.nan, values), linestyle=dash, label=label, **style)
    if grows.any():
        dotted = grows | np.append(grows[1:], False) | np.insert(grows[:-1], 0, False)
        axes.plot(motion.speeds_Hz, np.where(dotted, values, np.nan), linestyle=GROWING, **style)


def _polar(axes: Axes, motion: Response, number: int, colour: str, dash: object) -> None:
    forward = MICRO * motion.forward[:, number]
    grows = motion.growth > 0.0
    axes.plot(np.where(grows, np.nan, forward.real), forward.imag, color=colour, linestyle=dash)
    axes.plot(np.where(grows, forward.real, np.nan), forward.imag, color=colour, linestyle=GROWING)
    axes.plot(forward.real[-1], forward.imag[-1], color=colour, marker="o", markersize=4.0)


def critical_map_figure(speeds: CriticalMap) -> Figure:
    """Critical speeds of forward and backward whirls over the stiffness of a bearing, both logarithmic; red, what the
    films have at each speed: where the curves cross, the rotor has a critical speed, less what damping moves it."""
    case = speeds.case
    with styled():
        figure = new_figure(case.heading, "undamped critical speeds over the stiffness of each bearing")
        axes = figure.subplots()
        draw_critical_map(axes, speeds)
        legend_below(figure, axes)
    return figure


def draw_critical_map(axes: Axes, speeds: CriticalMap) -> None:
    """The map on axes of a figure: critical speeds in Hz over the stiffness in N/m."""
    for values, colour, dashes, name in _directions(speeds):
        for number, curve in enumerate(values.T):
            axes.plot(speeds.stiffness, curve, color=colour, linestyle=dashes, label=name if number == 0 else None)
    for number, springs in enumerate(speeds.film_stiffness.T if len(speeds.film_speeds_Hz) else ()):
        if np.isnan(springs).all():
            continue
        bearing = speeds.case.bearings[number].name
        label = ", ".join(word for word in ("stiffness of the films", bearing) if word)
        marker = FILM_MARKS[number % 3] if len(springs) < FEW else ""
        axes.plot(springs, speeds.film_speeds_Hz, color=VERMILION, linestyle=FILM_DASHES[number % 3], marker=marker,
                  markersize=5.0, label=label)  # fmt: skip
    top = speeds.case.speed.top
    axes.axhline(top, color=GREY, linewidth=0.8, linestyle=(0, (1, 2)), label="highest speed of the case")
    axes.set(xscale="log", yscale="log", xlim=(float(speeds.stiffness[0]), float(speeds.stiffness[-1])))
    lowest = float(np.nanmin([speeds.forward, speeds.backward]))
    highest = min(max(2.0 * top, float(np.nanmax([speeds.forward, speeds.backward]))), 20.0 * top)
    axes.set(ylim=(max(lowest, 0.02 * top), 1.2 * highest), xlabel="stiffness of a bearing in N/m")
    axes.set_ylabel("critical speed in Hz")
    _name_modes(axes, speeds)


def _directions(speeds: CriticalMap) -> tuple[tuple[Array, str, Any, str], ...]:
    """Critical speeds of each direction, with the look and the name of their curves."""
    return (speeds.forward, BLUE, "-", "forward whirl"), (speeds.backward, ORANGE, (0, (5, 2)), "backward whirl")


def _name_modes(axes: Axes, speeds: CriticalMap) -> None:
    """1F, 2F and so on next to the ends of the curves; a name that would cover the one below stands higher."""
    low, high = np.log(axes.get_ylim())
    height = LAID_OUT * POINTS_PER_INCH * axes.bbox.height / axes.figure.dpi
    for (values, colour, _, name), column in zip(_directions(speeds), NAME_COLUMNS, strict=True):
        below = -math.inf
        for number, end in enumerate(values[-1]):
            if not math.log(end) <= high:  # nor NaN, of a mode that is missing
                continue
            place = height * (math.log(end) - low) / (high - low)
            lift = max(0.0, below + NAME_HEIGHT - place)
            below = place + lift
            axes.annotate(f"{number + 1}{name[0].upper()}", (float(speeds.stiffness[-1]), end), (column, lift),
                          textcoords="offset points", color=colour, va="center", annotation_clip=False)  # fmt: skip
