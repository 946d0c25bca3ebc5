"""The one film of a machine in the published two-phase form, on quadratic elements."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from frbcli.errors import NotConverged
from frbcli.film.cells.motion import Motion
from frbcli.film.grid import Array
from frbcli.film.kinds.contract import Compared, Films
from frbcli.film.published.data import BOOKS, CAME, HELD, LEFT, ElementFilm
from frbcli.film.published.equations.unknown import unknowns_of
from frbcli.film.published.film import PublishedFilm, published_force
from frbcli.film.published.moving import oil_held
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.state import NOW, OIL, PASSED, W_BEFORE, WET, W

COMPARED = 6  # states of a run, where a steady film takes hundreds of assemblies
RICHARDSON = 3.0  # an error of second order on twice the elements, from the difference to it


@dataclass(frozen=True)
class ElementFilms(Films):
    """film: the film; data: the same for the time loop."""

    film: PublishedFilm
    data: ElementFilm

    samples: ClassVar[int] = 192
    reach: ClassVar[float] = 3.0  # as of cells

    @property
    def loop(self) -> Any:
        """The film as the time loop takes it."""
        return self.data

    @property
    def remembering(self) -> tuple[bool, ...]:
        return (True,)

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        return published_force(self.film, place, rate, total)

    @property
    def compared_states(self) -> int:
        return COMPARED

    def compared(self) -> Compared:
        """See Films.compared: extrapolated from half as many elements each way."""

        coarse = self.film.coarser()

        def forces(_: int, place: Array, rate: Array, total: float) -> tuple[Array, Array]:
            fine = published_force(self.film, place, rate, total).force
            difference = published_force(coarse, place, rate, total).force - fine
            return fine, fine + difference / RICHARDSON

        return forces

    def first_state(self, places: Array, totals: Array) -> tuple[Array, Array]:
        film, data, omega = self.film, self.data, float(totals[0])
        d, state = places[0] / film.section.clearance, film.full()
        moves = bool(np.any(d != 0.0)) and omega != 0.0
        # Next to an opening of higher pressure a full film at the ambient one is none: its elements would dip below
        # p_cav.
        fixed = film.elements.fixed.reshape(film.mesh.phi.shape)
        fed = bool(np.any(film.mesh.fixed_pressure[fixed] > state.pressure.min()))
        if moves or fed:
            with contextlib.suppress(NotConverged):
                motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), omega if moves else 0.0)
                state = film.steady(motion).state
        wet, flows = np.zeros((WET, 1, *film.mesh.nodes.shape)), np.zeros((2, 1, BOOKS))
        wet[W, 0] = wet[W_BEFORE, 0] = unknowns_of(data.unknowns, data.step, state.pressure.ravel())[film.mesh.nodes]
        wet[OIL, 0] = state.fraction
        flows[[PASSED, NOW], 0, HELD] = oil_held(data, float(d[0]), float(d[1]), state.fraction)
        return wet, flows

    def oil_defect(self, displacements: Sequence[tuple[float, float]], wet: Array, flows: Array) -> float | None:
        """Oil that the film creates, over what has passed through, or over what the full film holds if that is more."""
        full = self.data.volume * float((self.data.open_area * self.data.height).sum())
        return abs(self._created(flows)) / max(float(flows[PASSED, 0, [CAME, LEFT]].max()), full)

    def oil_passed(self, flows: Array) -> dict[str, float]:
        passed, created = flows[PASSED, 0], self._created(flows)
        return {"oil_in_m3": float(passed[CAME]), "oil_out_m3": float(passed[LEFT]), "oil_created_m3": created}

    def _created(self, flows: Array) -> float:
        """Oil in m^3 so far: what left more than came in and what the film holds more."""
        passed, now = flows[PASSED, 0], flows[NOW, 0]
        return float(passed[LEFT] - passed[CAME] + now[HELD] - passed[HELD])
