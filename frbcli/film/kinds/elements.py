"""Films in the published two-phase form, on quadratic elements, beside each other."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from frbcli.errors import NotConverged
from frbcli.film.cells.loads import CavitationFactor
from frbcli.film.cells.motion import Motion
from frbcli.film.gap import gap_height
from frbcli.film.grid import Array
from frbcli.film.kinds.cells import least_gaps
from frbcli.film.kinds.contract import Compared, Films
from frbcli.film.published.data import BOOKS, CAME, HELD, LEFT, ElementFilm
from frbcli.film.published.equations.unknown import pressures_of, unknowns_of
from frbcli.film.published.film import PublishedFilm, published_force
from frbcli.film.published.moving import oil_held
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.state import NOW, OIL, PASSED, W_BEFORE, WET, W

COMPARED = 6  # states of a run, where a steady film takes hundreds of assemblies
LEVELS = 2001  # of the pressure from none to p_cav, at which a step theta(p) is looked up
RICHARDSON = 3.0  # an error of second order on twice the elements, from the difference to it


@dataclass(frozen=True)
class ElementFilms(Films):
    """own: the films, with equal numbers of elements; data: the same for the time loop; factor: cavitation factor of
    Couette's torque."""

    own: tuple[PublishedFilm, ...]
    data: tuple[ElementFilm, ...]
    factor: CavitationFactor

    samples: ClassVar[int] = 192
    reach: ClassVar[float] = 3.0  # as of cells

    @property
    def loop(self) -> Any:
        """The films as the time loop takes them."""
        return self.data

    @property
    def remembering(self) -> tuple[bool, ...]:
        return (True,) * self.count

    @property
    def cavitation_factor(self) -> str:  # type: ignore[override]
        """See Films."""
        return self.factor

    @property
    def sheared(self) -> Array:
        return np.array([film.open_area.sum() for film in self.data]) / (2.0 * np.pi)

    def smallest_gap(self, i: int, d: Array) -> Array:
        return least_gaps(self.own[i].section, d)

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        return published_force(self.own[i], place, rate, total)

    @property
    def compared_states(self) -> int:
        return COMPARED

    def compared(self) -> Compared:
        """See Films.compared: extrapolated from half as many elements each way."""
        coarse = [film.coarser() for film in self.own]

        def forces(i: int, place: Array, rate: Array, total: float) -> tuple[Array, Array]:
            fine = published_force(self.own[i], place, rate, total).force
            difference = published_force(coarse[i], place, rate, total).force - fine
            return fine, fine + difference / RICHARDSON

        return forces

    def first_state(self, places: Array, totals: Array) -> tuple[Array, Array]:
        wet, flows = np.zeros((WET, self.count, *self.own[0].mesh.nodes.shape)), np.zeros((2, self.count, BOOKS))
        for i, (film, data) in enumerate(zip(self.own, self.data, strict=True)):
            d, state, total = places[i] / film.section.clearance, film.full(), float(totals[i])
            moves = bool(np.any(d != 0.0)) and total != 0.0
            # Next to an opening of higher pressure a full film at the ambient one is none: its elements would dip below
            # p_cav.
            fixed = film.elements.fixed.reshape(film.mesh.phi.shape)
            fed = bool(np.any(film.mesh.fixed_pressure[fixed] > state.pressure.min()))
            if moves or fed:
                with contextlib.suppress(NotConverged):
                    motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), total if moves else 0.0)
                    state = film.steady(motion).state
            wet[W, i] = wet[W_BEFORE, i] = _unknowns(film, data, state.pressure)
            wet[OIL, i] = state.fraction
            flows[[PASSED, NOW], i, HELD] = oil_held(data, float(d[0]), float(d[1]), state.fraction)
        return wet, flows

    def refill(
        self, i: int, before: Films, d: tuple[float, float], wet: Array, flows: Array
    ) -> tuple[float, float] | None:
        """See Films.refill: the pressure stays where the oil fills the gap, and the oil where there is room for it."""
        assert isinstance(before, ElementFilms)
        film, data, past, old = self.own[i], self.data[i], before.own[i], before.data[i]
        share = film.section.clearance / past.section.clearance
        here, there = Motion(d, (0.0, 0.0), 0.0), Motion((share * d[0], share * d[1]), (0.0, 0.0), 0.0)
        w = np.zeros(film.mesh.phi.size)
        w[film.mesh.nodes] = wet[W, i]
        pressure = pressures_of(old.unknowns, old.step, w)[0] * past.section.pressure_scale
        pressure = np.where(film.elements.fixed, data.unknowns.given, pressure / film.section.pressure_scale)
        # Where the oil no longer fills the gap, the pressure is that of what is left
        phi = film.mesh.phi.ravel()
        rises = gap_height(past.section, there.d, phi) / gap_height(film.section, here.d, phi) / share
        theta = rises * film.law.fraction(film.over_cavitation(pressure))[0]
        low = film.cavity * np.linspace(-1.0, 0.0, LEVELS) + film.cavitation
        left = np.interp(theta, film.law.fraction(film.over_cavitation(low))[0], low)
        pressure = np.where((theta < 1.0) & ~film.elements.fixed, np.minimum(left, pressure), pressure)
        wet[W, i] = wet[W_BEFORE, i] = _unknowns(film, data, pressure)
        wet[OIL, i] = film.fraction(pressure.reshape(film.mesh.phi.shape))  # beside openings their supply fills the gap
        held = oil_held(data, *d, wet[OIL, i])
        gained = held - flows[NOW, i, HELD]
        flows[PASSED, i, CAME] += max(gained, 0.0)
        flows[PASSED, i, LEFT] += max(-gained, 0.0)
        flows[NOW, i, HELD] = held
        x, y = data.weights.T @ pressure
        return float(x), float(y)

    def oil_defect(self, displacements: Sequence[tuple[float, float]], wet: Array, flows: Array) -> float | None:
        """Oil that a film creates, over what has passed through, or over what the full film holds if that is more."""
        full = np.array([film.volume * (film.open_area * film.height).sum() for film in self.data])
        through = np.maximum(flows[PASSED][:, [CAME, LEFT]].max(axis=1), full)
        return float((np.abs(_created(flows)) / through).max())

    def oil_passed(self, flows: Array) -> dict[str, float]:
        came, left = flows[PASSED][:, [CAME, LEFT]].sum(axis=0).tolist()
        return {"oil_in_m3": came, "oil_out_m3": left, "oil_created_m3": float(_created(flows).sum())}


def _created(flows: Array) -> Array:
    """(films,) oil in m^3 so far: what left more than came in and what the film holds more."""
    passed, now = flows[PASSED], flows[NOW]
    return np.asarray(passed[:, LEFT] - passed[:, CAME] + now[:, HELD] - passed[:, HELD])


def _unknowns(film: PublishedFilm, data: ElementFilm, pressure: Array) -> Array:
    """(e, 9) unknowns of the nodes of each element at scaled gauge pressures."""
    return np.asarray(unknowns_of(data.unknowns, data.step, pressure.ravel())[film.mesh.nodes])
