"""Progress of a run, redrawn on the terminal."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from frbcli.cli.common import Terminal

if TYPE_CHECKING:
    from frbcli.runs.march import Progress

REFRESH_Hz = 8
COLUMNS = 80  # of a terminal
TOLD_EVERY_s = 30.0  # CPU time between two lines of progress where there is no terminal
# What takes long is announced there as soon as the first numbers tell: after so much time, if so much is left.
ANNOUNCED_s, LONG_s = 1.0, 5.0
LONGEST_LEFT_s = 1e9  # longest time that is shown


@contextmanager
def live_lines(terminal: Terminal) -> Iterator[Callable[[str], None] | None]:
    """Redraws some lines on the terminal; None without a terminal."""
    if not terminal.live:
        yield None
        return
    from rich.live import Live
    from rich.text import Text

    with Live(console=terminal.live_console(), refresh_per_second=REFRESH_Hz, transient=True) as live:
        yield lambda lines: live.update(Text(lines, no_wrap=True, overflow="ellipsis"))


def counting(terminal: Terminal, show: Callable[[str], None] | None, what: str = "") -> Callable[[int, int], None]:
    """What shows a number of so many, and the time left: by `show`, or without it as a line every now and then.

    The time left is that of the numbers since the first one, which compiles.
    """
    begun, told_s, first, announced = 0.0, time.process_time(), 0, False

    def observe(number: int, count: int) -> None:
        nonlocal begun, told_s, first, announced
        if begun == 0.0:
            begun, first = time.monotonic(), number
        done, spent = number - first, time.monotonic() - begun
        left = spent / done * (count - number) if done else 0.0
        line = f"{what}{number} of {count}" + (f"  {_clock(left)} left" if done else "")
        long = not announced and spent > ANNOUNCED_s and left > LONG_s
        if show is not None:
            show(line)
        elif long or time.process_time() > told_s + TOLD_EVERY_s:
            told_s, announced = time.process_time(), True
            terminal.remark(line)

    return observe


def of_runs(
    terminal: Terminal, show: Callable[[str], None] | None
) -> Callable[[str, int, int, Progress], None]:
    """What shows the progress of one of several runs, as `counting` does: name, number, how many, progress."""
    told_s = time.process_time()

    def observe(name: str, number: int, count: int, progress: Progress) -> None:
        nonlocal told_s
        lines = f"{number} of {count}: {name}\n{progress_line(progress)}"
        if show is not None:
            show(lines)
        elif time.process_time() > told_s + TOLD_EVERY_s:
            told_s = time.process_time()
            terminal.remark(lines.replace("\n", ": "))

    return observe


def progress_line(progress: Progress) -> str:
    """One line of at most 80 columns: time, speed, eccentricity, steps per revolution, pace, time left."""
    per_turn = f"{progress.steps_per_revolution:.3g}" if math.isfinite(progress.steps_per_revolution) else "-"
    whose, pace = ("its error: ", "") if progress.for_error else ("", f"{progress.simulated_ms_per_hour:.2g} ms/h  ")
    eps = "" if math.isnan(progress.eccentricity) else f"eps {progress.eccentricity:5.3f}  "
    line = (
        f"{whose}{progress.t_s:.3f}/{progress.end_s:.4g} s  {progress.speed_Hz:5.1f} Hz  "
        f"{eps}{per_turn} steps/rev  {pace}{_clock(progress.left_s)} left"
    )
    return line if len(line) <= COLUMNS else line[: COLUMNS - 1] + "…"


def _clock(seconds: float) -> str:
    """Minutes and seconds, hours or days: what fits in six columns."""
    if not 0.0 <= seconds < LONGEST_LEFT_s:
        return "?"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 100:
        return f"{minutes}:{rest:02d}"
    return f"{minutes // 60} h" if minutes < 6000 else f"{minutes // 1440} d"
