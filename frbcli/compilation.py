"""What the compiler of the kernels does while other code runs: counted, with its CPU time apart from that code's."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

from numba.core.event import Listener, install_listener, register

COMPILE = "numba:compile"  # the event of numba


class Compilations(Listener):
    """The compilations so far. functions: how many were compiled, with those that they call; cpu_s, wall_s: time.

    observe: called at the beginning and the end of each.
    """

    def __init__(self, observe: Callable[[], None] | None = None) -> None:
        self.functions, self.cpu_s, self.wall_s = 0, 0.0, 0.0
        self._observe, self._depth, self._began = observe, 0, (0.0, 0.0)

    @property
    def spent_s(self) -> float:
        """CPU time so far, also while one is going on."""
        return self.cpu_s + (time.process_time() - self._began[0] if self._depth else 0.0)

    def on_start(self, _event: Any) -> None:
        """A function is about to be compiled, maybe within another one."""
        if not self._depth:
            self._began = time.process_time(), time.perf_counter()
        self._depth += 1
        self._notify()

    def on_end(self, _event: Any) -> None:
        """A function is compiled."""
        self.functions, self._depth = self.functions + 1, self._depth - 1
        if not self._depth:
            self.cpu_s += time.process_time() - self._began[0]
            self.wall_s += time.perf_counter() - self._began[1]
        self._notify()

    def _notify(self) -> None:
        if self._observe is not None:
            self._observe()


@contextmanager
def counted(observe: Callable[[], None] | None = None) -> Iterator[Compilations]:
    """Within it compilations are counted."""
    compilations = Compilations(observe)
    with install_listener(COMPILE, compilations):
        yield compilations


class CompilationNeededError(Exception):
    """A kernel is not on disk where nothing is to be compiled."""


class _Refusing(Listener):
    def on_start(self, _event: Any) -> None:
        raise CompilationNeededError

    def on_end(self, _event: Any) -> None:
        """Nothing was compiled."""


@contextmanager
def without_compiling() -> Iterator[None]:
    """Within it kernels come from disk.

    Raises:
        CompilationNeededError: one is not there.
    """
    with install_listener(COMPILE, _Refusing()):
        yield


class Clock(NamedTuple):
    """Times in s of this process, in which it did not compile."""

    cpu_s: float
    wall_s: float


_SO_FAR = Compilations()  # of this process
_register: Any = register  # numba gives no types of it
_register(COMPILE, _SO_FAR)


def working_time() -> Clock:
    """The time now, without what was compiled so far: what a first start computes takes as long as a later one."""
    return Clock(time.process_time() - _SO_FAR.cpu_s, time.perf_counter() - _SO_FAR.wall_s)


def compiled_s() -> float:
    """CPU time in s that this process has compiled so far."""
    return _SO_FAR.cpu_s
