"""The names nearest to one that is not known, for the remedies of all errors."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import SequenceMatcher

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
