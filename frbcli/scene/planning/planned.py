"""A plan, and the choices that it is made of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from frbcli.film.grid import Mesh
from frbcli.html import html_table

if TYPE_CHECKING:
    from frbcli.scene.forms.form import FilmForm


@dataclass(frozen=True)
class Decision:
    """One choice of the plan: what was chosen, and why."""

    choice: str
    value: str
    reason: str


@dataclass(frozen=True, repr=False)
class Plan:
    """What will be modelled. theory: "short" | "finite"; cavitation: of films that name
    none of their own; form: how the most expensive film is computed; mesh: the finest mesh of elements; films: form and
    mesh of each film on quadratic elements; cells: (around, along) of finite-volume films, None for other films;
    film_error: expected relative error of the forces; method: name of a time integration method; tolerance: local error
    of a displacement over the clearance; steps_per_revolution: at least; coupling: one of COUPLINGS; macro_step:
    longest one in s of a co-simulation, else None; length: m, instead of the clearance for machines without films, see
    reference_length.py; eccentricity: that the cells are chosen for, see FilmChoice; edged: whether finite-volume films
    have the edge of their cavity within cells, see VolumeFilm: at rest alone."""

    theory: str
    cavitation: str
    form: FilmForm
    mesh: Mesh
    films: tuple[tuple[FilmForm, Mesh], ...]
    cells: tuple[int, int] | None
    film_error: float
    method: str
    tolerance: float
    steps_per_revolution: float
    coupling: str
    macro_step: float | None
    decisions: tuple[Decision, ...]
    length: float = 0.0
    eccentricity: float | None = None
    edged: bool = False

    def __repr__(self) -> str:
        """Its choices, one on a line."""
        return "\n".join(["Plan", *(f"{each.choice}: {each.value}" for each in self.decisions)])

    def _repr_html_(self) -> str:
        """In a notebook: its decisions."""
        rows = [(each.choice, each.value, each.reason) for each in self.decisions]
        return html_table("plan", ("choice", "value", "reason"), rows, len(rows))
