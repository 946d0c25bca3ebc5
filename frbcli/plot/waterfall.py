"""The waterfall: spectra of a run over time or rotor speed, with lines of its harmonic loads and its events; and its
levels as a bare image and as numbers, for pages that draw the axes themselves."""

from __future__ import annotations

import io
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib import image
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Annotation
from matplotlib.ticker import LogLocator, MaxNLocator, ScalarFormatter
from numpy.typing import NDArray

from frbcli.analysis.signals import joined, located, points, ring_speed_of, samples
from frbcli.analysis.spectrum import FROM_SPEED, PADDING, Direction, Spectrogram, window_length
from frbcli.analysis.spectrum import waterfall as spectra
from frbcli.analysis.subsynchronous import with_whirl_names
from frbcli.arrays import Array
from frbcli.case.reading.load import load_case_text
from frbcli.case.run import speed_unit_of
from frbcli.errors import InputError
from frbcli.plot.curves import WORDS, Over, draw_cascade
from frbcli.plot.signals import (
    MICRO,
    at_times,
    bearing_of,
    case_tables,
    clearance,
    ends,
    extremes,
    heading,
    is_length,
    motion,
)
from frbcli.plot.style import (
    BLACK,
    LEGEND_ROW,
    LEVEL_MAP,
    new_figure,
    plain,
    styled,
    with_subscripts,
)
from frbcli.results.columns import event_name
from frbcli.results.container import refuse
from frbcli.results.records import SPEED, TIME
from frbcli.results.store import Run
from frbcli.scene.machine.rotor import harmonics_of
from frbcli.units import SpeedUnit

FEWEST_BOTH = 3  # spectra of a picture with an axis of the time and one of the speed

LEVELS_dB = (-60.0, 0.0)  # a thousandth of the clearance, and the clearance
ABOVE_SYNCHRONOUS = 1.2  # how far the frequency axis goes, relative to the highest rotor speed
LOWEST_LOG_Hz = 10.0
FEWEST_LINES = 8  # lines of an unpadded spectrum that the frequency axis shows of a rotor that hardly turns
MOST_IN_WINDOW = 2**18  # samples
MOST_VALUES = 3e6  # of a map of levels
TURNING = 1e-3  # share of the highest speed per window that is a change of speed
FEWEST_COLUMNS, COLUMNS = 50, 2000  # spectra: the latter are more than a picture has columns of pixels
SAME_LINE = 0.1  # share of the rotor speed below which two lines need not be parted
UNKNOWN_m = 1.0  # clearance of a measurement without one, whose amplitudes are drawn in µm
TOLD_dB = 0.1  # 1 %: a smaller loss of the synchronous line is not stated

MOST_NUMBERED = 10  # events, the first ones
MARK_pt, LETTERS_pt = 13.0, 6.5  # diameter of the mark of an event, height of its number
PANEL_pt = (400.0, 220.0)  # size of a panel, about
LISTED = 2  # columns of the list of events
ONE_WAY = 0.8  # share of the spectra of a run that only rises or only falls, which is drawn over its speed

IMAGE = 720, 900  # rows and columns of the bare image, at most
LOWEST_dB, STEP_dB = -120.0, 0.5  # of a level as one byte


@dataclass(frozen=True)
class LevelScale:
    """The scale of the colours of a waterfall, or of the heights of its cascade.

    linear: amplitudes in µm instead of levels in dB; limits: in that unit, None for LEVELS_dB or up to the largest;
    orders: of the lines that are drawn in, None for the orders of free whirls.
    """

    linear: bool = False
    limits: tuple[float, float] | None = None
    orders: tuple[float, ...] | None = None

    def of(self, found: Spectrogram) -> tuple[Array, tuple[float, float], str]:
        """Values (k, m), their limits and unit."""
        if not self.linear:
            return found.level_dB, self.limits or LEVELS_dB, "dB"
        values = MICRO * found.amplitude
        return values, self.limits or (0.0, float(np.max(values)) or 1.0), "µm"


DECIBELS = LevelScale()


