"""A process of `frb`: its streams, the signals that end it, its exit code. The command itself is run by `main.run`.

Imports next to nothing at the top, so that Ctrl-C ends it quietly from the first moment on.
"""

from __future__ import annotations

import os
import signal
import sys
from _thread import interrupt_main
from contextlib import suppress
from threading import Timer
from types import FrameType
from typing import TYPE_CHECKING, NoReturn

from frbcli.cli.streams import OutputLost, closing_code, take_streams
from frbcli.errors import INTERRUPTED
from frbcli.runs.interrupt import SIGNALS

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

AGAIN_s = 0.01


class Interruption:
    """What the signals do. asked: the one that came, 0 if none did."""

    def __init__(self) -> None:
        self.asked = 0

    def __call__(self, number: int, _frame: FrameType | None) -> NoReturn:
        """The handler of the signals."""
        self.asked = number
        raise KeyboardInterrupt

    def listen(self) -> None:
        """Take the signals that are not ignored, as SIGHUP is under nohup."""
        for number in SIGNALS:
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self)
        sys.unraisablehook = self._unraisable

    def _unraisable(self, lost: UnraisableHookArgs) -> None:
        """Handles exceptions that cannot be caught, as in a callback or in the destructor of a library."""
        if isinstance(lost.exc_value, KeyboardInterrupt):  # it was dropped there: again, where it is heard
            Timer(AGAIN_s, interrupt_main, [self.asked]).start()
        elif not self.asked:  # incomplete objects of an interruption fail when they are destroyed
            sys.__unraisablehook__(lost)


def main() -> NoReturn:
    """The console script."""
    out, err = take_streams()
    interruption = Interruption()
    # Pictures go into files: no window system is asked for, and one that matplotlib does not know stops nothing.
    os.environ["MPLBACKEND"] = "agg"
    # The matrices here are small: a second thread of the linear algebra costs CPU time and gains none.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        interruption.listen()
        from frbcli.cli.main import run

        code = run(sys.argv[1:])
    except OutputLost:  # of --help, say, which has nothing else to do
        code = 0
    except BaseException:  # a library that is interrupted while it is imported or compiles may raise anything
        if not interruption.asked:
            raise
        err.write("interrupted\n")
        code = INTERRUPTED
    for number in SIGNALS:  # nothing is left to be kept
        signal.signal(number, signal.SIG_IGN)
    ended = closing_code(code, out, err, only_json="--json" in sys.argv)
    if interruption.asked:  # what a library has in half, such as a compiler, may not survive its own destruction
        with suppress(OutputLost):
            out.flush()
            err.flush()
        os._exit(ended)
    sys.exit(ended)
