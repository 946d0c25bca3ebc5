"""Spectra in pictures: orders, tracks of runs.

Amplitudes by order over rotor speed or time.

A run in a diagram over the speed: the largest eccentricity of each film in each short span of time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from frbcli.analysis.orders.order_tracking import OrderTrack
from frbcli.analysis.signals import joined, located
from frbcli.analysis.spectrum import Direction
from frbcli.arrays import Array
from frbcli.plot.curves import Over
from frbcli.plot.signals import MICRO, heading
from frbcli.plot.style import legend_below, new_figure, styled
from frbcli.results.records import pieces
from frbcli.results.store import Run


def orders_figure(
    run: Run, tracks: Sequence[OrderTrack], over: Over = "speed", direction: Direction = "x", log: bool = False
) -> Figure:
    """The peak amplitude of each order of a point, a curve each; a run that goes up and down is drawn to and fro.

    tracks: of the same point, by `frbcli.analysis.orders.order_tracking.order_tracks`; log: logarithmic amplitude.
    """
    title, subtitle = heading([run])
    point = joined(*located(run, tracks[0].signal)).replace("_", " ")
    moves = f"forward motion of the {point}" if direction == "forward" else f"{direction} of the {point}"
    what = f"{moves} by order, windows of {tracks[0].revolutions} revolutions"
    with styled():
        figure = new_figure(title, f"{subtitle}\n{what}" if subtitle else what)
        axes = figure.subplots()
        for track in tracks:
            across = track.time_s if over == "time" else track.speed_Hz
            axes.plot(across, MICRO * track.amplitude(direction), label=named(track.order))
        axes.set_xlabel("time in s" if over == "time" else "rotor speed in Hz")
        axes.set_ylabel("amplitude in µm")
        axes.margins(x=0.0)
        if log:
            axes.set_yscale("log")
        else:
            axes.set_ylim(bottom=0.0)
        legend_below(figure, axes)
    return figure


def named(order: float) -> str:
    """Label of an order, such as 0.5X."""
    return f"{order:g}X"


SPANS = 200  # of a run: longer than the periods of its whirl
ECCENTRICITY, SPEED, TIME = "eccentricity", "speed_Hz", "time_s"
HELD = 0.01  # share of the fastest change of the speed, below which it stays


@dataclass(frozen=True)
class RunTrack:
    """run: its name; label: its direction and its ramp; rising: whether the speed rises; speed_Hz:
    (n,); largest: (n,) eccentricity of each film by its name."""

    run: str
    label: str
    rising: bool
    speed_Hz: Array
    largest: Mapping[str, Array]


def run_tracks(run: Run, name: str) -> tuple[RunTrack, ...]:
    """The way up of a run, and the way down if the speed falls after its largest."""
    signals = [signal for signal in run.signals if signal == ECCENTRICITY or signal.startswith(f"{ECCENTRICITY}_")]
    span = max(1, len(run) // SPANS)
    speeds: list[float] = []
    times: list[float] = []
    largest: dict[str, list[float]] = {signal: [] for signal in signals}
    for start, stop in pieces(0, len(run)):
        speed = run.read(SPEED, start, stop)
        firsts = np.arange(0, stop - start, span)
        speeds += speed[firsts].tolist()
        times += run.read(TIME, start, stop)[firsts].tolist()
        for signal in signals:
            largest[signal] += np.maximum.reduceat(run.read(signal, start, stop), firsts).tolist()
    over = np.array(speeds)
    top = int(np.argmax(over))
    tracks = []
    for rising, part in ((True, slice(0, top + 1)), (False, slice(top, None))):
        if len(over[part]) > 2 and np.ptp(over[part]) > 0.0:
            label = f"{'run-up' if rising else 'run-down'}, {_ramp(over[part], np.array(times)[part]):.4g} Hz/s"
            films = {signal[len(ECCENTRICITY) + 1 :]: np.array(values)[part] for signal, values in largest.items()}
            tracks.append(RunTrack(name, label, rising, over[part], films))
    return tuple(tracks)


def _ramp(speed_Hz: Array, time_s: Array) -> float:
    """The change of the speed in Hz/s, without the time at which it stays."""
    change = np.abs(np.gradient(speed_Hz, time_s))
    return float(np.median(change[change > HELD * change.max()]))
