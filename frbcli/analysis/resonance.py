"""The critical speed of a run: where the unbalance excites a resonance."""

from __future__ import annotations

import numpy as np
from scipy.signal import find_peaks, peak_widths

from frbcli.analysis.revolutions import SAMPLES_PER_REVOLUTION, Revolutions, by_angle, order_amplitude, order_motion
from frbcli.analysis.signals import Motion, RunLike, Values, points

REVOLUTIONS = 8  # of the window: a resonance is passed in many more
WHIRL = 0.5  # order of oil whirl
WITHOUT_MOTION = 1.5  # neither whirl nor unbalance nor its harmonics: what is seen there is the background
PROMINENCE = 0.25  # share of its height by which a peak stands out of the higher of its two sides
OVER_BACKGROUND = 5.0
FLOOR = 1e-4  # amplitude relative to the clearance; less is round-off of a rotor without unbalance
HALF_WAY_UP = 0.5  # of the prominence: how far up a peak its two flanks are taken
# By how much the motion falls behind the unbalance from one flank to the other. It is 60 to 130 degrees for critical
# speeds of rotors in oil films, and next to nothing where a film alone changes, because oil goes or comes.
LAG = np.radians(30.0)


def critical_sample(run: RunLike, turns: Revolutions, bearings: list[str], before_s: float) -> int | None:
    """The step of `turns` with the clearest resonance, of the disks or else the journals, before the time of the first
    whirl; None if there is none."""
    nodes = [("disk", name) for name in points(run.signals, "disk")] or [("journal", name) for name in bearings]
    middle = REVOLUTIONS * SAMPLES_PER_REVOLUTION // 2
    settled = turns.settled + middle
    until = int(np.searchsorted(turns.time_s, before_s)) - middle
    clearances = [length for name, length in run.references.items() if name.startswith("clearance_m")]
    floor = FLOOR * min(clearances, default=0.0)
    best: tuple[float, int] | None = None
    for kind, name in nodes:
        motion = by_angle(run, kind, name, turns)[settled - middle : until + middle]
        if len(motion) <= 2 * middle:
            continue
        for peak, prominence in _resonances(motion, floor):
            if best is None or prominence > best[0]:
                best = prominence, settled + peak
    return None if best is None else best[1]


def _resonances(motion: Motion, floor: float) -> list[tuple[int, float]]:
    """Sample and prominence of each resonance of the motion (n,) with the unbalance."""
    synchronous = order_motion(motion, 1.0, REVOLUTIONS)
    amplitude: Values = np.abs(synchronous)
    background = float(np.median(order_amplitude(motion, WITHOUT_MOTION, REVOLUTIONS)))
    peaks, found = find_peaks(amplitude, prominence=max(floor, OVER_BACKGROUND * background))
    if len(peaks) == 0:
        return []
    _, _, before, after = peak_widths(amplitude, peaks, HALF_WAY_UP)
    phase = np.unwrap(np.angle(synchronous))
    lag = np.abs(phase[after.astype(int)] - phase[before.astype(int)])
    # Whirl that is about to break out spills over into all orders.
    whirling = order_amplitude(motion, WHIRL, REVOLUTIONS)[peaks] > amplitude[peaks]
    clear = (found["prominences"] >= PROMINENCE * amplitude[peaks]) & ~whirling & (lag >= LAG)
    return list(zip(peaks[clear].tolist(), found["prominences"][clear].tolist(), strict=True))
