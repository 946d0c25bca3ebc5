"""Peaks, their prominence and their flanks, against scipy."""

import numpy as np
import pytest
from scipy.signal import find_peaks, peak_widths

from frbcli.analysis.spectrum import local_maxima, prominent_peaks


def curve(seed: int) -> np.ndarray:
    """A smooth random curve with a dozen peaks of all heights."""
    chance = np.random.default_rng(seed)
    x = np.linspace(0.0, 1.0, 1000)
    return np.sum([chance.normal() * np.cos(2 * np.pi * k * (x + chance.random())) for k in range(1, 12)], axis=0)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("least", [0.1, 1.0, 5.0])
def test_peaks_are_those_of_scipy(seed: int, least: float) -> None:
    values = curve(seed)
    places, known = find_peaks(values, prominence=least)
    found = prominent_peaks(values, least)
    assert [peak.place for peak in found] == places.tolist()
    np.testing.assert_allclose([peak.prominence for peak in found], known["prominences"])
    _, _, before, after = peak_widths(values, places, 0.5)
    assert all(peak.before <= left < peak.before + 1 for peak, left in zip(found, before, strict=True))
    assert all(peak.after - 1 < right <= peak.after for peak, right in zip(found, after, strict=True))


def test_maxima_of_at_least_a_height() -> None:
    values = curve(0)
    np.testing.assert_array_equal(local_maxima(values), find_peaks(values)[0])
    np.testing.assert_array_equal(local_maxima(values, 1.0), find_peaks(values, height=1.0)[0])


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 2.0], [1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 0.0]])
def test_a_curve_without_a_maximum_has_no_peak(values: list[float]) -> None:
    assert prominent_peaks(np.array(values), 0.1) == []
