"""Progress on the terminal: lines that are redrawn, or without a terminal one now and then; the compilation of kernels.

Kernels are compiled at the first start and kept next to their sources.

The picture and the table of a command: their options, their places, which are checked before the work, and how they
are written. A picture next to results never affects them: a failure is a remark.
"""

from __future__ import annotations

import math
import re
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from frbcli.cli.common import WIDTH, Terminal, console
from frbcli.cli.options import CSV_FILE, OUTPUT, check_outputs, force_option, forced, gathered, look_options
from frbcli.errors import InputError
from frbcli.units import HERTZ, SpeedUnit

if TYPE_CHECKING:
    from rich.text import Text

    from frbcli.case.schema import Case
    from frbcli.columns import Tabular
    from frbcli.plot.style import Picture
    from frbcli.results.write import Kind
    from frbcli.runs.march import Progress
    from frbcli.scene.cost import Kernels


REFRESH_Hz = 8
PRINT_EVERY_s = 30.0  # CPU time between two lines of progress where there is no terminal
# A long command is announced there as soon as its first numbers show it: after so much time, if so much is left.
ANNOUNCED_s, LONG_s = 1.0, 5.0
COMPUTING, READING, WRITING = "Computing.", "Reading.", "Writing."
CLOCK_AFTER_s = 1.0  # without a change the time is shown
LONGEST_LEFT_s = 1e9  # longest time that is shown
MOST_STEPS = 1e6  # per revolution, likewise
COMPILING_EVERY_s = 10.0  # between two lines of the compilation where there is no terminal
# A little work of the kind that compiling is, and the CPU time in s that it took where compile_s was measured.
PIECES, REPEATED, REFERENCE_s = 40, 10, 6.5e-3
TRIALS = 5


class Display:
    """The lines of progress of a command.

    draw: redraws lines on the terminal, None without one.
    """

    def __init__(self, terminal: Terminal, draw: Callable[[str], None] | None = None) -> None:
        self._terminal, self._draw = terminal, draw

    @property
    def speeds(self) -> SpeedUnit:
        """The unit of rotor speeds."""
        return self._terminal.speeds

    @property
    def redraws(self) -> bool:
        """Whether there is a terminal on which lines are redrawn."""
        return self._draw is not None

    def redraw(self, lines: str) -> None:
        """Show lines instead of the last ones, where that is possible."""
        if self._draw is not None:
            self._draw(lines)

    def line(self, line: str) -> None:
        """Show a line instead of the last one, or print it."""
        if self._draw is None:
            self._terminal.remark(line)
        else:
            self._draw(line)

    def now_and_then(self) -> NowAndThen:
        """A function that redraws lines; without a terminal it prints them as one line, every PRINT_EVERY_s."""
        return NowAndThen(self)

    def counting(self, what: str = "") -> Callable[[int, int], None]:
        """A function that shows a number of so many that are done, and the time left.

        The time left is extrapolated from the numbers after the first one, which includes compilation. The last
        number is shown on a terminal only: nothing is left to wait for.
        """
        begun, first, announced, show = 0.0, 0, False, self.now_and_then()

        def observe(number: int, count: int) -> None:
            nonlocal begun, first, announced
            if begun == 0.0:
                begun, first = time.monotonic(), number
            done, spent = number - first, time.monotonic() - begun
            left = spent / done * (count - number) if done else 0.0
            if number == count and not self.redraws:
                return
            long = not announced and spent > ANNOUNCED_s and left > LONG_s
            written = show(f"{what}{number} of {count}" + (f"  {_clock(left)} left" if done else ""), at_once=long)
            announced = announced or written

        return observe

    def of_runs(self) -> Callable[[str, int, int, Progress], None]:
        """A function that shows the progress of one of several runs: its name, its number, how many, its progress."""
        show = self.now_and_then()

        def observe(name: str, number: int, count: int, progress: Progress) -> None:
            show(f"{number} of {count}: {name}\n{progress_line(progress, self.speeds)}")

        return observe


class NowAndThen:
    """Shows lines of progress on a display; without a terminal only now and then, see PRINT_EVERY_s."""

    def __init__(self, display: Display) -> None:
        self._display, self._printed_s = display, time.process_time()

    def __call__(self, lines: str, at_once: bool = False) -> bool:
        """Show lines; returns whether they were shown. at_once: also without a terminal."""
        if self._display.redraws:
            self._display.redraw(lines)
            return True
        if not at_once and time.process_time() <= self._printed_s + PRINT_EVERY_s:
            return False
        self._printed_s = time.process_time()
        self._display.line(lines.replace("\n", ": "))
        return True


