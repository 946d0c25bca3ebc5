"""Amplitudes by order of motions whose amplitudes are known, in ramps that smear every spectrum."""

import tracemalloc
from dataclasses import dataclass, field

import numpy as np
import pytest
from synthetic_run import as_run

from frbcli.analysis import signals
from frbcli.analysis.events import find_events
from frbcli.analysis.order_tracking import order_track, order_tracks
from frbcli.analysis.signals import signal_of
from frbcli.analysis.spectrum import waterfall
from frbcli.errors import InputError
from frbcli.results.store import Run


def ramp(top_Hz: float, duration_s: float, sense: float = 1.0, step_s: float = 5e-5) -> Run:
    """Static displacement, unbalance that grows with time, backward motion, whirl at half the speed."""
    time_s = np.arange(round(duration_s / step_s)) * step_s
    speed = sense * top_Hz * time_s / duration_s
    phi = 2 * np.pi * sense * 0.5 * top_Hz / duration_s * time_s**2
    motion = 10e-6 * np.exp(0.7j) + unbalance(time_s, duration_s) * np.exp(1j * phi)
    motion += 0.5e-6 * np.exp(-1j * (phi - 0.2)) + 1e-6 * np.exp(1j * (0.5 * phi + 1.0))
    journal = {"journal_x_m": motion.real, "journal_y_m": motion.imag}
    return as_run({"time_s": time_s, "speed_Hz": speed, **journal})


def unbalance(time_s: np.ndarray, duration_s: float) -> np.ndarray:
    return np.asarray(3.66e-6 * (1.0 + 0.3 * np.sin(2 * np.pi * time_s / duration_s)))


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize(("top_Hz", "duration_s"), [(3000.0, 3.0), (300.0, 10.0), (3000.0, 0.3)])
def test_amplitudes_are_exact_in_a_ramp(top_Hz: float, duration_s: float, sense: float) -> None:
    """Also at 3000 Hz, where a revolution has but 6.7 samples."""
    first, half = order_tracks(ramp(top_Hz, duration_s, sense), (1.0, 0.5))
    true = unbalance(first.time_s, duration_s)
    moving = np.abs(first.speed_Hz) > 0.2 * top_Hz
    assert np.count_nonzero(moving) > 1000
    np.testing.assert_allclose(first.amplitude("forward")[moving], true[moving], rtol=5e-3)
    np.testing.assert_allclose(np.abs(first.backward)[moving], 0.5e-6, rtol=5e-3)
    np.testing.assert_allclose(half.amplitude("forward"), 1e-6, rtol=5e-3)
    np.testing.assert_allclose(np.degrees(np.angle(half.forward[moving])), np.degrees(1.0), atol=0.5)


def test_directions_are_those_of_an_ellipse() -> None:
    track = order_track(ramp(300.0, 10.0), 1.0)
    forward, backward = track.forward, track.backward
    angle = np.linspace(0.0, 2 * np.pi, 721)
    for sample in (100, 5000):
        orbit = forward[sample] * np.exp(1j * angle) + backward[sample] * np.exp(-1j * angle)
        assert track.amplitude("x")[sample] == pytest.approx(orbit.real.max(), rel=1e-4)
        assert track.amplitude("y")[sample] == pytest.approx(orbit.imag.max(), rel=1e-4)
        at = np.radians(track.phase_deg("y")[sample])
        np.testing.assert_allclose(orbit.imag, track.amplitude("y")[sample] * np.cos(angle + at), atol=1e-12)
    with pytest.raises(InputError, match="direction"):
        track.amplitude("z")  # type: ignore[arg-type]


def test_unbalance_is_seen_beside_a_whip_a_thousand_times_larger() -> None:
    run = ramp(3000.0, 3.0)
    columns = {name: run[name].copy() for name in run.signals}
    columns["journal_x_m"] += 4e-3 * np.cos(2 * np.pi * 145.0 * run["time_s"])
    columns["journal_y_m"] += 4e-3 * np.sin(2 * np.pi * 145.0 * run["time_s"])
    track = order_track(as_run(columns), 1.0)
    fast = track.speed_Hz > 1000.0
    np.testing.assert_allclose(track.amplitude("forward")[fast], unbalance(track.time_s, 3.0)[fast], rtol=0.01)


