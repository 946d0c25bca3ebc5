"""The errors of frb. Whatever frb raises on purpose derives from FrbError; anything else is a bug."""

from __future__ import annotations

from dataclasses import dataclass

INTERRUPTED = 130  # exit code: 128 + SIGINT


def printable(text: str) -> str:
    """`text` without what a terminal would obey: control and escape characters, but for new lines, become "?"."""
    return "".join(letter if letter.isprintable() or letter == "\n" else "?" for letter in text)


class FrbError(Exception):
    """Base class. `exit_code` is what the command line ends with."""

    exit_code = 1


@dataclass(frozen=True)
class Fault:
    """One fault of an input.

    key: dotted path of the key, e.g. "bearing.clearance"; value: what was found, as text; line: 1-based line in the
    case file, or None where the key comes from --set or is absent; problem: what is wrong; remedy: what to write.
    """

    key: str
    value: str
    line: int | None
    problem: str
    remedy: str

    def __str__(self) -> str:
        where = "" if self.line is None else f" (line {self.line})"
        value = "" if self.value == "" else f" = {self.value}"
        return f"{self.key}{value}{where}: {self.problem} {self.remedy}".rstrip()


MOST_LISTED = 100  # faults in the text of an error


class InputError(FrbError):
    """The input is wrong. Carries every fault found, and names the first of them; nothing was run."""

    exit_code = 2

    def __init__(self, source: str, faults: tuple[Fault, ...]) -> None:
        self.source = source
        self.faults = faults
        more = f"\n  and {len(faults) - MOST_LISTED} more" if len(faults) > MOST_LISTED else ""
        super().__init__(source + "".join(f"\n  {fault}" for fault in faults[:MOST_LISTED]) + more)


def input_error(source: str, key: str, value: str, problem: str, remedy: str, line: int | None = None) -> InputError:
    """The error of an input with one fault."""
    return InputError(source, (Fault(key, value, line, problem, remedy),))


class FrozenError(InputError, ValueError):
    """A part of a case was to be changed in place, or copied with changes that are not checked."""


class RunFileError(InputError):
    """A run file cannot be read or does not hold what is asked of it."""


class NotConverged(FrbError):
    """A numerical method found no solution; says what was tried and what to change."""

    exit_code = 3


class FilmUnsolved(NotConverged):
    """A film found no solution; says what happened. What to change depends on the case, which a film does not know:
    `frbcli.scene.remedies.advised` adds it."""


class OutOfMemory(FrbError):
    """The process may not use as much memory as it needs."""