def waterfall_figure(
    run: Run,
    over: Over | None = None,
    signal: str = "journal",
    cascade: bool = False,
    window_s: float | None = None,
    direction: Direction = "x",
    log: bool = False,
    found: Spectrogram | None = None,
    scale: LevelScale = DECIBELS,
    unit: SpeedUnit | None = None,
) -> Figure:
    """Levels in dB relative to the clearance, of a floating ring to C_i + C_o, with the rotor speed and the frequencies
    of free whirls drawn in, half of it, or (omega_R + omega_F)/2 and omega_F/2, and the recorded events by number.

    over: the axis, None for `natural_axis`; over "speed" a run that goes up and down is drawn in two parts.
    signal: "journal", "disk" or "journal_NAME" of a bearing, "disk_NAME" of a wheel; cascade: one curve per spectrum,
    behind each other; window_s (None: as the ramp asks for) and direction as `waterfall` of
    analysis/spectrum.py; log: logarithmic frequency; found: the spectra of `run_spectra`, where they are known;
    scale: what the colours or heights are; unit: of the speeds of the events, None for the unit of the case.

    Raises InputError if the run does not have the signal, is shorter than a window, or lacks the clearance of levels.
    """
    if not scale.linear:
        clearance(run, bearing_of(run, signal))  # raises without one
    found = found or run_spectra(run, signal, window_s, direction)
    over = over or natural_axis(found)
    parts = _parts(run, found) if over == "speed" else [("", found)]
    point = joined(*located(run, signal)).replace("_", " ")
    what = f"{'forward motion' if direction == 'forward' else direction} of the {point}"
    title, subtitle = heading([run])
    subtitle = ", ".join(word for word in (subtitle, what, reading(found)) if word)
    with styled():
        figure = new_figure(title, subtitle, height=4.4 + 0.6 * len(parts))
        panels = figure.subplots(1, len(parts), squeeze=False, sharey=not cascade)[0]
        for axes, (name, part) in zip(panels, parts, strict=True):
            axes.set_title(name)
            if cascade:
                values, limits, measure = scale.of(part)
                draw_cascade(axes, part, over, values, limits, measure, orders(run, signal, part, scale.orders))
            else:
                mesh = draw_levels(axes, run, signal, part, over, log, scale)
                number_events(axes, run, part, over)
                _draw_other_axis(axes, part, over)
        if not cascade:  # its curves have no room for the numbers of events
            _list_events(figure, run, unit or speed_unit_of(run))
            bar = figure.colorbar(mesh, ax=list(panels), pad=0.02, extend="both")
            bar.set_label("amplitude in µm" if scale.linear else level_label(run, signal))
            bar.outline.set_visible(False)
    return figure


def natural_axis(found: Spectrogram) -> Over:
    """The axis of a waterfall that nobody chose: the rotor speed where it rises or falls nearly all the time."""
    change = np.diff(np.abs(found.speed_Hz))
    least = TURNING * float(np.max(np.abs(found.speed_Hz)))
    way = max(np.count_nonzero(change > least), np.count_nonzero(change < -least))
    return "speed" if len(change) and way >= ONE_WAY * len(change) else "time"


