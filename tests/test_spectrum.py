"""Spectra of motions whose amplitudes and frequencies are known."""

from __future__ import annotations

import numpy as np
import pytest

from frbcli.analysis.spectrum import FLOOR_dB, Spectrogram, waterfall
from frbcli.errors import InputError

CLEARANCE = 35e-6
TIME = np.arange(40_000) * 5e-5
SPEED = 150.0 * TIME


def spectra(x: np.ndarray, y: np.ndarray | None = None, **options: object) -> Spectrogram:
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


def test_two_tones_and_a_static_displacement() -> None:
    x = 20e-6 + 5e-6 * np.sin(2 * np.pi * 75.0 * TIME) + 1e-6 * np.sin(2 * np.pi * 152.0 * TIME)
    found = spectra(x)
    np.testing.assert_allclose(peak_near(found, 75.0)[1], 5e-6, rtol=0.01)
    np.testing.assert_allclose(peak_near(found, 152.0)[1], 1e-6, rtol=0.01)
    np.testing.assert_array_less(found.amplitude[found.frequency_Hz > 180.0], 2e-8)
    np.testing.assert_array_less(found.amplitude[0], 1e-7)  # the static displacement is no motion


def test_a_chirp_is_followed() -> None:
    rate = 30.0
    found = spectra(4e-6 * np.cos(2 * np.pi * (40.0 * TIME + 0.5 * rate * TIME**2)), window_s=0.1)
    ridge = found.frequency_Hz[np.argmax(found.amplitude, axis=0)]
    np.testing.assert_allclose(ridge, 40.0 + rate * found.time_s, atol=2.6)
    np.testing.assert_allclose(found.amplitude.max(axis=0), 4e-6, rtol=0.02)


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


def test_axes_fit_the_amplitudes_and_stay_inside_the_run() -> None:
    found = spectra(np.sin(TIME), max_frequency_Hz=360.0)
    assert found.amplitude.shape == found.level_dB.shape == (len(found.frequency_Hz), len(found.time_s))
    assert found.frequency_Hz[0] == 0.0
    assert 355.0 < found.frequency_Hz[-1] <= 360.0
    assert 0.09 < found.time_s[0] < 0.13
    assert TIME[-1] - 0.13 < found.time_s[-1] < TIME[-1] - 0.09
    np.testing.assert_allclose(found.speed_Hz, 150.0 * found.time_s, rtol=1e-9)


def test_time_need_not_begin_at_zero() -> None:
    zero = spectra(np.sin(400 * TIME))
    later = waterfall(TIME + 7.0, np.sin(400 * TIME), np.zeros_like(TIME), SPEED, CLEARANCE)
    np.testing.assert_allclose(later.time_s, zero.time_s + 7.0)
    np.testing.assert_allclose(later.speed_Hz, zero.speed_Hz, rtol=1e-9)


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
