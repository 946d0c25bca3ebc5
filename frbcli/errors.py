"""The errors of frb, and the names nearest to one that is not known, for the remedies of all errors.

Whatever frb raises on purpose derives from FrbError; anything else is a bug.
"""

from __future__ import annotations

import signal
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from difflib import SequenceMatcher
from typing import Self

INTERRUPTED = 130  # exit code: 128 + SIGINT
# Those that ask a process to end, so that it can keep what it has. Windows does not have the last one.
SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


def printable(text: str) -> str:
    """`text` without what a terminal would obey: control and escape characters, but for new lines, become "?"."""
    return "".join(letter if letter.isprintable() or letter == "\n" else "?" for letter in text)


class FrbError(Exception):
    """Base class. exit_code: what the command line ends with; status: the kind of the error in results."""

    exit_code = 1
    status = "error"

    @property
    def document(self) -> dict[str, object]:
        """The error in JSON."""
        return {"status": self.status, "message": str(self)}


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
    status = "input-error"

    def __init__(self, source: str, faults: tuple[Fault, ...]) -> None:
        self.source = source
        self.faults = faults
        more = f"\n  and {len(faults) - MOST_LISTED} more" if len(faults) > MOST_LISTED else ""
        super().__init__(source + "".join(f"\n  {fault}" for fault in faults[:MOST_LISTED]) + more)

    def __reduce__(self) -> tuple[type[Self], tuple[str, tuple[Fault, ...]]]:
        """For processes, which pass on how a run has ended."""
        return type(self), (self.source, self.faults)

    @property
    def document(self) -> dict[str, object]:
        """The error in JSON, fault by fault."""
        return {"status": self.status, "source": self.source, "faults": [asdict(fault) for fault in self.faults]}


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
    status = "not-converged"


class FilmUnsolved(NotConverged):
    """A film found no solution; says what happened. What to change depends on the case, which a film does not know:
    `frbcli.scene.supply.advised` adds it."""


class OutOfMemory(FrbError):
    """The process may not use as much memory as it needs."""


ALIKE = 0.6  # share of letters in common, from which two names are alike
SPREAD = 0.15  # below the most alike name, others are not named
MOST = 3  # names of a remedy
FEW = 12  # names that are listed whole where none is alike


def nearest(name: str, known: Iterable[str], most: int = MOST, alike: float = ALIKE) -> tuple[str, ...]:
    """The known names most like `name`, the most alike first: that hold it or are held in it, or are spelled alike."""
    wanted = name.strip().lower()
    if not wanted:
        return ()
    scores = {each: _score(wanted, each.lower()) for each in dict.fromkeys(known)}
    least = max(alike, max(scores.values(), default=0.0) - SPREAD)
    close = sorted((each for each, score in scores.items() if score >= least), key=lambda each: -scores[each])
    return tuple(close[:most])


def did_you_mean(name: str, known: Iterable[str], listed_by: str = "", alike: float = ALIKE) -> str:
    """A remedy for an unknown name: the nearest names, else all of a few, else the first of many.

    listed_by: a sentence that says where all names are listed, for many of them.
    """
    names = list(dict.fromkeys(known))
    close = nearest(name, names, alike=alike)
    if close:
        return f"Did you mean {_either(close)}?"
    if len(names) > FEW and listed_by:
        return listed_by
    more = f" and {len(names) - FEW} more" if len(names) > FEW else ""
    return f"There are: {', '.join(names[:FEW])}{more}." if names else listed_by


def _score(wanted: str, known: str) -> float:
    """1 for the same letters, at least ALIKE where one is a part of the other, else the share in common."""
    shorter, longer = sorted((wanted, known), key=len)
    spelled = SequenceMatcher(None, wanted, known).ratio()
    part = len(shorter) > 2 and shorter in longer  # letters alone are parts of everything
    return ALIKE + (1.0 - ALIKE) * len(shorter) / len(longer) if part else spelled


def _either(names: Iterable[str]) -> str:
    *others, last = (f'"{name}"' for name in names)
    return f"{', '.join(others)} or {last}" if others else last
