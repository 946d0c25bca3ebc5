"""What the compiler of the kernels does while other code runs: counted."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core.event import Listener, install_listener


class Compilations(Listener):
    """The compilations so far. functions: how many were compiled, with those that they call; cpu_s: CPU time.

    observe: called at the beginning and the end of each.
    """

    def __init__(self, observe: Callable[[], None] | None = None) -> None:
        self.functions, self.cpu_s = 0, 0.0
        self._observe, self._depth, self._began = observe, 0, 0.0

    def on_start(self, _event: Any) -> None:
        """A function is about to be compiled, maybe within another one."""
        if not self._depth:
            self._began = time.process_time()
        self._depth += 1
        self._tell()

    def on_end(self, _event: Any) -> None:
        """A function is compiled."""
        self.functions, self._depth = self.functions + 1, self._depth - 1
        if not self._depth:
            self.cpu_s += time.process_time() - self._began
        self._tell()

    def _tell(self) -> None:
        if self._observe is not None:
            self._observe()


@contextmanager
def counted(observe: Callable[[], None] | None = None) -> Iterator[Compilations]:
    """Within it compilations are counted."""
    compilations = Compilations(observe)
    with install_listener("numba:compile", compilations):
        yield compilations
