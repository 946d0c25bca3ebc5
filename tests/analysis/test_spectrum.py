"""Spectra of motions whose amplitudes and frequencies are known."""

import subprocess
import sys
from functools import partial

import numpy as np
import pytest

from frbcli.analysis import signals, spectrum
from frbcli.analysis.spectrum import (
    WINDOW,
    Direction,
    FLOOR_dB,
    Spectrogram,
    chirp_height,
    fast_length,
    waterfall,
    window_length,
)
from frbcli.errors import InputError

CLEARANCE = 35e-6
TIME = np.arange(40_000) * 5e-5
SPEED = 150.0 * TIME


def spectra(x: np.ndarray, y: np.ndarray | None = None, **options: object) -> Spectrogram:
    options = {"window_s": 0.2} | options
    return waterfall(TIME, x, np.zeros_like(x) if y is None else y, SPEED, CLEARANCE, **options)  # type: ignore[arg-type]


def peak_near(found: Spectrogram, frequency_Hz: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequency and height (m,) of the highest line within 15 Hz."""
    near = np.abs(found.frequency_Hz - frequency_Hz) < 15.0
    highest = np.argmax(found.amplitude[near], axis=0)
    return found.frequency_Hz[near][highest], found.amplitude[near].max(axis=0)


@pytest.mark.parametrize("frequency", [60.0, 71.3, 146.9])
@pytest.mark.parametrize("window_s", [0.1, 0.2])
def test_a_tone_has_its_amplitude_at_its_frequency(frequency: float, window_s: float) -> None:
    found = spectra(3e-6 * np.cos(2 * np.pi * frequency * TIME + 0.4), window_s=window_s)
    where, height = peak_near(found, frequency)
    np.testing.assert_allclose(height, 3e-6, rtol=0.01)
    np.testing.assert_allclose(where, frequency, atol=0.5 / (4 * window_s) + 1e-9)


def test_beside_a_line_nothing_is_seen_above_60_dB_below_it() -> None:
    drift = 50e-6 + 30e-6 * TIME
    found = spectra(CLEARANCE * np.cos(2 * np.pi * 101.3 * TIME + 0.4) + drift)
    off = np.abs(found.frequency_Hz - 101.3) > 3.0 / 0.2  # the main lobe
    assert found.level_dB[off & (found.frequency_Hz > 15.0)].max() < -70.0  # Nuttall: -71.4 dB; Hann has -31 dB
    assert found.level_dB[found.frequency_Hz <= 15.0].max() < -63.0  # neither drift nor what a line takes of the whirl
    assert found.level_dB.max() == pytest.approx(0.0, abs=0.1)


def test_level_is_relative_to_the_clearance() -> None:
    found = spectra(CLEARANCE / 10.0 * np.cos(2 * np.pi * 80.0 * TIME))
    assert found.level_dB.max() == pytest.approx(-20.0, abs=0.1)
    assert spectra(np.zeros_like(TIME)).level_dB.max() == FLOOR_dB


def test_directions_are_told_apart() -> None:
    angle = 2 * np.pi * 90.0 * TIME
    x, y = 2e-6 * np.cos(angle), 1e-6 * np.sin(angle)  # 1.5 forward, 0.5 backward
    for direction, amplitude in [("x", 2e-6), ("y", 1e-6), ("forward", 1.5e-6)]:
        np.testing.assert_allclose(peak_near(spectra(x, y, direction=direction), 90.0)[1], amplitude, rtol=0.01)
    backward = spectra(y, x, direction="forward")
    np.testing.assert_allclose(peak_near(backward, 90.0)[1], 0.5e-6, rtol=0.01)


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"window_s": 3.0}, "window"),
        ({"window_s": 0.0}, "window"),
        ({"window_s": float("nan")}, "window"),
        ({"overlap": 1.0}, "overlap"),
        ({"direction": "z"}, "direction"),
    ],
)
def test_what_does_not_fit_is_refused(options: dict[str, object], key: str) -> None:
    with pytest.raises(InputError) as refused:
        spectra(np.zeros_like(TIME), **options)
    assert [fault.key for fault in refused.value.faults] == [key]


@pytest.mark.parametrize("time_s", [np.empty(0), np.zeros(1), np.zeros(9000), np.geomspace(1, 2, 9000)])
def test_times_that_are_not_even_are_refused(time_s: np.ndarray) -> None:
    with pytest.raises(InputError, match="time_s"):
        waterfall(time_s, time_s, time_s, time_s, CLEARANCE)


def test_a_run_as_long_as_one_window_gives_one_spectrum() -> None:
    few = slice(0, 4000)
    found = waterfall(TIME[few], np.sin(500 * TIME[few]), TIME[few], SPEED[few], CLEARANCE, window_s=0.2)
    assert found.amplitude.shape[1] == 1
    assert found.time_s[0] == pytest.approx(0.1)


# --------------------------------------------------------------------------------- against another implementation


@pytest.mark.parametrize("direction", ["x", "y", "forward"])
@pytest.mark.parametrize(("window_s", "overlap"), [(0.05, 0.9), (0.1, 0.5), (0.05, 0.77)])
def test_spectra_are_those_of_scipy_to_round_off(direction: Direction, window_s: float, overlap: float) -> None:
    from scipy.signal import ShortTimeFFT
    from scipy.signal.windows import general_cosine

    count, step = 23_456, 5e-5
    time_s = np.arange(count) * step
    x, y = 2e-6 + 1e-6 * np.random.default_rng(0).normal(size=(2, count))
    length = round(window_s / step)
    theirs = ShortTimeFFT(
        shape := general_cosine(length, WINDOW, sym=False),
        hop=round(length * (1.0 - overlap)),
        fs=1.0 / step,
        fft_mode="centered" if direction == "forward" else "onesided2X",
        mfft=fast_length(4 * length),
        scale_to="magnitude",
    )
    first, last = theirs.lower_border_end[1], theirs.upper_border_begin(count)[1]
    motion = {"x": x, "y": y, "forward": x + 1j * y}[direction]

    def without_line(values: np.ndarray) -> np.ndarray:
        there = np.arange(length)
        return values - np.polyval(np.polyfit(there, values, 1, w=np.sqrt(shape)), there)

    centred = partial(np.apply_along_axis, without_line, -1)
    lines = np.abs(theirs.stft_detrend(motion, centred, p0=first, p1=last))[theirs.f >= 0.0]
    found = waterfall(time_s, x, y, 100.0 * time_s, CLEARANCE, window_s, overlap, direction=direction)
    np.testing.assert_allclose(found.amplitude, lines, rtol=0, atol=1e-12 * lines.max())
    np.testing.assert_allclose(found.time_s, theirs.t(count, first, last), rtol=0, atol=1e-14)
    np.testing.assert_allclose(found.frequency_Hz, theirs.f[theirs.f >= 0.0], rtol=1e-12)


def test_spectra_do_without_scipy() -> None:
    code = "import sys, frbcli.analysis.spectrum, frbcli.analysis.events;" \
           " import frbcli.analysis.order_tracking;" \
           "assert not {'scipy.special', 'scipy.linalg', 'scipy.signal'} & set(sys.modules)"  # fmt: skip
    subprocess.run([sys.executable, "-c", code], check=True)


# ------------------------------------------------------------------------------------------------------- ramps


def test_height_of_a_chirp_is_its_integral() -> None:
    u = (np.arange(200_000) + 0.5) / 200_000 - 0.5
    for sweep in (0.0, 1e-5, 1e-3, 0.3, 1.0, 4.0, 40.0, 1e3):
        window = sum(term * np.cos(2 * np.pi * k * u) for k, term in enumerate(WINDOW)) / WINDOW[0]
        direct = abs(np.mean(window * np.exp(1j * np.pi * sweep * u**2)))
        assert float(chirp_height(np.array(sweep))) == pytest.approx(direct, abs=1e-9)
        assert float(chirp_height(np.array(-sweep))) == pytest.approx(direct, abs=1e-9)


FAST_TIME = np.arange(60_000) * 5e-5
FAST_SPEED = 1000.0 * FAST_TIME  # 3000 Hz in 3 s
FAST = 3.66e-6 * np.cos(2 * np.pi * 500.0 * FAST_TIME**2)


def synchronous(found: Spectrogram) -> np.ndarray:
    """Height (m,) of the highest line."""
    return found.amplitude.max(axis=0)


@pytest.mark.parametrize("window_s", [0.02, 0.05, 0.1, 0.2])
def test_what_a_ramp_takes_from_the_synchronous_line_is_told(window_s: float) -> None:
    found = waterfall(FAST_TIME, FAST, FAST, FAST_SPEED, CLEARANCE, window_s)
    told = synchronous(found) * 10.0 ** (found.low_dB / 20.0)
    inside = found.speed_Hz > 600.0  # where the line is not seen beside its mirror image below zero
    np.testing.assert_allclose(told[inside], 3.66e-6, rtol=0.012)  # 1 % lies between two lines of the spectrum
    assert found.low_dB[0] == pytest.approx(found.low_dB[-1], rel=1e-6)
    if window_s == 0.2:
        assert found.low_dB[0] == pytest.approx(8.61, abs=0.1)  # of the integral of its chirp


def test_the_window_follows_from_the_ramp() -> None:
    found = waterfall(FAST_TIME, FAST, FAST, FAST_SPEED, CLEARANCE)
    assert found.window_s == pytest.approx(1000.0**-0.5, rel=1e-3)
    np.testing.assert_allclose(synchronous(found)[found.speed_Hz > 300.0], 3.66e-6, rtol=0.02)
    assert found.low_dB.max() < 0.1


def test_the_window_parts_the_lines_that_have_to_be_parted() -> None:
    slow = np.arange(400_000) * 5e-5
    assert window_length(slow, 1.0 * slow) == pytest.approx(2.3 / (0.125 * 20.0), rel=1e-3)
    assert window_length(slow, np.full(len(slow), 300.0)) == pytest.approx(0.2)  # nothing asks for more
    assert window_length(slow, 30.0 * slow) == pytest.approx(30.0**-0.5, rel=1e-3)
    assert window_length(slow, 30.0 * slow, apart_Hz=5.0) == pytest.approx(0.46)
    half = np.cos(2 * np.pi * 0.25 * slow**2) + 0.5 * np.cos(2 * np.pi * 0.5 * slow**2)  # omega/2 and omega in 1 Hz/s
    found = waterfall(slow, half, half, slow, CLEARANCE)
    column = found.amplitude[:, int(np.argmin(np.abs(found.speed_Hz - 8.0)))]
    peaks = found.frequency_Hz[1:-1][(column[1:-1] > column[:-2]) & (column[1:-1] > column[2:]) & (column[1:-1] > 0.3)]
    np.testing.assert_allclose(peaks, [4.0, 8.0], atol=0.4)


# -------------------------------------------------------------------------------------------------- long runs


class Sliced:
    """Values that can be had in slices alone; remembers the longest."""

    def __init__(self, values: np.ndarray) -> None:
        self.values, self.longest = values, 0

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, where: slice) -> np.ndarray:
        taken = self.values[where]
        self.longest = max(self.longest, len(taken))
        return taken


def test_signals_are_read_a_few_windows_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (signals, spectrum):
        monkeypatch.setattr(module, "PIECE", 5000)
    columns = [Sliced(values) for values in (FAST_TIME, FAST, FAST, FAST_SPEED)]
    found = waterfall(*columns, CLEARANCE)
    assert max(column.longest for column in columns) <= 5000
    whole = waterfall(FAST_TIME, FAST, FAST, FAST_SPEED, CLEARANCE)
    np.testing.assert_allclose(found.amplitude, whole.amplitude, rtol=0, atol=1e-12 * whole.amplitude.max())


def test_fewer_spectra_than_windows_lose_no_peak() -> None:
    columns = FAST_TIME, FAST, FAST, FAST_SPEED
    whole, few = waterfall(*columns, CLEARANCE), waterfall(*columns, CLEARANCE, most=100)
    group = -(-whole.amplitude.shape[1] // 100)
    assert 90 < few.amplitude.shape[1] <= 100
    for column in range(few.amplitude.shape[1]):
        there = slice(column * group, (column + 1) * group)
        largest = whole.amplitude[:, there].max(axis=1)
        np.testing.assert_allclose(few.amplitude[:, column], largest, rtol=0, atol=1e-12 * largest.max())
        assert whole.time_s[there][0] <= few.time_s[column] <= whole.time_s[there][-1]
