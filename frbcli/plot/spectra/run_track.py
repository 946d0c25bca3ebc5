"""A run in a diagram over the speed: the largest eccentricity of each film in each short span of time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.results.signals import pieces
from frbcli.results.store import Run

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
