"""Too little memory: reported in one line, whatever error a library raises.

Where a process may use little memory (`ulimit -v`), libraries do not load, the compiler aborts, and linear algebra
waits forever for its buffers. So too small a limit is reported before any of them is loaded; what happens later, with
an error of a library's own kind, is reported after it.
"""

from __future__ import annotations

import math
import os

from frbcli.errors import OutOfMemory

try:
    import resource
except ImportError:  # Windows has no such limits
    resource = None  # type: ignore[assignment]

# Bytes of addresses that a usual run takes, and some more; each thread of linear algebra has buffers of its own.
USUAL, PER_THREAD = 900_000_000, 50_000_000
SUSPECT = 2.0  # times as much, below which an error of another kind may have come from too little memory
RESERVE = 32_000_000  # bytes that are freed for the error message
LONGEST_REASON = 150  # characters


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
