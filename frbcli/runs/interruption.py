"""Runs that are interrupted and go on. Ctrl-C is heard at times at which the state of a run is consistent; the state of
a checkpoint is checked against the machine of the run, since the compiled time loop does not check it."""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import FrameType

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import SIGNALS
from frbcli.results.container import refuse
from frbcli.results.records import SPEED as SPEED_SIGNAL
from frbcli.results.records import TIME as TIME_SIGNAL
from frbcli.results.records import pieces
from frbcli.results.store import Run
from frbcli.rotor.loads import SpeedProfile
from frbcli.solve.state import NUMBERS, OUTPUTS, PIECE, RUN_END, STEP, STEP_DONE, TIME, State


class Interrupt:
    """asked: whether Ctrl-C was pressed, or another signal came that means the same."""

    def __init__(self) -> None:
        self.asked = False

    def ask(self, _signal: int, _frame: FrameType | None) -> None:
        """Handles a signal: from now on an end is asked for."""
        self.asked = True


@contextmanager
def deaf() -> Iterator[None]:
    """Within it Ctrl-C and its like are ignored, also by processes that start within it: a terminal and a batch system
    send them to all at once, and the caller ends these."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    if threading.current_thread() is not threading.main_thread() or not callable(before[signal.SIGINT]):
        yield
        return
    for number in before:
        signal.signal(number, signal.SIG_IGN)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def held_back() -> Iterator[Interrupt]:
    """Within it, Ctrl-C only sets `asked`, which the caller reads when the state is consistent.

    So do other signals that are to end the process, where it has a handler for them, as the command line does. Only the
    main thread is interrupted, and only by what is not ignored altogether (as under nohup). A handler that was `asked`
    before, whose interruption a library has dropped, has not been heard yet.
    """
    interrupt = Interrupt()
    before = {number: handler for number in SIGNALS if callable(handler := signal.getsignal(number))}
    if threading.current_thread() is not threading.main_thread():
        before = {}
    interrupt.asked = any(getattr(handler, "asked", 0) for handler in before.values())
    for number in before:
        signal.signal(number, interrupt.ask)
    try:
        yield interrupt
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


SAME = 1e-9  # share of the longest time or highest speed that is round-off
LARGEST = 1e30  # of any number, in SI


class WrongCheckpoint(Exception):
    """The checkpoint of a run is not one of this machine and its speeds; says why."""


def restored(checkpoint: Mapping[str, Array], fresh: State, profile: SpeedProfile, output_step: float) -> State:
    """The state of a checkpoint. fresh: the state at the beginning of the run; output_step: of its samples, s.

    Raises WrongCheckpoint unless all arrays are there, of the same shape as at the beginning, with finite numbers, and
    time, piece of the profile and number of samples fit together.
    """
    state = State(*(array(checkpoint, name, part.shape) for name, part in fresh._asdict().items()))
    numbers, times = state.numbers, profile.times
    t, piece, outputs = numbers[TIME], numbers[PIECE], numbers[OUTPUTS]
    fits = (
        numbers[RUN_END] == fresh.numbers[RUN_END]
        and np.all(numbers[:NUMBERS] >= 0.0)
        and min(numbers[STEP], numbers[STEP_DONE]) > 0.0
        and piece in range(len(times) - 1)
        and times[int(piece)] <= t <= times[int(piece) + 1]
        and float(outputs).is_integer()
        and math.isclose(outputs, t / output_step + 0.5, abs_tol=0.5 + 1e-6)
    )
    if not fits:
        raise WrongCheckpoint("its numbers are inconsistent")
    return state


def check_samples(run: Run, count: int, profile: SpeedProfile, output_step: float, is_free: bool) -> None:
    """Raise WrongCheckpoint unless a run had `count` samples at its checkpoint, at the times and speeds of this one.
    is_free: whether the speed is free, and does not follow the profile."""
    if run.checkpoint_samples != count:
        raise WrongCheckpoint(f"it belongs to {count} samples, not {run.checkpoint_samples}")
    fastest = float(np.max(np.abs(profile.speeds)))
    for begin, end in pieces(0, count):
        times: Array = output_step * np.arange(begin, end, dtype=np.float64)
        speeds = profile.speed(times)
        turned = speeds if is_free else 2.0 * math.pi * run.read(SPEED_SIGNAL, begin, end)
        late = np.abs(run.read(TIME_SIGNAL, begin, end) - times).max()
        off = np.abs(turned - speeds).max()
        if late > SAME * profile.end or off > SAME * fastest:
            raise WrongCheckpoint("its samples have other times or speeds")


def number_of(run: Run, name: str, place: int) -> float | None:
    """The number at a place of an array in the checkpoint of a run; None where there is none. Raises RunFileError for
    an array that has no such number."""
    if run.checkpoint is None or name not in run.checkpoint:
        return None
    numbers = np.asarray(run.checkpoint[name])
    if numbers.ndim != 1 or len(numbers) <= place or not abs(numbers[place]) <= LARGEST:
        raise refuse(run.path, f"has a checkpoint whose {name} do not belong to a run.", "Run the case again.")
    return float(numbers[place])


def array(checkpoint: Mapping[str, Array], name: str, shape: tuple[int, ...]) -> Array:
    """A copy of an array of a checkpoint. Raises WrongCheckpoint unless it has that shape and finite numbers."""
    copied = np.array(checkpoint[name]) if name in checkpoint else None
    if copied is None or copied.dtype != np.float64 or copied.shape != shape:
        raise WrongCheckpoint(f"{name} is missing or has another shape")
    if not np.all(np.abs(copied) <= LARGEST):
        raise WrongCheckpoint(f"{name} holds invalid numbers")
    return copied
