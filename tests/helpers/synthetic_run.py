"""Runs made up from formulas, so that their events are known: a Jeffcott rotor as a run-up shows it."""

import io
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.special import expit

from frbcli.results.store import Run, Signal

CLEARANCE = 35e-6
UNITS = {"time_s": "s", "speed_Hz": "Hz", "eccentricity": ""}


@dataclass(frozen=True)
class Rotor:
    """What happens in the run-up to 300 Hz in duration_s."""

    duration_s: float = 10.0
    step_s: float = 5e-5
    critical_Hz: float | None = 145.0
    damping: float = 0.05  # ratio, of that resonance
    unbalance_m: float = 0.5e-6  # eccentricity of the mass
    whirl_s: float | None = 6.5  # when the whirl reaches half its final amplitude
    growth_1_s: float = 60.0
    whirl_amplitude: float = 0.8
    whirl_ratio: float = 0.47
    lock_Hz: float = 125.0
    noise: float = 0.0
    speeds_Hz: tuple[float, ...] = field(default=(0.0, 300.0))  # evenly spaced corners of the speed


def signals(rotor: Rotor) -> dict[str, np.ndarray]:
    """The signals of a run under the names a run file gives them."""
    time = np.arange(round(rotor.duration_s / rotor.step_s) + 1) * rotor.step_s
    speed = np.interp(time, np.linspace(0.0, rotor.duration_s, len(rotor.speeds_Hz)), rotor.speeds_Hz)
    turn = 2 * np.pi * np.cumsum(speed) * rotor.step_s
    load = 1.0 / (0.05 + speed / 60.0)  # a falling Sommerfeld number: the journal rises to the centre
    static = 0.75 * load / (1.0 + load) * np.exp(1j * (-np.pi / 2 + np.arctan(speed / 40.0)))
    journal = static * (1.0 - np.exp(-time / 0.02)) * CLEARANCE
    disk = journal - 12e-6j
    if rotor.critical_Hz is not None:
        r = speed / rotor.critical_Hz
        resonance = rotor.unbalance_m * r**2 / (1 - r**2 + 2j * rotor.damping * r) * np.exp(1j * turn)
        disk, journal = disk + resonance, journal + 0.15 * resonance
    if rotor.whirl_s is not None:
        grown = expit(rotor.growth_1_s * (time - rotor.whirl_s))
        frequency = ((rotor.whirl_ratio * np.maximum(speed, 1.0)) ** -8 + rotor.lock_Hz**-8) ** (-1 / 8)
        whirl = rotor.whirl_amplitude * grown * np.exp(2j * np.pi * np.cumsum(frequency) * rotor.step_s) * CLEARANCE
        journal = journal * (1 - 0.7 * grown) + whirl
        disk = disk + 1.6 * whirl * np.exp(-0.4j)
    if rotor.noise:
        chance = np.random.default_rng(0)
        hiss = chance.normal(size=(4, len(time))) * rotor.noise * CLEARANCE
        journal, disk = journal + hiss[0] + 1j * hiss[1], disk + hiss[2] + 1j * hiss[3]
    return {
        "time_s": time,
        "speed_Hz": speed,
        "eccentricity": np.abs(journal) / CLEARANCE,
        "journal_x_m": journal.real,
        "journal_y_m": journal.imag,
        "disk_x_m": disk.real,
        "disk_y_m": disk.imag,
    }


def make_run(rotor: Rotor | None = None, status: str = "finished", title: str = "Jeffcott rotor") -> Run:
    return as_run(signals(rotor or Rotor()), status, title)


def as_run(columns: dict[str, np.ndarray], status: str = "finished", title: str = "Jeffcott rotor") -> Run:
    return Run(
        path=Path("run.h5"),
        title=title,
        command="runup",
        case_name="synthetic",
        case_text="",
        versions={},
        signals={name: Signal(values, UNITS.get(name, "m")) for name, values in columns.items()},
        status=status,
        t_end_s=float(columns["time_s"][-1]) if len(columns["time_s"]) else 0.0,
        events=[],
        cost={},
        error={},
        references={"clearance_m": CLEARANCE},
        checkpoint=None,
    )


@cache
def parser_error() -> float:
    """The largest relative error of pandas in 10 000 numbers of all sizes: none since version 3, before some 1e-13."""
    random = np.random.default_rng(0)
    values = random.normal(size=10_000) * 10.0 ** random.integers(-12, 4, 10_000)
    text = "\n".join(["a", *map(repr, values.tolist())])
    return float(np.abs(pd.read_csv(io.StringIO(text))["a"].to_numpy() / values - 1.0).max())
