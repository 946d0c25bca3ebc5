"""A process of `frb`: its streams, the signals that end it, its exit code, its memory, and libraries that start without
what no command needs of them. The command itself is run by `main.run`.

Imports next to nothing at the top, so that Ctrl-C ends it quietly from the first moment on.

stdout and stderr may be full, closed, or pipes without a reader. A stream that cannot be written is remembered: the
command continues its work, and the process reports it at the end.

Too little memory is reported in one line, whatever error a library raises. Where a process may use little memory
(`ulimit -v`), libraries do not load, the compiler aborts, and linear algebra waits forever for its buffers. So too
small a limit is reported before any of them is loaded; what happens later, with an error of a library's own kind, is
reported after it.
"""

from __future__ import annotations

import atexit
import errno
import gc
import io
import math
import os
import signal
import sys
from _thread import interrupt_main
from collections.abc import Callable
from contextlib import suppress
from threading import Timer, main_thread
from time import monotonic, process_time
from types import FrameType
from typing import TYPE_CHECKING, Any, NoReturn, TextIO

from frbcli.errors import INTERRUPTED, SIGNALS, OutOfMemory

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

try:
    import resource
except ImportError:  # Windows has no such limits
    resource = None  # type: ignore[assignment]

AGAIN_s = 0.01
WITHIN_s, WAITS_s = 10.0, 60.0  # CPU time and time without interruption of an import, which is slow on a busy machine
YOUNG = 300_000  # objects between two searches for garbage: what imports make stays, and searches find nothing
IMPORTS = "<frozen importlib._bootstrap>"  # where Python imports a module

PICTURES, ARTISTS, DESCRIBE = "matplotlib.", "matplotlib.artist", "_update_set_signature_and_docstring"

# Bytes of addresses that a usual run takes, and some more; each thread of linear algebra has buffers of its own.
USUAL, PER_THREAD = 900_000_000, 50_000_000
SUSPECT = 2.0  # times as much, below which an error of another kind may have come from too little memory
RESERVE = 32_000_000  # bytes that are freed for the error message
LONGEST_REASON = 150  # characters
DESCRIPTORS = {0: os.O_WRONLY, 1: os.O_RDONLY, 2: os.O_RDONLY}  # the wrong way round: to use them fails
LOST = 1  # exit code of a command whose stdout or stderr takes no more
UNREAD = 141  # 128 + SIGPIPE, as a shell reports other programs whose reader is gone


class Interruption:
    """The handler of the signals. asked: the one that came, 0 if none did.

    An import is not interrupted, at least not for WITHIN_s of work or WAITS_s of waiting: libraries drop what is raised
    there, or show it and raise something else. What is raised is kept to the end, and with it the frames that it came
    through: the compiler's objects in them may belong to two owners at that moment, and do not survive to be destroyed.
    """

    def __init__(self) -> None:
        self.asked = 0
        self._raised: list[KeyboardInterrupt] = []
        self._until = 0.0, 0.0

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """The handler of the signals."""
        if not self.asked:
            self.asked, self._until = number, (process_time() + WITHIN_s, monotonic() + WAITS_s)
        if _imports(frame) and process_time() < self._until[0] and monotonic() < self._until[1]:
            self._again()
            return
        self._raised.append(KeyboardInterrupt())
        raise self._raised[-1]

    def _again(self) -> None:
        again = Timer(AGAIN_s, _send, [self.asked])
        again.daemon = True
        again.start()

    def listen(self) -> None:
        """Take the signals that are not ignored, as SIGHUP is under nohup."""
        for number in SIGNALS:
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self)
        sys.unraisablehook = self._unraisable

    def _unraisable(self, lost: UnraisableHookArgs) -> None:
        """Handles exceptions that cannot be caught, as in a callback or in the destructor of a library."""
        if isinstance(lost.exc_value, KeyboardInterrupt):  # it was dropped there: again, where it is heard
            self._again()
        elif not self.asked:  # incomplete objects of an interruption fail when they are destroyed
            sys.__unraisablehook__(lost)


