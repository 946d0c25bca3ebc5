"""The rotor speed from pulses: those of any sensor, with missing and double ones, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from frbcli.analysis.measured import Measurement, measured_run
from frbcli.analysis.tacho import tacho_speed

RATE_Hz = 20_000.0
TIME = np.arange(0.0, 5.0, 1.0 / RATE_Hz)
RISING_Hz = 20.0 + 16.0 * TIME  # to 100 Hz
TURN = 20.0 * TIME + 8.0 * TIME**2


def pulse(turn: np.ndarray, width: float = 0.05) -> np.ndarray:
    return np.asarray(turn % 1.0 < width, dtype=np.float64)


def sensors() -> dict[str, np.ndarray]:
    chance = np.random.default_rng(3)
    rectangular = pulse(TURN)
    edge = np.diff(rectangular, prepend=0.0)
    ringing = np.convolve(edge, np.exp(-np.arange(60) / 12.0) * np.cos(np.arange(60) / 2.0))[: len(TIME)]
    return {
        "sine with noise": np.sin(2.0 * np.pi * TURN) + chance.normal(0.0, 0.01, len(TIME)),
        "growing sine": RISING_Hz / 100.0 * np.sin(2.0 * np.pi * TURN) + chance.normal(0.0, 0.01, len(TIME)),
        "wrong polarity": -8.0 - 7.0 * rectangular + chance.normal(0.0, 0.05, len(TIME)),
        "overshoot": rectangular + 0.4 * ringing,
        "12 bit": np.round((np.sin(2.0 * np.pi * TURN) + chance.normal(0.0, 0.005, len(TIME))) * 30.0) / 30.0,
        "one spike": rectangular + 40.0 * (np.arange(len(TIME)) == 44_444),
    }


@pytest.mark.parametrize("kind", list(sensors()))
def test_the_speed_of_any_sensor_is_that_of_the_rotor(kind: str) -> None:
    found = tacho_speed(TIME, sensors()[kind], 1)
    inner = slice(2000, -2000)
    assert found.speed_Hz[inner] == pytest.approx(RISING_Hz[inner], rel=5e-3)
    assert (found.missing, found.double) == (0, 1 if kind == "one spike" else 0)


def test_missing_and_double_pulses_are_found_and_said(tmp_path: Path) -> None:
    turns = np.floor(TURN)
    signal = pulse(TURN) * ~np.isin(turns, [50, 120, 121])  # three of them are missing
    signal = np.maximum(signal, pulse(TURN - 0.37) * np.isin(np.floor(TURN - 0.37), [80, 200]))
    found = tacho_speed(TIME, signal, 1)
    assert (found.missing, found.double) == (3, 2)
    inner = slice(2000, -2000)
    assert found.speed_Hz[inner] == pytest.approx(RISING_Hz[inner], rel=5e-3)
    lines = [f"{t:.5f},{np.cos(2 * np.pi * a):.4f},{p:g}" for t, a, p in zip(TIME, TURN, signal, strict=True)]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["t [s],x [um],key", *lines]), encoding="utf-8")
    run = measured_run(path, Measurement("x", time="t", tacho="key"))
    assert 'Pulses of "key": 3 missing ones were added and 2 double ones left out' in run.remarks[1]


@pytest.mark.parametrize(("kind", "share"), [("missing", 0.05), ("missing", 0.1), ("double", 0.05), ("double", 0.2)])
@pytest.mark.parametrize("seed", range(4))
def test_many_pulses_are_missing_or_double(kind: str, share: float, seed: int) -> None:
    """By the median of three intervals, one in twenty pulses that were double made the speed 60 % too high."""
    turns = np.random.default_rng(seed).choice(np.arange(2, 290), round(share * 300), replace=False)
    if kind == "missing":
        signal = pulse(TURN) * ~np.isin(np.floor(TURN), turns)
    else:
        signal = np.maximum(pulse(TURN), pulse(TURN - 0.1) * np.isin(np.floor(TURN - 0.1), turns))
    found = tacho_speed(TIME, signal, 1)
    assert (found.missing, found.double) == ((len(turns), 0) if kind == "missing" else (0, len(turns)))
    assert found.speed_Hz[2000:-2000] == pytest.approx(RISING_Hz[2000:-2000], rel=1e-2)


def test_a_tooth_that_a_wheel_lacks_is_added() -> None:
    """Eight teeth, one of them broken off: the speed was seven eighths of the true one."""
    found = tacho_speed(TIME, pulse(8.0 * TURN, 0.5) * (TURN % 1.0 > 0.125), 8)
    assert found.speed_Hz[2000:-2000] == pytest.approx(RISING_Hz[2000:-2000], rel=1e-2)


@pytest.mark.parametrize(
    ("signal", "said"),
    [
        (np.random.default_rng(1).normal(0.0, 0.01, len(TIME)), "pulses at uneven intervals"),
        (np.maximum(pulse(TURN), pulse(TURN - 0.1)), "pulses at uneven intervals"),  # two marks, said to be one
        (pulse(TURN) * ((TIME < 1.0) | (TIME > 3.0)), r"no pulses from 0\.97\d* s to 3\.13 s"),
    ],
    ids=["noise", "two marks", "gap"],
)
def test_a_signal_that_gives_no_speed_is_refused(signal: np.ndarray, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        tacho_speed(TIME, signal, 1)


def test_a_rotor_that_starts_and_stops_misses_no_pulse() -> None:
    time = np.arange(0.0, 20.0, 1e-4)
    speed = 30.0 * np.sin(np.pi * time / 20.0)
    turn = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    found = tacho_speed(time, pulse(turn + 0.5), 1)
    assert found.missing == found.double == 0
    middle = speed > 5.0
    assert found.speed_Hz[middle] == pytest.approx(speed[middle], rel=0.02)


@pytest.mark.parametrize("held_Hz", [4.0, 8.0])
def test_the_angle_stays_at_the_pulses_of_a_slow_roll_with_a_run_up(held_Hz: float) -> None:
    """A speed averaged over some revolutions misses a quarter of one where a slow rotor begins to speed up; the angle
    behind that still is the one of the pulses, to which the phases of balancing refer."""
    time = np.arange(0.0, 16.0, 1e-4)
    speed = held_Hz + 6.0 * np.maximum(time - 4.0, 0.0)
    turn = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    found = tacho_speed(time, pulse(turn), 1)
    assert found.mark is not None
    integrated = np.cumsum(found.speed_Hz) * 1e-4 - found.mark
    late = (time > 7.0) & (time < 15.0)
    off = integrated[late] - turn[late]
    assert off - np.round(off.mean()) == pytest.approx(0.0, abs=0.015)
    assert found.speed_Hz[late] == pytest.approx(speed[late], rel=5e-3)


def test_a_wheel_with_uneven_teeth_misses_none() -> None:
    signal = np.maximum(pulse(TURN), pulse(TURN - 0.25))
    found = tacho_speed(TIME, signal, 2)
    assert found.missing == found.double == 0
    inner = slice(2000, -2000)
    assert found.speed_Hz[inner] == pytest.approx(RISING_Hz[inner], rel=0.03)
