"""stdout and stderr of this process, which may be full, closed, or pipes without a reader.

A stream that cannot be written is remembered: the command continues its work, and `frbcli.cli.process` reports it at
the end. Imports nothing but the standard library.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import TextIO

DESCRIPTORS = {0: os.O_WRONLY, 1: os.O_RDONLY, 2: os.O_RDONLY}  # the wrong way round: to use them fails
LOST = 1  # exit code of a command whose stdout or stderr takes no more
UNREAD = 141  # 128 + SIGPIPE, as a shell reports other programs whose reader is gone


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