def number_events(axes: Axes, run: Run, part: Spectrogram, over: Over) -> None:
    """Mark the first events of a run within a part of its spectra by their numbers, each at its frequency; marks that
    would meet stand above each other."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    begin, end = sorted((float(part.time_s[0]), float(part.time_s[-1])))
    size_pt = np.array([PANEL_pt[0] / (right - left), PANEL_pt[1] / (top - bottom)])
    placed: list[Array] = []
    for number, event in enumerate(run.events[:MOST_NUMBERED], start=1):
        if not begin <= event["t_s"] <= end:
            continue
        frequency = event.get("frequency_Hz") or abs(event["speed_Hz"])
        here = event["t_s"] if over == "time" else event["speed_Hz"], min(max(frequency, bottom), top)
        at = size_pt * here
        while any(np.hypot(*(at - other)) < MARK_pt for other in placed):
            at = at + np.array([0.0, MARK_pt])
        placed.append(at)
        raised = float(at[1] - size_pt[1] * here[1])
        axes.annotate(
            str(number), here, (0.0, raised), textcoords="offset points", ha="center", va="center", fontsize=LETTERS_pt,
            bbox={"boxstyle": "circle,pad=0.25", "facecolor": "white", "edgecolor": BLACK, "linewidth": 0.6},
            arrowprops={"arrowstyle": "-", "color": "white", "linewidth": 0.6} if raised else None,
        )  # fmt: skip


def _list_events(figure: Figure, run: Run, unit: SpeedUnit) -> None:
    """The numbered events in words, below the picture."""
    lines = [
        f"{number}  {event_name(event)}, {unit.words(event['speed_Hz'], 1)}"
        for number, event in enumerate(with_whirl_names(run.events[:MOST_NUMBERED]), start=1)
    ]
    if len(run.events) > MOST_NUMBERED:
        lines.append(f"and {len(run.events) - MOST_NUMBERED} more")
    if lines:
        figure.legend([Line2D([], [])] * len(lines), [with_subscripts(plain(line)) for line in lines],
                      loc="outside lower left", ncols=LISTED, fontsize="small", handlelength=0.0,
                      handletextpad=0.0)  # fmt: skip
        rows = -(-len(lines) // LISTED)
        figure.set_figheight(figure.get_figheight() + LEGEND_ROW * max(0, rows - 1))


def _draw_other_axis(axes: Axes, part: Spectrogram, over: Over) -> None:
    """Above the picture the time of a speed, or the speed at a time, where one follows from the other."""
    time, speed = part.time_s, part.speed_Hz
    if len(time) < FEWEST_BOTH or not (np.all(np.diff(speed) > 0.0) or np.all(np.diff(speed) < 0.0)):
        return
    if not (np.all(np.diff(time) > 0.0) or np.all(np.diff(time) < 0.0)):
        return
    here, there = (time, speed) if over == "time" else (speed, time)
    name = WORDS["speed" if over == "time" else "time"]
    axes.secondary_xaxis("top", functions=(_along(here, there), _along(there, here))).set_xlabel(name)


def _along(places: Array, values: Array) -> Callable[[Any], Any]:
    """Values (n,) at places (n,) that rise or fall, on beyond the ends as straight lines."""
    x, y = (places, values) if places[0] < places[-1] else (places[::-1], values[::-1])
    first, last = (y[1] - y[0]) / (x[1] - x[0]), (y[-1] - y[-2]) / (x[-1] - x[-2])

    def at(wanted: Any) -> Any:
        wanted = np.asarray(wanted, dtype=np.float64)
        inside = np.interp(wanted, x, y)
        return inside + first * np.minimum(wanted - x[0], 0.0) + last * np.maximum(wanted - x[-1], 0.0)

    return at


def run_spectra(run: Run, signal: str, window_s: float | None, direction: Direction) -> Spectrogram:
    """The spectra of a run up to the frequency that its pictures show. window_s: length of a window in s, None: by the
    speed. Raises RunFileError for a window with too many samples."""
    time_s, x, y, speed = run.signal(TIME), *motion(run, signal), run.signal(SPEED)
    begin, end = ends(run)
    if window_s is None:
        window_s = window_length(time_s, speed, _apart(run, signal))
    step = (end - begin) / (len(run) - 1)
    if window_s > MOST_IN_WINDOW * step:
        raise refuse(run.path, f"has more than {MOST_IN_WINDOW} samples in a window.", "Shorten --window.")
    fastest = max(map(abs, extremes(speed, 0, len(run))))
    loads = (float(line.along(np.array(fastest))) for line in load_lines(run))
    length_s = max(window_s, step)  # shorter ones are refused below
    highest = max(ABOVE_SYNCHRONOUS * max([fastest, *loads]), FEWEST_LINES / length_s)
    most = max(FEWEST_COLUMNS, min(COLUMNS, int(MOST_VALUES / (PADDING * highest * length_s))))
    length = clearance(run, bearing_of(run, signal)) if any(map(is_length, run.references)) else UNKNOWN_m
    return spectra(time_s, x, y, speed, length, window_s, max_frequency_Hz=highest, direction=direction, most=most)


def reading(found: Spectrogram) -> str:
    """Window of the spectra, and the largest loss of the synchronous line."""
    low = float(np.max(found.low_dB, initial=0.0))
    low_by = f": the line 1X is up to {low:.1f} dB low, use --order 1" if low >= TOLD_dB else ""
    return f"window {1e3 * found.window_s:.3g} ms{low_by}"


def _apart(run: Run, signal: str) -> float | None:
    """How far in Hz the lines are from each other that a picture has to part; None where no ring turns."""
    bearing = bearing_of(run, signal)
    if bearing not in points(run.signals, "ring"):
        return None
    places = np.unique(np.linspace(0, len(run) - 1, COLUMNS).round().astype(np.int64))
    speed, ring = samples(run.signal(SPEED), places), samples(ring_speed_of(run, bearing), places)
    size = np.abs(speed)  # a rotor may turn the other way round all the time
    slow = np.flatnonzero(size >= FROM_SPEED * np.max(size))[0]
    frequencies = speed[slow], 0.5 * (speed[slow] + ring[slow]), 0.5 * ring[slow]
    lines = sorted(abs(float(frequency)) for frequency in frequencies)
    gaps = [above - below for below, above in itertools.pairwise(lines)]
    return min((gap for gap in gaps if gap > SAME_LINE * lines[-1]), default=None)


def level_label(run: Run, signal: str) -> str:
    """The label of the levels of a signal, with the length that they are relative to."""
    if "length_m" in run.references:
        return f"amplitude relative to {1e6 * clearance(run):.3g} µm in dB"
    ringed = bearing_of(run, signal) in points(run.signals, "ring")
    return f"amplitude relative to {'C$_i$ + C$_o$' if ringed else 'the clearance'} in dB"


def draw_levels(
    axes: Axes, run: Run, signal: str, found: Spectrogram, over: Over, log: bool = False, scale: LevelScale = DECIBELS
) -> QuadMesh:
    """The map of levels with its lines, on axes of a figure."""
    across = found.time_s if over == "time" else found.speed_Hz
    values, limits, _ = scale.of(found)
    mesh = axes.pcolormesh(
        across,
        found.frequency_Hz,
        values,
        cmap=LEVEL_MAP,
        vmin=limits[0],
        vmax=limits[1],
        shading="nearest" if len(across) > 1 else "auto",
        rasterized=True,
    )
    bottom = LOWEST_LOG_Hz if log else 0.0
    axes.set_ylim(bottom, float(found.frequency_Hz[-1]))
    if log:
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(ScalarFormatter())
    named: list[Annotation | None] = []
    for label, frequency in orders(run, signal, found, scale.orders):
        axes.plot(across, frequency, color="white", linewidth=0.8, linestyle=(0, (2, 3)))
        named.append(_label_line(axes, across, frequency, label, (bottom, float(found.frequency_Hz[-1]))))
    texts = [text for text in named if text is not None]
    boxes = [text.get_window_extent() for text in texts]
    for number, text in enumerate(texts):  # of lines that are close the first one is named
        text.set_visible(not any(boxes[number].overlaps(box) for box in boxes[:number]))
    axes.grid(False)
    axes.set(xlabel=WORDS[over], ylabel="frequency in Hz")
    return mesh


def orders(run: Run, signal: str, found: Spectrogram, chosen: Sequence[float] | None = None) -> list[tuple[str, Array]]:
    """The lines of 1X and of harmonic loads, and the frequencies of free whirls; or lines of chosen orders."""
    if chosen is not None:
        return [(f"{order:g}X", order * found.speed_Hz) for order in chosen]
    lines = [("1X", found.speed_Hz), *((line.name, line.along(found.speed_Hz)) for line in load_lines(run))]
    bearing = bearing_of(run, signal)
    if bearing not in points(run.signals, "ring"):
        return [*lines, ("0.5X", found.speed_Hz / 2)]
    turning = joined("ring_speed", bearing, "Hz")
    ring = at_times(run, run.signal(turning), found.time_s) if turning in run else np.zeros(len(found.time_s))
    return [*lines, ("(ω$_R$+ω$_F$)/2", (found.speed_Hz + ring) / 2), ("ω$_F$/2", ring / 2)]


def _label_line(
    axes: Axes, across: Array, frequency: Array, label: str, limits: tuple[float, float]
) -> Annotation | None:
    """Write the name of a line next to it, on the left of where it is highest yet well inside the picture; of a level
    line on the right of where that begins, away from rising ones, and small, since such lines lie close."""
    span = abs(across[-1] - across[0])
    middle = np.abs(across - 0.5 * (across[0] + across[-1]))
    inside = (middle < 0.43 * span) & (frequency > limits[0]) & (frequency < limits[1])
    if not inside.any():
        return None
    place, level = int(np.argmax(np.where(inside, frequency, -np.inf))), np.ptp(frequency[inside]) == 0.0
    return axes.annotate(
        label,
        (across[place], frequency[place]),
        xytext=(-3, 1 if level else 4),
        textcoords="offset points",
        ha="left" if level else "right",
        va="bottom",
        color="white",
        fontsize=7.0 if level else 9.0,
    )


def _parts(run: Run, found: Spectrogram) -> list[tuple[str, Spectrogram]]:
    """The spectra while the speed rises and while it falls, each in the order of speed."""
    change = np.gradient(found.speed_Hz) if len(found.speed_Hz) > 1 else np.zeros(1)
    least = TURNING * float(np.max(found.speed_Hz))
    parts = []
    for name, chosen in (("run-up", change > least), ("run-down", change < -least)):
        if np.count_nonzero(chosen) > 1:
            order = np.flatnonzero(chosen)[np.argsort(found.speed_Hz[chosen])]
            part = replace(
                found,
                time_s=found.time_s[order],
                speed_Hz=found.speed_Hz[order],
                amplitude=found.amplitude[:, order],
                level_dB=found.level_dB[:, order],
                low_dB=found.low_dB[order],
            )
            parts.append((name, part))
    if not parts:
        raise refuse(run.path, "was made at constant speed.", "Draw its waterfall over time.")
    return [("", parts[0][1])] if len(parts) == 1 else parts


class LoadLine(NamedTuple):
    """Frequency of a load: order times the rotor speed, plus frequency_Hz."""

    name: str
    order: float
    frequency_Hz: float

    def along(self, speed_Hz: Array) -> Array:
        """(k,) Hz at rotor speeds (k,) in Hz."""
        return np.abs(self.order * speed_Hz + self.frequency_Hz)


def load_lines(run: Run) -> tuple[LoadLine, ...]:
    """One line for each frequency of the harmonic loads of the case of a run, without the rotor speed itself."""
    if not run.case_text or not {"force", "base"} & case_tables(run).keys():
        return ()
    try:
        loads = harmonics_of(load_case_text(run.case_text, name=run.case_name))
    except InputError:  # a case of another version: its spectra stand without the lines
        return ()
    found = {}
    for load in loads:
        order, frequency = abs(load.order), abs(load.frequency) / (2.0 * math.pi)
        if not load.synchronous:
            found[order, frequency] = LoadLine(f"{order:g}X" if order else f"{frequency:g} Hz", order, frequency)
    return tuple(found.values())


@dataclass(frozen=True)
class Levels:
    """Levels of a run: time_s, speed_Hz (m,); frequency_Hz (k,), ascending; level (k, m) bytes, dB over the clearance
    by LOWEST_dB and STEP_dB; image: PNG, a pixel each, frequencies upwards; lines: names, with _ before
    an index, and frequencies (m,) in Hz."""

    time_s: Array
    speed_Hz: Array
    frequency_Hz: Array
    level: NDArray[np.uint8]
    image: bytes
    lines: tuple[tuple[str, Array], ...]


def levels(run: Run, signal: str, found: Spectrogram) -> Levels:
    """The spectra of a run over time, in at most IMAGE numbers, each the largest of its own."""
    rows, columns = (_starts(count, most) for count, most in zip(found.level_dB.shape, IMAGE, strict=True))
    largest = np.maximum.reduceat(np.maximum.reduceat(found.level_dB, rows, axis=0), columns, axis=1)
    content = io.BytesIO()
    image.imsave(content, largest, vmin=LEVELS_dB[0], vmax=LEVELS_dB[1], cmap=LEVEL_MAP, origin="lower", format="png")
    lines = tuple((name.replace("$", ""), _means(values, columns)) for name, values in orders(run, signal, found))
    return Levels(
        time_s=_means(found.time_s, columns),
        speed_Hz=_means(found.speed_Hz, columns),
        frequency_Hz=_means(found.frequency_Hz, rows),
        level=np.clip((largest - LOWEST_dB) / STEP_dB, 0.0, 255.0).round().astype(np.uint8),
        image=content.getvalue(),
        lines=lines,
    )


def ticks(low: float, high: float, most: int = 8) -> tuple[float, ...]:
    """Round numbers from `low` to `high`."""
    found = MaxNLocator(most, steps=[1, 2, 5, 10]).tick_values(low, high)
    slack = 1e-9 * (high - low)
    return tuple(float(value) for value in found if low - slack <= value <= high + slack)


def scale_colours(count: int = 24) -> Sequence[str]:
    """Colours of the levels from the lowest to the highest, as CSS has them."""
    colours = mpl.colormaps[LEVEL_MAP](np.linspace(0.0, 1.0, count))
    return [f"#{''.join(f'{round(255 * part):02x}' for part in colour[:3])}" for colour in colours]


def _starts(count: int, most: int) -> NDArray[np.int64]:
    return np.arange(0, count, -(-count // most))


def _means(values: Array, starts: NDArray[np.int64]) -> Array:
    sizes = np.diff(np.append(starts, len(values)))
    return np.asarray(np.add.reduceat(values, starts) / sizes, dtype=np.float64)
