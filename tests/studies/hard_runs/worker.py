"""One process beside this one that can be stopped if it hangs."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Any

from frbcli.runs.interruption import deaf

HUNG, DIED = "hung", "died"

Work = Callable[[Any], Any]


class Worker:
    """Does `work`, a function at the top of a module, in a process of its own, which begins anew if it hung or died."""

    def __init__(self, work: Work) -> None:
        self._work = work
        self._begin()

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, _type: type | None, _error: BaseException | None, _trace: TracebackType | None) -> None:
        self._end()

    def ask(self, task: object, within_s: float) -> Any:
        """The result of a task; HUNG if it takes longer than within_s, DIED if its process ends."""
        self._here.send(task)
        try:
            if self._here.poll(within_s):
                return self._here.recv()
            answer = HUNG
        except (EOFError, ConnectionError):
            answer = DIED
        self._end()
        self._begin()
        return answer

    def _begin(self) -> None:
        context = multiprocessing.get_context("spawn")  # a fork would share locks that threads hold
        self._here, there = context.Pipe()
        self._process = context.Process(target=_serve, args=(self._work, there), daemon=True)
        with deaf():
            self._process.start()
        there.close()

    def _end(self) -> None:
        self._here.close()
        self._process.kill()  # it ignores all that asks it to end, see deaf
        self._process.join()


def _serve(work: Work, there: Connection) -> None:
    """Answer tasks until the other end is closed."""
    while True:
        try:
            task = there.recv()
        except EOFError:
            return
        there.send(work(task))
