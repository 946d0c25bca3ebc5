"""Which part of a long search a night tries: after as many nights as it has parts, all has been tried; and the
processes that try it.

FRB_NIGHT is the number of the night, else the day it is; `.ci/nightly` tells it, so that what it found is found again.
"""

import os
import resource
import subprocess
import sys
import time
from pathlib import Path

from paths import ROOT

NIGHT = int(os.environ.get("FRB_NIGHT") or time.time() // 86400)


def seeds_tonight(seeds: range, nights: int) -> range:
    """One of `nights` equal parts of some seeds."""
    count = len(seeds) // nights
    first = NIGHT % nights * count
    return seeds[first : first + count]


def pairs_tonight(rows: int, columns: int) -> list[int]:
    """Numbers column * rows + row: each row with another column, which all change from night to night, so that in as
    many nights as there are columns all rows meet all columns."""
    return [(row + NIGHT) % columns * rows + row for row in range(rows)]


BATCH_s = 1800.0  # of the clock, for what hangs: what takes long is told by its CPU time
MEMORY_B = 4 * 1024**3


def _limited() -> None:
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_B, MEMORY_B))


def printed(*words: str, limited: bool = False) -> list[str]:
    """The lines that Python prints in a process that finds this folder. limited: in MEMORY_B, with warnings as
    errors."""
    path = os.pathsep.join([str(ROOT), str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, *(("-W", "error") if limited else ()), *words], capture_output=True, text=True, check=False,
        timeout=BATCH_s, preexec_fn=_limited if limited else None,
        env=os.environ | {"PYTHONPATH": path, "MPLBACKEND": "Agg"},
    )  # fmt: skip
    assert done.returncode == 0, f"after {done.stdout[-300:]}: {done.returncode}\n{done.stderr[-3000:]}"
    return done.stdout.splitlines()
