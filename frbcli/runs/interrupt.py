"""Ctrl-C at a time when nothing is half done."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Interrupt:
    """asked: whether Ctrl-C was pressed."""

    def __init__(self) -> None:
        self.asked = False

    def ask(self, _signal: int, _frame: FrameType | None) -> None:
        """The handler of the signal."""
        self.asked = True


@contextmanager
def held_back() -> Iterator[Interrupt]:
    """Within it, Ctrl-C does nothing but be remembered: the caller looks at `asked` when it suits.

    Only the main thread is interrupted by Ctrl-C, and only where it is not ignored altogether (as under nohup).
    """
    interrupt = Interrupt()
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield interrupt
        return
    signal.signal(signal.SIGINT, interrupt.ask)
    try:
        yield interrupt
    finally:
        signal.signal(signal.SIGINT, before)