class Leaving:
    """Ends the process after all else that libraries do at its end; modules and objects are not taken apart, which
    would take a fifth of the CPU time of a short run.

    code: the exit code; None as long as the command has none, which leaves the end to Python.
    """

    def __init__(self, out: OutputStream, err: OutputStream) -> None:
        self.code: int | None = None
        self._streams = out, err
        atexit.register(self._leave)  # the first to be registered is the last to be called

    def _leave(self) -> None:
        if self.code is not None:
            leave(self.code, *self._streams)


def leave(code: int, *streams: OutputStream) -> NoReturn:
    """End the process at once."""
    for stream in streams:
        with suppress(OutputLost):
            stream.flush()
    os._exit(code)


def _send(number: int) -> None:
    """Interrupt the main thread, also where it waits."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(main_thread().ident or 0, number)
    else:
        interrupt_main(signal.Signals(number))


def _imports(frame: FrameType | None) -> bool:
    """Whether a frame runs within an import."""
    while frame is not None and frame.f_code.co_filename != IMPORTS:
        frame = frame.f_back
    return frame is not None


def main() -> NoReturn:
    """The console script."""
    out, err = take_streams()
    leaving, interruption = Leaving(out, err), Interruption()
    gc.set_threshold(YOUNG, *gc.get_threshold()[1:])
    prepare_libraries()
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
    if interruption.asked:  # what a library has in half, such as a compiler, may not survive its own end
        leave(ended, out, err)
    leaving.code = ended
    sys.exit(ended)


def prepare_libraries() -> None:
    """Set what libraries read when they are imported, and spare them what they would do in vain."""
    # No program and no module comes from the current folder, also in processes that this one starts.
    if "PATH" in os.environ:
        os.environ["PATH"] = os.pathsep.join(filter(os.path.isabs, os.environ["PATH"].split(os.pathsep)))
    os.environ["NODEFAULTCURRENTDIRECTORYINEXEPATH"] = "1"  # of Windows
    os.environ.setdefault("PYTHONSAFEPATH", "1")
    # Pictures go into files: no window system is asked for, and one that matplotlib does not know stops nothing.
    os.environ["MPLBACKEND"] = "agg"
    # The matrices here are small: a second thread of the linear algebra costs CPU time and gains none.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Plugins of pydantic are for the models of others; it would read the metadata of all that is installed.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    if not any(isinstance(finder, Spared) for finder in sys.meta_path):
        sys.meta_path.insert(0, Spared())


class Spared:
    """Asked for each module before it is imported, it finds none, but spares matplotlib its longest beginning: the
    docstrings of the properties of all its classes, a seventh of the CPU time of a picture."""

    def find_spec(self, name: str, *_: object) -> None:
        """Takes the docstrings out as soon as there is a class to write them."""
        if name.startswith(PICTURES) and hasattr(sys.modules.get(ARTISTS), "kwdoc"):
            _without_docstrings(sys.modules[ARTISTS])


def _without_docstrings(artist: Any) -> None:
    if artist.kwdoc is not _no_docstring and hasattr(artist.Artist, DESCRIBE):
        artist.kwdoc = _no_docstring
        setattr(artist.Artist, DESCRIBE, classmethod(_mark_set))


def _no_docstring(_: object) -> str:
    return ""


def _mark_set(artist: Any) -> None:
    """The setter of all properties of a class is not one of its own: classes that follow from it get theirs."""
    artist.set._autogenerated_signature = True


def require_memory() -> None:
    """Raises OutOfMemory where this process may use less than a usual run takes."""
    if _allowed() < _enough():
        raise OutOfMemory(f"out of memory.{_limits()} Allow more.")


def reserve() -> bytearray:
    """Memory to be let go when none is left; nothing where nothing limits it. It is never touched, and takes none."""
    return bytearray(RESERVE if _allowed() < math.inf else 0)


def shortage(error: BaseException) -> OutOfMemory | None:
    """The message for an error that comes, or may come, from too little memory; None for any other."""
    if not isinstance(error, MemoryError) and _allowed() > SUSPECT * _enough():
        return None
    reason = " ".join(str(error).split())[:LONGEST_REASON]
    cause = f"out of memory ({reason})." if reason else "out of memory."
    remedy = "Allow more, or ask for less: fewer cells (accuracy.mesh), fewer samples (output.step)."
    return OutOfMemory(f"{cause}{_limits()} {remedy}")


def _limits() -> str:
    """A sentence on the memory that is allowed and that a run takes; empty without a limit."""
    if _allowed() == math.inf:
        return ""
    return f" This process may use {_allowed() / 1e6:.0f} MB (ulimit -v); a usual run takes {_enough() / 1e6:.0f} MB."


def _enough() -> float:
    """Bytes of addresses for a usual run on this machine."""
    return USUAL + PER_THREAD * float(os.cpu_count() or 1)


def _allowed() -> float:
    """Bytes of addresses that this process may use, infinite where nothing limits them."""
    if resource is None:
        return math.inf
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return math.inf if limit == resource.RLIM_INFINITY else float(limit)


class OutputLost(Exception):
    """stdout takes no more: who writes much of it can stop."""


class OutputStream(io.TextIOWrapper):
    """stdout or stderr. lost: why it takes no more, None as long as it does.

    raises: whether OutputLost is raised when that happens; what is written afterwards is dropped.
    """

    def __init__(self, descriptor: int, stream: TextIO | None, raises: bool) -> None:
        if stream is None:  # it was closed
            super().__init__(io.BufferedWriter(io.FileIO(descriptor, "w", closefd=False)), "utf-8", errors="replace")
        else:
            lines = stream.line_buffering
            super().__init__(stream.buffer, stream.encoding, errors="replace", line_buffering=bool(lines))
        self.lost: OSError | None = None
        self._raises = raises

    def write(self, text: str) -> int:
        """Write a text as far as the stream takes it; see `lost`."""
        self._try(lambda: super(OutputStream, self).write(text))
        return len(text)

    def flush(self) -> None:
        """Write what is kept back; see `lost`."""
        self._try(super().flush)

    def _try(self, act: Callable[[], object]) -> None:
        try:
            act()
        except OSError as error:
            self.lost = error
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.fileno())  # takes what is left in the buffer, which would fail again at the exit
            os.close(nowhere)
            if self._raises:
                raise OutputLost from None


def take_streams() -> tuple[OutputStream, OutputStream]:
    """Make stdout and stderr of this process an Output each."""
    for descriptor, way in DESCRIPTORS.items():
        try:
            os.fstat(descriptor)
        except OSError:  # closed: else the next file to be opened gets its number, and what is said ends in that file
            os.set_inheritable(os.open(os.devnull, way), True)
    out, err = OutputStream(1, sys.stdout, raises=True), OutputStream(2, sys.stderr, raises=False)
    sys.stdout, sys.stderr = out, err
    return out, err


def closing_code(code: int, out: OutputStream, err: OutputStream, only_json: bool) -> int:
    """The exit code of a command that ended with `code`; a stream that was not written is reported on the other.

    only_json: stdout is for one JSON document alone. A code that is not 0 stands: it says more.
    """
    reasons = {name: output.lost.errno for name, output in (("stdout", out), ("stderr", err)) if output.lost}
    if not reasons:
        return code
    if set(reasons.values()) == {errno.EPIPE}:
        return code or UNREAD
    text = "".join(f"frb: {name} cannot be written: {os.strerror(reason or 0)}.\n" for name, reason in reasons.items())
    if "stderr" not in reasons:
        err.write(text)
    elif not only_json:
        with suppress(OutputLost):
            out.write(text)
            out.flush()
    return code or LOST