@dataclass
class Lazy:
    """A run that is read in pieces alone, and remembers the longest."""

    run: Run
    longest: int = 0
    status: str = "finished"
    references: dict[str, float] = field(default_factory=dict)

    @property
    def signals(self) -> list[str]:
        return list(self.run.signals)

    def __len__(self) -> int:
        return len(self.run)

    def __getitem__(self, name: str) -> np.ndarray:
        raise AssertionError(f"{name} was read at once")

    def read(self, name: str, start: int, stop: int) -> np.ndarray:
        self.longest = max(self.longest, stop - start)
        return self.run[name][start:stop]


def test_a_long_run_is_tracked_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    run = ramp(300.0, 10.0)
    whole = order_track(run, 1.0)
    monkeypatch.setattr(signals, "PIECE", 1000)
    lazy = Lazy(run)
    pieces = order_track(lazy, 1.0)
    assert lazy.longest <= 1001
    np.testing.assert_allclose(pieces.time_s, whole.time_s, rtol=1e-12)
    np.testing.assert_allclose(pieces.forward, whole.forward, rtol=0, atol=1e-9 * 3.66e-6)


class Endless:
    """Two million samples of a slow rotor that are made when they are read."""

    signals = ("time_s", "speed_Hz", "eccentricity", "journal_x_m", "journal_y_m")
    status = "finished"
    references = {"clearance_m": 35e-6}  # noqa: RUF012

    def __len__(self) -> int:
        return 2_000_000

    def __getitem__(self, name: str) -> np.ndarray:
        raise AssertionError(f"{name} was read at once")

    def read(self, name: str, start: int, stop: int) -> np.ndarray:
        time_s = np.arange(start, stop) * 5e-5
        made = {"time_s": time_s, "speed_Hz": 0.3 * time_s, "eccentricity": np.full(stop - start, 0.1)}
        turned = 2 * np.pi * 0.15 * time_s**2
        return made[name] if name in made else 1e-6 * (np.cos(turned) if "_x_" in name else np.sin(turned))


@pytest.mark.parametrize("look", ["orders", "events", "spectra"])
def test_memory_does_not_grow_with_the_samples(look: str) -> None:
    """Each signal has 16 MB."""
    run = Endless()
    columns = [signal_of(run, name) for name in ("time_s", "journal_x_m", "journal_y_m", "speed_Hz")]
    tracemalloc.start()
    try:
        if look == "orders":
            track = order_track(run, 1.0)
            np.testing.assert_allclose(track.amplitude("forward"), 1e-6, rtol=1e-3)
        elif look == "events":
            assert find_events(run) == ()
        else:
            found = waterfall(*columns, 35e-6, max_frequency_Hz=36.0, most=200)
            assert found.amplitude.shape[1] <= 200
        assert tracemalloc.get_traced_memory()[1] < 40e6
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("order", "options", "key"),
    [
        (0.0, {}, "order"),
        (-1.0, {}, "order"),
        (float("nan"), {}, "order"),
        (1e9, {}, "order"),
        (1.0, {"signal": "disk"}, "signal"),
        (1.0, {"signal": "journal_left"}, "signal"),
        (1.0, {"revolutions": 2}, "revolutions"),
        (1.0, {"revolutions": 1000}, "window"),
    ],
)
def test_what_there_is_not_is_refused(order: float, options: dict[str, object], key: str) -> None:
    with pytest.raises(InputError) as refused:
        order_track(ramp(300.0, 1.0), order, **options)  # type: ignore[arg-type]
    assert [fault.key for fault in refused.value.faults] == [key]


@pytest.mark.parametrize("samples", [0, 1, 2])
def test_a_run_without_samples_is_refused(samples: int) -> None:
    run = ramp(300.0, 1.0)
    with pytest.raises(InputError, match="longer than the run"):
        order_track(as_run({name: run[name][:samples] for name in run.signals}), 1.0)
