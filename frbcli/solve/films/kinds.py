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
from numba.extending import overload

from frbcli.compiled import AS_KERNELS
from frbcli.film.cells.data import VolumeFilms
from frbcli.film.cells.tilted.data import TiltedVolumes

NONE, TABLES, CELLS, TILTED = "none", "tables", "cells", "tilted"
_KINDS = {VolumeFilms: CELLS, TiltedVolumes: TILTED}


def kind_of(films: Any) -> str:
    """The kind of films, or of a type of films that the compiler knows."""
    if isinstance(films, types.BaseTuple) and not isinstance(films, types.BaseNamedTuple) and len(films) == 0:
        return NONE
    return _KINDS.get(getattr(films, "instance_class", type(films)), TABLES)


def by_kind(
    question: Callable[..., Any], *, others: Callable[..., Any], inline: bool = False, **answers: Callable[..., Any]
) -> None:
    """A question that kernels ask the films, its argument `films`, is compiled as the answer of their kind: that under
    the name of the kind, else `others`. inline: the answer is put into the functions that ask."""
    at = list(inspect.signature(question).parameters).index("films")
    how: dict[str, Any] = {"jit_options": AS_KERNELS} | ({"inline": "always"} if inline else {})

    def answer(*given: Any) -> Callable[..., Any]:
        return answers.get(kind_of(given[at]), others)

    overload(question, strict=False, **how)(answer)
