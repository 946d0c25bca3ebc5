"""What a person at a terminal sees of a command, with the moments at which it changes."""

import os
import pty
import re
import select
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

CODES = re.compile(rb"\x1b\[[0-9;?]*[A-Za-z]|\r|\n")  # move the cursor, set colours
ROOM_B = 65536
# Runs `frb` with the code in the first argument before it.
FRB = "import sys; exec(sys.argv.pop(1)); from frbcli.cli.process import main; main()"


@dataclass(frozen=True)
class Seen:
    """code: exit code; first_s: when something was on the screen; silent_s: the longest time from then on in which
    nothing new was there; text: all that was; silent_after: what was on the screen for the longest."""

    code: int
    first_s: float
    silent_s: float
    text: str
    silent_after: str = ""


def seen(arguments: Sequence[str], before: str = "", environment: Mapping[str, str] | None = None) -> Seen:
    """Run `frb` on a terminal. before: Python code that runs first; environment: variables to add."""
    screen, end = pty.openpty()
    variables = {**os.environ, "TERM": "xterm", "COLUMNS": "100", **(environment or {})}
    process = subprocess.Popen(
        [sys.executable, "-c", FRB, before, *arguments], stdin=end, stdout=end, stderr=end, env=variables
    )
    os.close(end)
    began = time.monotonic()
    last, silent, first, shown, text, longest = began, 0.0, None, b"", b"", b""
    while chunk := _next(screen):
        new = CODES.sub(b"", chunk)
        if new.strip() and new != shown:  # what is drawn again as it was tells nothing
            now = time.monotonic()
            if first is None:
                first = last = now
            if now - last > silent:
                silent, longest = now - last, shown
            last, shown = now, new
        text += chunk
    code = process.wait()
    os.close(screen)
    if time.monotonic() - last > silent:
        silent, longest = time.monotonic() - last, shown
    all_text = CODES.sub(b"\n", text).decode("utf-8", "replace")
    return Seen(code, (last if first is None else first) - began, silent, all_text, longest.decode("utf-8", "replace"))


def _next(screen: int) -> bytes:
    """What comes next; nothing at the end, which Linux calls an error."""
    select.select([screen], [], [])
    try:
        return os.read(screen, ROOM_B)
    except OSError:
        return b""
