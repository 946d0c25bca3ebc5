"""Which part of a long search a night tries: after as many nights as it has parts, all has been tried.

FRB_NIGHT is the number of the night, else the day it is; `.ci/nightly` tells it, so that what it found is found again.
"""

from __future__ import annotations

import os
import time

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