class _Lines:
    """Lines, and below them the time since they last changed once that is CLOCK_AFTER_s: redrawn by the clock, they
    show that work goes on, also where it cannot be counted."""

    def __init__(self, lines: str) -> None:
        self._lines, self._since = lines, time.monotonic()

    def change(self, lines: str) -> None:
        """Show other lines."""
        self._lines, self._since = lines, time.monotonic()

    def __rich__(self) -> Text:
        from rich.text import Text

        waited = time.monotonic() - self._since
        clock = f"\n{waited:.0f} s so far" if waited >= CLOCK_AFTER_s else ""
        return Text(self._lines + clock, no_wrap=True, overflow="ellipsis")


@contextmanager
def display(terminal: Terminal, lines: str = COMPUTING) -> Iterator[Display]:
    """A display on the terminal, whose lines vanish at the end; lines: what is shown there first."""
    if not terminal.live:
        yield Display(terminal)
        return
    from rich.live import Live

    shown = _Lines(lines)
    with Live(shown, console=console(sys.stderr), refresh_per_second=REFRESH_Hz, transient=True):
        yield Display(terminal, shown.change)


@contextmanager
def computing(
    terminal: Terminal, case: Case, also: Iterable[Case] = (), kernels: Kernels = "loop"
) -> Iterator[Display]:
    """A display that also shows the progress of the compilation; case, also: what is computed; kernels: see
    compile_s."""
    with display(terminal) as shown, compilation_shown(shown, case, also, kernels):
        yield shown


@contextmanager
def drawing(terminal: Terminal) -> Iterator[None]:
    """A display while a picture or a page is made."""
    with display(terminal, "Drawing."):
        yield


@contextmanager
def compilation_shown(
    shown: Display, case: Case, also: Iterable[Case] = (), kernels: Kernels = "loop"
) -> Iterator[None]:
    """Within it, a display shows the progress of the compilation; case, also, kernels: see `computing`."""
    from frbcli.compiled import counted
    from frbcli.scene.cost import compile_s

    shown_s, expected_s, about = 0.0, 0.0, ""

    def observe() -> None:
        nonlocal shown_s, expected_s, about
        now = time.monotonic()
        if shown_s == 0.0:
            from frbcli.solve.time_loop import some_are_kept

            most = "at most " if some_are_kept() else ""  # of which this machine needs some, maybe
            expected_s = compile_s([case, *also], kernels) * slowness()
            about = f"{most}about {expected_s:.0f} s"
            shown_s = now
            shown.line(f"Compiling the kernels, once: {about} of CPU time.")
        elif compilations.functions and (shown.redraws or now - shown_s > COMPILING_EVERY_s):
            shown_s = now
            line = f"Compiling the kernels, once: {compilations.functions} functions"
            of = f"of {about}" if compilations.spent_s <= expected_s else "of CPU time, longer than expected"
            shown.line(f"{line}, {compilations.spent_s:.0f} s {of}.")

    with counted(observe) as compilations:
        yield


