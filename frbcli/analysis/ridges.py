"""The ridges of a run-up: what its synchronous motion and its whirl are at chosen rotor speeds.

They are what a computed and a measured run are compared by: both have them, whatever their samples, and neither needs
a common zero of time, of phase or of place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.analysis.orders.order_tracking import order_track
from frbcli.analysis.peaks import summit
from frbcli.analysis.signals import joined, located
from frbcli.analysis.spectrum import Spectrogram, waterfall, window_length
from frbcli.arrays import Array, Truths
from frbcli.results.records import SPEED, TIME
from frbcli.results.store import Run

BAND = (0.25, 0.8)  # of the rotor speed, in which a whirl is looked for
SEEN = 0.05  # of the clearance: a smaller line in the band is no whirl
BEYOND = 1.3  # times the highest of its band: up to where spectra are computed
MOST_SPEEDS = 60
LOWEST = 0.1  # of the highest speed: below it a run-up is hardly in its order
LARGEST_OVERLAP = 0.8


@dataclass(frozen=True)
class Ridges:
    """Ridges of the way up.

    speed_Hz: (n,) ascending; synchronous: (n, 2) peak amplitudes of x and y with the rotor speed, m;
    whirl_Hz, whirl: (n,) frequency and amplitude in m of the largest line of x within BAND of the rotor speed, which is
    a whirl where `whirls` (n,); onset_Hz: rotor speed at the first onset of whirl, NaN if there is none. What lies
    outside of the run is NaN."""

    speed_Hz: Array
    synchronous: Array
    whirl_Hz: Array
    whirl: Array
    whirls: Truths
    onset_Hz: float


def ridge_speeds(run: Run) -> Array:
    """(n,) rotor speeds in Hz that suit a run: as far from each other as its windows reach, at most MOST_SPEEDS."""
    speed, time = np.abs(run[SPEED]), run[TIME]
    top = int(np.argmax(speed))
    window = window_length(run.signal(TIME), run.signal(SPEED))
    count = int(min(MOST_SPEEDS, max(4.0, (time[top] - time[0]) / window)))
    low, high = max(LOWEST * speed[top], float(speed[0])), float(speed[top])
    reach = 0.5 * window * (high - float(speed[0])) / max(float(time[top] - time[0]), 1e-12)
    assert located(run, "journal")
    return np.linspace(low + reach, high - 1.5 * reach, count)


def ridges(run: Run, speeds_Hz: Array, clearance: float, signal: str = "journal") -> Ridges:
    """The ridges of a run at rotor speeds (n,) in Hz; clearance in m. Raises InputError as order_track and waterfall
    do, of a run that is too short for them."""
    track = order_track(run, 1.0, signal)
    rising = _rising(track.speed_Hz)
    synchronous = np.stack(
        [_at(speeds_Hz, track.speed_Hz[rising], track.amplitude(axis)[rising]) for axis in ("x", "y")], axis=1
    )
    found = _spectra(run, signal, clearance)
    frequency, amplitude = _lines(found)
    rising = _rising(found.speed_Hz)
    whirl_Hz = _at(speeds_Hz, found.speed_Hz[rising], frequency[rising])
    whirl = _at(speeds_Hz, found.speed_Hz[rising], amplitude[rising])
    here = (None, joined(*located(run, signal)))  # events of earlier versions name no point
    onsets = (event["speed_Hz"] for event in run.events if event["kind"] == "onset" and event.get("point") in here)
    onset = next(onsets, np.nan)
    return Ridges(speeds_Hz, synchronous, whirl_Hz, whirl, whirl > SEEN * clearance, float(onset))


def _spectra(run: Run, signal: str, clearance: float) -> Spectrogram:
    point = joined(*located(run, signal))
    x, y = run.signal(f"{point}_x_m"), run.signal(f"{point}_y_m")
    top = float(np.max(np.abs(run[SPEED])))
    return waterfall(
        run.signal(TIME), x, y, run.signal(SPEED), clearance, overlap=LARGEST_OVERLAP,
        max_frequency_Hz=BEYOND * BAND[1] * top,
    )  # fmt: skip


def _rising(speed: Array) -> Truths:
    """(m,) where a speed has not been reached before: the way up."""
    before = np.concatenate([[-np.inf], np.maximum.accumulate(speed)[:-1]])
    return np.asarray(speed > before)


def _at(wanted: Array, speed: Array, values: Array) -> Array:
    return np.asarray(np.interp(wanted, speed, values, left=np.nan, right=np.nan))


def _lines(found: Spectrogram) -> tuple[Array, Array]:
    """(m,) frequency in Hz and amplitude of the largest line within the band of each spectrum, between the lines of the
    spectrum by a parabola through their logarithms."""
    step = float(found.frequency_Hz[1] - found.frequency_Hz[0])
    frequency, amplitude = np.full(len(found.time_s), np.nan), np.zeros(len(found.time_s))
    for column, speed in enumerate(np.abs(found.speed_Hz)):
        band = np.flatnonzero((found.frequency_Hz > BAND[0] * speed) & (found.frequency_Hz < BAND[1] * speed))
        band = band[(band > 0) & (band < len(found.frequency_Hz) - 1)]
        if not len(band):
            continue
        place = int(band[np.argmax(found.amplitude[band, column])])
        left, middle, right = np.log(np.maximum(found.amplitude[place - 1 : place + 2, column], 1e-300))
        off = summit(left, middle, right)
        frequency[column] = found.frequency_Hz[place] + off * step
        amplitude[column] = np.exp(middle - 0.25 * (left - right) * off)
    return frequency, amplitude
