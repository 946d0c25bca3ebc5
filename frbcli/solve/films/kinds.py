"""Which kind of films the time loop has: asked here alone, by the types of the films, when the loop is compiled.

- none at all, an empty tuple;
- a tuple of FilmData, one per film: force and derivatives follow from where the journal is and how it moves;
- VolumeFilms, all films together: cells with unknowns of their own, see cells.py;
- TiltedVolumes, all films together, each of which the loop sees at both ends of its bearing, see tilted.py.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from numba import types

from frbcli.compiled import Kernel, by_types, type_of
from frbcli.film.cells.data import VolumeFilms
from frbcli.film.cells.tilted.data import TiltedVolumes

NONE, TABLES, CELLS, TILTED = "none", "tables", "cells", "tilted"
_KINDS = {VolumeFilms: CELLS, TiltedVolumes: TILTED}


def kind_of(films: Any) -> str:
    """The kind of films, or of a type of films that the compiler knows."""
    if isinstance(films, tuple | types.BaseTuple) and len(films) == 0:
        return NONE
    return _KINDS.get(type_of(films), TABLES)


def by_kind(inline: bool = False, **answers: Callable[..., Any]) -> Callable[[Kernel], Kernel]:
    """Decorates a question that kernels ask the films, its argument `films`: it is compiled as the answer of their
    kind, that under the name of the kind, else as it stands. inline: the answer is put into the functions that ask."""

    def decorated(question: Kernel) -> Kernel:
        at = list(inspect.signature(question).parameters).index("films")
        return by_types(lambda *given: answers.get(kind_of(given[at])), inline)(question)

    return decorated
