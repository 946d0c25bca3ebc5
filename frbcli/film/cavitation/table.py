"""The table of the cavitation laws: one row each. All else about a law is in its own file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields, is_dataclass

from frbcli.film.cavitation.barotropic import Barotropic
from frbcli.film.cavitation.bubbly import Bubbly
from frbcli.film.cavitation.elrod import Elrod
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.peeken import Peeken
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cavitation.reynolds import Reynolds
from frbcli.film.cavitation.sommerfeld import HalfSommerfeld, Sommerfeld
from frbcli.film.cavitation.two_phase import TwoPhase

SHIPPED: tuple[type[Law], ...] = (
    Sommerfeld,
    HalfSommerfeld,
    Reynolds,
    Penalty,
    Peeken,
    Elrod,
    TwoPhase,
    Barotropic,
    Bubbly,
)
LARGEST_PARAMETERS = 8  # of a law, as the compiled films keep them
_own: dict[str, type[Law]] = {}  # those that a user has added in this process


def laws() -> tuple[type[Law], ...]:
    """All laws, the shipped ones first."""
    return (*SHIPPED, *_own.values())


def names(of: Iterable[type[Law]] | None = None) -> tuple[str, ...]:
    """The names of all laws, or of those given."""
    return tuple(law.name for law in (laws() if of is None else of))


def law_named(name: str) -> type[Law]:
    """The law of this name. Raises KeyError, which says the names that there are."""
    for law in laws():
        if law.name == name:
            return law
    raise KeyError(f"there is no cavitation law {name!r}; there are {', '.join(names())}")


def label_of(name: str) -> str:
    """The law as pictures call it; one that a run names and this process does not know by its name."""
    return next((law.label for law in laws() if law.name == name), name)


def add(law: type[Law]) -> None:
    """Add a row, or replace one that was added before. Raises ValueError if it is no law."""
    if not (is_dataclass(law) and issubclass(law, Law)):
        raise ValueError(f"{law!r} is no frozen dataclass derived from CavitationLaw")
    missing = [word for word in ("name", "label") if not isinstance(getattr(law, word, None), str)]
    if missing:
        raise ValueError(f"{law.__name__} does not declare {' and '.join(missing)}")
    if law.name in names(SHIPPED):
        raise ValueError(f"{law.__name__} has the name of a shipped law, {law.name}; choose another one")
    if law.cell is Law.cell:
        raise ValueError(f"{law.__name__} has no `cell`, the function that a film is solved with")
    if len(fields(law)) > LARGEST_PARAMETERS:
        raise ValueError(f"{law.__name__} has {len(fields(law))} fields; a law has {LARGEST_PARAMETERS} at most")
    _own[law.name] = law


def remove(name: str) -> None:
    """Take a row out that was added. Raises KeyError for one that was not."""
    del _own[name]