def slowness() -> float:
    """CPU time of a little work over that on the reference machine: a compilation takes so much longer, since both
    are work of the interpreter, and both are slower where other processes share the core."""
    lines = "\n".join(f"    c{i} = a[{i}] + b * {i}.0 if a else (b, {i})" for i in range(PIECES))
    text, spent = f"def f(a, b):\n{lines}\n    return c1\n", []
    for _ in range(TRIALS):
        began = time.process_time()
        for _ in range(REPEATED):
            compile(text, "work", "exec")
        spent.append(time.process_time() - began)
    return sorted(spent)[TRIALS // 2] / REFERENCE_s


def progress_line(progress: Progress, unit: SpeedUnit = HERTZ) -> str:
    """One line of at most WIDTH columns: time, speed in a unit, eccentricity, steps per revolution, time left."""
    known = progress.steps_per_revolution < MOST_STEPS  # a rotor that has hardly begun to turn has no such number
    per_turn = f"{progress.steps_per_revolution:.3g}" if known else "-"
    whose = "its error: " if progress.for_error else ""
    eps = "" if math.isnan(progress.eccentricity) else f"eps {progress.eccentricity:5.3f}  "
    line = (
        f"{whose}{progress.t_s:.3f}/{progress.end_s:.4g} s  {unit.words(progress.speed_Hz, 1):>8}  "
        f"{eps}{per_turn} steps/rev  {_clock(progress.left_s)} left"
    )
    return line if len(line) <= WIDTH else line[: WIDTH - 1] + "…"


def _clock(seconds: float) -> str:
    """Minutes and seconds, hours or days: what fits in six columns."""
    if not 0.0 <= seconds < LONGEST_LEFT_s:
        return "?"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 100:
        return f"{minutes}:{rest:02d}"
    return f"{minutes // 60} h" if minutes < 6000 else f"{minutes // 1440} d"


Function = TypeVar("Function", bound=Callable[..., object])

MISSING = re.compile(r"Glyph (\d+) .*missing from")  # how matplotlib begins its warning of a letter


@dataclass(frozen=True)
class Outputs:
    """The picture and the table that a command writes in addition to its text, None for none."""

    picture: Path | None
    csv: Path | None

    def write(
        self, terminal: Terminal, table: Tabular, what: str = "picture", picture: Callable[[], Picture] | None = None
    ) -> dict[str, Path | None]:
        """Write picture and table of a result, and return their paths as parts of a JSON document. what: the name of
        the picture in the text; picture: drawn instead of the picture of the table."""
        if self.csv is not None:
            from frbcli.results.write import write_table

            write_table(table.to_pandas(), self.csv, forced())
            terminal.result(f"table: {self.csv}")
        if self.picture is None:
            return {"picture": None, "csv": self.csv}
        return {"picture": draw(terminal, picture or partial(picture_of, table), self.picture, what), "csv": self.csv}


def picture_of(result: object) -> Picture:
    """The picture of a result. Raises InputError where there is none. What draws is imported here."""
    from frbcli.plot.picture import picture

    return picture(result)


@dataclass(frozen=True)
class OutputOptions:
    """The options -o, --picture and --csv of a command."""

    output: Path | None
    picture: bool
    csv: Path | None

    def check(self, default: Path, *others: tuple[Path | None, Kind]) -> Outputs:
        """The places of picture and table, default: of the picture. Raises UsageError or InputError, before the work,
        if these files, or others that the command writes, cannot be written."""
        from frbcli.results.write import TABLES

        if self.output is not None and not self.picture:
            raise click.UsageError("-o names the picture that --no-picture leaves out.")
        picture = self.output or default if self.picture else None
        check_outputs((self.csv, TABLES["csv"]), *others, picture=picture)
        return Outputs(picture, self.csv)


def picture_option(default: str) -> Callable[[Function], Function]:
    """Give a command the option -o, the file of its picture; default: its name, for the help."""
    words = "Picture as PNG, PDF or SVG."
    return click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, show_default=default, help=words)


picture_switch = click.option("--picture/--no-picture", default=True, show_default=True, help="Draw a picture or not.")
csv_option = click.option("--csv", metavar="FILE.csv", type=CSV_FILE, help="Write the table of all results, too.")


def outputs_options(default: str) -> Callable[[Function], Function]:
    """Give a command -o, --picture, --csv, --force and the options of the look; it receives `outputs`, which are
    OutputOptions."""
    def decorated(function: Function) -> Function:
        gathering = gathered("outputs", OutputOptions)(function)
        return picture_option(default)(picture_switch(csv_option(force_option()(look_options(gathering)))))

    return decorated


def draw(terminal: Terminal, picture: Callable[[], Picture], target: Path, what: str = "picture") -> Path | None:
    """Draw a picture of printed results. None if that fails, with the reason as a remark."""
    try:
        return draw_wanted(terminal, picture, target, what)
    except InputError as error:
        reason = " ".join(f"{fault.problem} {fault.remedy}" for fault in error.faults)
    except Exception as error:  # of the fonts, of the memory, of matplotlib: the results stand without a picture
        reason = f"{type(error).__name__}: {error}"
    terminal.remark(f"No picture {target}: {_one_line(reason)}")
    return None


def draw_wanted(terminal: Terminal, picture: Callable[[], Picture], target: Path, what: str = "picture") -> Path:
    """Draw the picture that a command is for. Raises InputError if it cannot be written."""
    look = terminal.look
    with drawing(terminal), warnings.catch_warnings(record=True) as caught:
        from frbcli.plot.picture import fit
        from frbcli.plot.style import save_figure

        warnings.filterwarnings("always", message="Glyph")
        figure = fit(picture(), look.size_in, look.x_limits, look.y_limits, look.rpm)
        save_figure(figure, target, look.dpi, forced())
    terminal.result(f"{what}: {target}")
    texts = [str(warning.message) for warning in caught]
    letters = dict.fromkeys(chr(int(match[1])) for match in map(MISSING.match, texts) if match)
    if letters:
        shown = ", ".join(letter if letter.isprintable() else repr(letter) for letter in letters)
        terminal.remark(f"{target}: the font has no {shown}; boxes are drawn instead.")
    for text in dict.fromkeys(text for text in texts if not MISSING.match(text)):
        terminal.remark(f"{target}: {_one_line(text)}")
    return target


def _one_line(text: str) -> str:
    return " ".join(text.split())
