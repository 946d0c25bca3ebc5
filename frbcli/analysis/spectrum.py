"""Spectra over time: which frequencies a journal or a disk moves with, and how far."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len
from scipy.signal import ShortTimeFFT
from scipy.signal.windows import hann

from frbcli.errors import Fault, InputError

Values = NDArray[np.float64]
Direction = Literal["x", "y", "forward"]
DIRECTIONS: tuple[Direction, ...] = ("x", "y", "forward")

PADDING = 4  # a sinusoid between two lines of the padded spectrum loses less than 1 % of its height under a Hann window
FLOOR_dB = -200.0  # what silence is shown as
UNEVEN = 1e-3  # relative deviation of a sample's time that is more than round-off


@dataclass(frozen=True)
class Spectrogram:
    """Spectra over time.

    time_s (m,): middle of each window; speed_Hz (m,): rotor speed there; frequency_Hz (k,); amplitude (k, m): peak
    amplitude in m; level_dB (k, m): the same relative to the clearance.
    """

    time_s: Values
    speed_Hz: Values
    frequency_Hz: Values
    amplitude: Values
    level_dB: Values


def waterfall(
    time_s: Values,
    x: Values,
    y: Values,
    speed_Hz: Values,
    clearance: float,
    window_s: float = 0.2,
    overlap: float = 0.9,
    max_frequency_Hz: float | None = None,
    direction: Direction = "x",
) -> Spectrogram:
    """Short-time spectra of a motion x, y (n,) in m, sampled evenly at time_s (n,), with rotor speed speed_Hz (n,).

    A steady sinusoid of amplitude A shows as A. direction: "x" and "y" give the one-sided spectrum of one coordinate,
    "forward" the part of x + iy that turns with the rotor. window_s: length of the Hann windows, whose mean is taken
    off; overlap: the share of a window that the next one sees again; clearance: the length in m that is 0 dB.

    Raises InputError if the window or the overlap does not fit the samples, or these are not evenly spaced.
    """
    if direction not in DIRECTIONS:
        raise _fault("direction", direction, "is unknown.", f"Use one of {', '.join(DIRECTIONS)}.")
    if not 0.0 <= overlap < 1.0:
        raise _fault("overlap", overlap, "is not a share of the window.", "Use 0 to 0.99.")
    step = _step(time_s)
    length = round(window_s / step) if np.isfinite(window_s) else 0
    if not 8 <= length <= len(time_s):
        duration = step * len(time_s)
        raise _fault(
            "window", f"{window_s:g} s", "does not fit the run.", f"Use more than {8 * step:g} s, up to {duration:g} s."
        )
    forward = direction == "forward"
    transform = ShortTimeFFT(
        hann(length, sym=False),
        hop=max(1, round(length * (1.0 - overlap))),
        fs=1.0 / step,
        fft_mode="centered" if forward else "onesided2X",
        mfft=next_fast_len(PADDING * length),
        scale_to="magnitude",
    )
    # only windows that lie wholly inside the run: the others would show its ends as motion
    first, last = transform.lower_border_end[1], transform.upper_border_begin(len(time_s))[1]
    motion = x + 1j * y if forward else {"x": x, "y": y}[direction]
    lines = transform.stft_detrend(motion, "constant", p0=first, p1=max(last, first + 1))
    frequency = transform.f
    shown = (frequency >= 0.0) & (frequency <= (np.inf if max_frequency_Hz is None else max_frequency_Hz))
    amplitude = np.abs(lines[shown])
    time = time_s[0] + transform.t(len(time_s), first, max(last, first + 1))
    level = 20.0 * np.log10(np.maximum(amplitude / clearance, 10.0 ** (FLOOR_dB / 20.0)))
    return Spectrogram(time, np.interp(time, time_s, speed_Hz), frequency[shown], amplitude, level)


def _step(time_s: Values) -> float:
    """The time between two samples in s; raises InputError if there is no such thing."""
    if len(time_s) < 2:
        raise _fault("time_s", "", "has fewer than two samples.", "Let the run go on.")
    step = float(time_s[-1] - time_s[0]) / (len(time_s) - 1)
    even = time_s[0] + step * np.arange(len(time_s))
    if not step > 0.0 or np.max(np.abs(time_s - even)) > UNEVEN * step:
        raise _fault("time_s", "", "is not evenly spaced.", "Use the run as frb wrote it.")
    return step


def _fault(key: str, value: object, problem: str, remedy: str) -> InputError:
    return InputError("spectrum", (Fault(key=key, value=str(value), line=None, problem=problem, remedy=remedy),))
