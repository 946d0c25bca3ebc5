"""Orbits and spectra of a run at chosen moments, side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray
from scipy.signal import resample_poly

from frbcli.analysis.signals import located, speed_at
from frbcli.analysis.spectrum import Spectrogram
from frbcli.plot.signals import MICRO, bearing_of, cut, ends, motion, shell
from frbcli.plot.style import BLUE, GREY, NotebookFigure, styled
from frbcli.plot.waterfall import orders
from frbcli.results.records import SPEED, Signal, pieces
from frbcli.results.store import Run

Values = NDArray[np.float64]

TURNS = 12.0  # revolutions of an orbit
LONGEST_s, SHORTEST_s = 0.2, 2e-3
WIDTH, ROW = 7.2, 2.5  # inches
FINE = 40.0  # points of a revolution: through fewer samples a curve would have corners
MARGIN = 12  # samples on either side that values between samples need
ENLARGED = 0.1  # of the clearance: a smaller orbit is drawn without it
AHEAD = 2.2  # of the rotor speed: up to where a spectrum is drawn
CLEAR = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.5}  # behind a name: lines of others
CLOSE, LINE_pt = 0.2, 10.0  # share of an axis within which names stand one below the other, so far apart


def speeds_figure(
    run: Run, times_s: Sequence[float], spectra: Spectrogram, signal: str = "journal",
    words: Callable[[float], str] = "{:.4g} Hz".format,
) -> Figure:  # fmt: skip
    """A row for each of some moments in s: the orbit of the last revolutions until then, and the spectrum of the
    window about it, from the spectra of `run_spectra`; words: of a speed in Hz.

    Raises RunFileError if the run has no samples there.
    """
    with styled():
        figure = NotebookFigure(figsize=(WIDTH, ROW * len(times_s)))
        rows = figure.subplots(len(times_s), 2, squeeze=False, width_ratios=(1.0, 2.0))
        for (left, right), time_s in zip(rows, times_s, strict=True):
            draw_orbit_until(left, run, time_s, signal)
            draw_spectrum_at(right, run, time_s, spectra, signal)
            left.set_title(f"{words(speed_at(run, time_s))}, {time_s:.4g} s")
    return figure


def draw_orbit_until(axes: Axes, run: Run, time_s: float, signal: str = "journal") -> None:
    """The orbit of the last revolutions before a time in s; with the clearance for a journal whose orbit is not too
    small to be seen in it."""
    speed = max(abs(speed_at(run, time_s)), 1e-9)
    begin, end = ends(run)
    until = min(max(time_s, begin + SHORTEST_s), end)
    span = min(max(TURNS / speed, SHORTEST_s), LONGEST_s)
    first, last = cut(run, max(begin, until - span), until)
    times = math.ceil(FINE * span * speed / (last - first))
    x, y = (MICRO * between(part, first, last, times) for part in motion(run, signal))
    axes.plot(x, y, color=BLUE, linewidth=0.8)
    middle, reach = np.zeros(2), float(np.max(np.hypot(x, y)))
    room = shell(run, bearing_of(run, signal)) if located(run, signal)[0] == "journal" else None
    if room is not None:
        radius = MICRO * room
        axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor=GREY, linewidth=1.0))
        reach = max(reach, radius)
    extent = 0.5 * max(float(np.ptp(x)), float(np.ptp(y)))
    if 0.0 < extent < ENLARGED * reach:
        middle, reach = np.array([np.min(x) + 0.5 * np.ptp(x), np.min(y) + 0.5 * np.ptp(y)]), 1.15 * extent
    axes.set_xlim(middle[0] - 1.08 * reach, middle[0] + 1.08 * reach)
    axes.set_ylim(middle[1] - 1.08 * reach, middle[1] + 1.08 * reach)
    axes.set_aspect("equal")
    axes.set_xlabel("x in µm")
    axes.set_ylabel("y in µm")


def between(part: Signal, first: int, last: int, times: int) -> Values:
    """The samples of a motion from `first` to before `last`, and `times` as many values between them, interpolated as
    band-limited to half of the sampling rate. At an end of the run, beyond which nothing is known, the last few samples
    are left out."""
    whole = part[max(first - MARGIN, 0) : min(last + MARGIN, len(part))]
    if times <= 1 or len(whole) <= 4 * MARGIN:
        return part[first:last]
    rest = MARGIN * times
    return np.asarray(resample_poly(whole, times, 1, padtype="line")[rest : (len(whole) - MARGIN - 1) * times + 1])


def draw_spectrum_at(axes: Axes, run: Run, time_s: float, spectra: Spectrogram, signal: str = "journal") -> None:
    """Peak amplitudes over frequency of the spectrum nearest to a time in s, with the frequencies of interest."""
    column = int(np.argmin(np.abs(spectra.time_s - time_s)))
    speed = abs(float(spectra.speed_Hz[column]))
    highest = min(float(spectra.frequency_Hz[-1]), max(AHEAD * speed, 8.0 / spectra.window_s))
    kept = spectra.frequency_Hz <= highest
    axes.plot(spectra.frequency_Hz[kept], MICRO * spectra.amplitude[kept, column], color=BLUE)
    if highest > 0.0:
        axes.set_xlim(0.0, highest)
    axes.set_ylim(bottom=0.0)
    lines = sorted((float(abs(frequencies[column])), name) for name, frequencies in orders(run, signal, spectra))
    last, lower = -np.inf, 0.0
    for at, name in lines:
        if 0.0 < at < highest:
            axes.axvline(at, color=GREY, linewidth=0.8, linestyle=(0, (2, 3)))
            lower = lower + LINE_pt if at - last < CLOSE * highest else 0.0
            axes.annotate(name, (at, 1.0), xycoords=axes.get_xaxis_transform(), xytext=(2, -2 - lower),
                          textcoords="offset points", va="top", fontsize=8.0, color=GREY, bbox=CLEAR)  # fmt: skip
            last = at
    axes.set_xlabel("frequency in Hz")
    axes.set_ylabel("amplitude in µm")


def times_of_speeds(run: Run, speeds_Hz: Sequence[float]) -> list[float]:
    """The first time in s at which the rotor turns as fast as each of some speeds; those it does not reach are left
    out."""
    times = []
    for wanted in speeds_Hz:
        before = 0.0
        for start, stop in pieces(0, len(run)):
            speed = np.abs(run.read(SPEED, start, stop))
            reached = np.flatnonzero((speed >= abs(wanted)) & (before <= abs(wanted)))
            if len(reached):
                times.append(float(run.read("time_s", start + int(reached[0]), start + int(reached[0]) + 1)[0]))
                break
            before = float(speed[-1])
    return times
