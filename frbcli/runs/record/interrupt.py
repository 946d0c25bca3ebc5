"""Ctrl-C at times at which the state is consistent."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# Those that ask a process to end, so that it can keep what it has. Windows does not have the last one.
SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


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
