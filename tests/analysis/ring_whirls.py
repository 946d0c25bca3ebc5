"""Runs of a floating ring with given whirls."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit
from synthetic_run import as_run

from frbcli.results.store import Run

# --------------------------------------------------------------------------------------------------- floating rings
ROOM = 90e-6


@dataclass(frozen=True)
class RingWhirl:
    """A whirl with the frequency of its film until it locks into lock_Hz, from begin_s to end_s."""

    side: str
    begin_s: float
    end_s: float
    lock_Hz: float
    amplitude: float = 0.3


def ring_run(*whirls: RingWhirl, name: str = "", noise: float = 0.0) -> Run:
    """A run-up to 900 Hz in 3 s on a floating ring that turns with a quarter of the rotor's speed."""
    time_s = np.arange(0.0, 3.0, 5e-5)
    speed = 300.0 * time_s
    ring = 0.25 * speed
    motion = 0.2 * np.exp(-3.0 * time_s) + 0.01 * np.exp(1j * np.pi * speed * time_s)
    for whirl in whirls:
        free = 0.5 * (ring if whirl.side == "outer" else speed + ring)
        turned = 2j * np.pi * np.cumsum(np.minimum(free, whirl.lock_Hz)) * 5e-5
        there = expit(100.0 * (time_s - whirl.begin_s)) * expit(100.0 * (whirl.end_s - time_s))
        motion = motion + whirl.amplitude * there * np.exp(turned)
    if noise:
        motion = motion + noise * np.random.default_rng(0).normal(size=(2, len(time_s))).T.copy().view(complex)[:, 0]
    end = f"_{name}" if name else ""
    columns = {"time_s": time_s, "speed_Hz": speed, f"ring_speed{end}_Hz": ring}
    for kind, share in (("journal", 1.0), ("ring", 0.6)):
        columns |= {f"{kind}{end}_x_m": share * ROOM * motion.real, f"{kind}{end}_y_m": share * ROOM * motion.imag}
    clearances = {f"clearance_m{end}_inner": 40e-6, f"clearance_m{end}_outer": 50e-6}
    return replace(as_run(columns), references=clearances)
