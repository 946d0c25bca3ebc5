"""Films on finite volumes, all of a machine side by side."""

from __future__ import annotations

import contextlib
import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.errors import NotConverged
from frbcli.film.cells.balance.boundaries import ALL, supply_line
from frbcli.film.cells.balance.ends import CREATED, ENDS_NET, FILLING, FLOWS, INFLOW, OUTFLOW, opens_far, outflow
from frbcli.film.cells.cavity_edge import CellEnds
from frbcli.film.cells.data import (
    COS,
    GAP,
    GAS,
    GIVEN_PRESSURE,
    MIDDLES,
    NOW,
    OIL,
    PASSED,
    SHEARED,
    SIN,
    W_BEFORE,
    WET,
    WET_WITH_GAS,
    VolumeFilms,
    W,
)
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution, refilled, supplied, unknown_with_fraction
from frbcli.film.cells.gas.balance import Carried, with_own_gas
from frbcli.film.cells.linearised import film_at, linear_film, lying, steady_force, steady_solution
from frbcli.film.cells.loads import CavitationFactor, force, loads, shear_weights
from frbcli.film.cells.mean_film import MeanEndFlow, mean_end_flow, mean_film
from frbcli.film.cells.mesh.grid import run_grid
from frbcli.film.gap import Section, gap_height
from frbcli.film.grid import FINER
from frbcli.film.kinds.contract import Compared, Films, LinearOf
from frbcli.film.mean_fields import MeanFilm
from frbcli.film.rectangles.end_flow import EndFlow
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.rectangles.film_force import FilmData
from frbcli.film.roughness.contact import stress_factor
from frbcli.film.section_faults import is_unfed

SAME, HALVES = 1e-9, 40  # oil fractions that differ by less; by so many halves of an interval unknowns are found
NARROWEST = 1e-3  # over the clearance: of the gap in which oil is sheared
AROUND = 360  # angles at which the gap of a profile is looked at


@dataclass(frozen=True)
class VolumeKind(Films):
    """Films of fields of cells, one for each land. All that a film keeps is in its fields."""

    samples: ClassVar[int] = 192
    counted: ClassVar[float] = 0.25  # 5 to 14 times the true error, of rotors without rings
    counted_beside_rings: ClassVar[float] = 1.0  # the true error is 0.45 to 1.15 times all of the sum
    # On a mesh twice as fine the error is still a third. Too little where errors accumulate: it is used only where the
    # run was not repeated on fewer cells.
    reach: ClassVar[float] = 3.0
    on_cells: ClassVar[bool] = True

    @property
    @abstractmethod
    def fields_of_films(self) -> tuple[tuple[int, VolumeFilm], ...]:
        """The number of the film that each field belongs to, and its section on cells with its law."""

    @property
    def film_of_cells(self) -> NDArray[np.int64]:
        return np.array([i for i, _ in self.fields_of_films])

    @property
    def remembering(self) -> tuple[bool, ...]:
        keeps = {i: film.law.keeps_oil for i, film in self.fields_of_films}
        return tuple(keeps[i] for i in range(self.count))

    @property
    def starving(self) -> bool:
        return any(film.law.keeps_oil and is_unfed(film.section, type(film.law)) for _, film in self.fields_of_films)

    def gaps(self, d: Array) -> Array:
        ring, along = self.loop.ring, self.loop.places[:, MIDDLES, :-1]
        ends = d.reshape(self.count, self.stations, 2)[self.film_of_cells]
        near, far = (
            ring[:, GAP] + end[:, :1] * ring[:, SIN] - end[:, 1:] * ring[:, COS] for end in (ends[:, 0], ends[:, -1])
        )
        return np.asarray(near[:, :, None] + along[:, None, :] * (far - near)[:, :, None])

    @property
    def gas_contents(self) -> Array:
        laws = [film.law for _, film in self.fields_of_films]
        return np.array([law.gas_content for law in laws if any(each.carries_gas for each in laws)])

    def oil_unknowns(self, content: Array, near: Array, w: Array) -> Array:
        """See Films.oil_unknowns."""
        films = [film for _, film in self.fields_of_films]
        count = len(films)
        return np.stack([
            unknown_with_gas(film, content[i::count], near[i::count], w[i])
            if film.law.carries_gas
            else unknown_at(film, content[i], near[i], w[i])
            for i, film in enumerate(films)
        ])  # fmt: skip

    def oil_defect(self, displacements: Sequence[tuple[float, float]], wet: Array, flows: Array) -> float | None:
        """Oil in the cells that their unknowns do not account for, over what has passed through.

        The oil that a run carries on changes by the flows alone, to round-off; what can be lost is its agreement with
        the pressures and oil fractions."""
        if not any(self.remembering):
            return None
        worst, gaps = 0.0, self.gaps(np.array(displacements))
        for number, (_, film) in enumerate(self.fields_of_films):
            if film.law.keeps_oil:
                now = gaps[number] * film.cells(wet[W, number], gas_of(film, wet[:, number])).fraction
                worst = max(worst, missing_oil(film, now, wet[OIL, number], flows[PASSED, number]))
        return worst

    def oil_passed(self, flows: Array) -> dict[str, float]:
        if not any(self.remembering):
            return {}
        films = [film for _, film in self.fields_of_films]
        size = np.array([film.law.keeps_oil * film.section.flow_scale for film in films])
        came, left = (float(size @ flows[PASSED, :, flow]) for flow in (INFLOW, OUTFLOW))
        passed = {"oil_in_m3": came, "oil_out_m3": left}
        if any(film.section.diffusion is not None for film in films):
            passed["oil_created_m3"] = float(size @ flows[PASSED, :, CREATED])
        return passed

    def smallest_gap(self, i: int, d: Array) -> Array:
        return least_gaps(dict(self.fields_of_films)[i].section, d)


@dataclass(frozen=True)
class CellFilms(VolumeKind):
    """own: the films; data: the same for the time loop; cells: (around, along); factor: cavitation factor of Couette's
    torque; states: at which forces are compared, of a run; viscosity: of the oil in the channels in Pa s; exponents:
    see CellEnds."""

    own: tuple[VolumeFilm, ...]
    data: VolumeFilms
    cells: tuple[int, int]
    factor: CavitationFactor
    states: int
    viscosity: float
    exponents: Array = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def loop(self) -> Any:
        """The films as the time loop takes them."""
        return self.data

    @property
    def with_fields(self) -> tuple[VolumeFilm, ...]:
        return self.own

    @property
    def fields_of_films(self) -> tuple[tuple[int, VolumeFilm], ...]:
        return tuple(enumerate(self.own))

    @property
    def cavitation_factor(self) -> str:  # type: ignore[override]
        """See Films."""
        return self.factor

    @property
    def sheared(self) -> Array:
        return np.asarray(self.data.cells[:, SHEARED].sum(axis=(1, 2)) / (2.0 * math.pi))

    def harmonic_gaps(self, places: Array) -> Array:
        """See Films.harmonic_gaps: over the cells in which oil is sheared, with the openings in their places, as in the
        time loop. Narrow gaps lie between openings, or in them, and rough surfaces shear the oil otherwise."""
        h = np.maximum(self.gaps(places / np.array(self.clearances)[:, None])[:, :, 0], NARROWEST)
        areas = self.data.cells[:, SHEARED].sum(axis=2)
        sheared = areas / h
        for i, film in enumerate(self.data.films):
            if film.roughness > 0.0:
                sheared[i] *= [stress_factor(float(each), float(film.roughness)) for each in h[i]]
        return np.asarray(areas.sum(axis=1) / sheared.sum(axis=1))

    def sheared_oil(self, places: Array, films: Sequence[FilmForce]) -> Array:
        shares = np.ones(self.count)  # of films that are full by their law, too
        if self.factor == "none" or not any(self.remembering):
            return shares
        for i, (own, place, film) in enumerate(
            zip(self.own, places / np.array(self.clearances)[:, None], films, strict=True)
        ):
            if film.fraction is not None and film.fraction.shape == own.grid.shape:  # not of a mesh to start from
                motion = Motion((float(place[0]), float(place[1])), (0.0, 0.0), 0.0)
                shares[i] = float((shear_weights(own, motion, self.factor) * film.fraction).sum())
        return shares

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        return steady_force(self.own[i], place, rate, total, _field(place, total, near))

    def linear(self, i: int, cells: tuple[int, int]) -> LinearOf:
        film = self.own[i]
        mesh = VolumeFilm(film.section, run_grid(film.section, cells), film.law, film.scales.reference)
        return lambda share, place, total, start: linear_film(lying(mesh, share), place, total, start, self.factor)

    @property
    def compared_states(self) -> int:
        return self.states

    def compared(self) -> Compared:
        """See Films.compared: in the steady state on twice the cells each way."""
        finer = FINER * self.cells[0], FINER * self.cells[1]
        grids = [run_grid(film.section, finer) for film in self.own]
        fine = [
            VolumeFilm(film.section, grid, film.law, film.scales.reference)
            for film, grid in zip(self.own, grids, strict=True)
        ]

        def settled(film: VolumeFilm, place: Array, rate: Array, total: float) -> Array:
            d, v = place / film.section.clearance, rate / film.section.clearance
            motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), total)
            return np.array(force(film, film.mean_pressure(steady_solution(film, motion).state)))

        def forces(i: int, place: Array, rate: Array, total: float) -> tuple[Array, Array]:
            return settled(fine[i], place, rate, total), settled(self.own[i], place, rate, total)

        return forces

    def first_state(self, places: Array, totals: Array) -> tuple[Array, Array]:
        """See Films.first_state. The oil does not change at first: the journals stand still."""
        wet = no_wet(self.own)
        flows = np.zeros((2, self.count, FLOWS))
        flows[PASSED, :, FILLING] = ALL
        lines = [supply_line(film) for film in self.own]  # nothing flows at first: lines take up what is given
        flows[NOW, :, FILLING] = [line.given / line.line if line.given > 0.0 else 0.0 for line in lines]
        for i, film in enumerate(self.own):
            at = places[i] / self.clearances[i]
            motion, solution = Motion((float(at[0]), float(at[1])), (0.0, 0.0), float(totals[i])), None
            if np.any(at != 0.0) and totals[i] != 0.0:
                with contextlib.suppress(NotConverged):
                    solution = steady_solution(film, motion)
                    flows[PASSED, i, FILLING] = solution.filling
            begin_wet(film, motion, solution, wet[:, i])
        return wet, flows

    def refill(
        self, i: int, before: Films, d: tuple[float, float], wet: Array, flows: Array
    ) -> tuple[float, float] | None:
        if not self.remembering[i]:
            return None
        film, old = self.own[i], before.with_fields[i]
        gas = gas_of(film, wet[:, i])
        w, oil = refilled(old, film, d, wet[OIL, i], wet[W, i], gas)
        wet[W, i] = wet[W_BEFORE, i] = w
        wet[OIL, i] = film.content(Motion(d, (0.0, 0.0), 0.0), w, gas)
        if gas is not None:
            wet[GAS, i] = wet[OIL, i] * gas.gas
        flows[:, i, :FILLING] *= old.section.clearance / film.section.clearance
        spilled = float((film.grid.area * (oil - wet[OIL, i]))[~film.grid.fixed].sum())
        for flow in (OUTFLOW, ENDS_NET):
            flows[PASSED, i, flow] += spilled
        return force(film, film.mean_pressure(film.cells(w, gas)))

    def power_and_flow(
        self, i: int, place: Array, total: float, slip: float, drag: float, near: FilmForce | None = None
    ) -> tuple[float, float]:
        film, d = self.own[i], place / self.clearances[i]
        motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), total)
        solution = steady_solution(film, motion, _field(place, total, near))
        at = film_at(film, math.hypot(*d), total)
        acting = loads(at, motion, solution, slip, self.factor)
        moment = float(place[0] * acting.force[1] - place[1] * acting.force[0])
        power = -acting.torque.couette * slip + 0.5 * moment * total
        return power, outflow(at, motion, at.pressure(solution.state))

    def heat_ends(self) -> Any:
        return CellEnds(
            far_open=np.array([opens_far(film) for film in self.own], dtype=np.int64),
            units=self._areas,
            films=self.data.films.copy(),
            given=self.data.cells[:, GIVEN_PRESSURE].copy(),
            feed_holes=self.data.feed_holes.copy(),
            resistance=self.data.channels["resistance"] / self.viscosity,
            exponents=self.exponents,
            groove_pressure=self.data.channels["groove_pressure"].copy(),
        )

    @property
    def far_open(self) -> Array:
        return np.array([opens_far(film) for film in self.own], dtype=np.float64)

    def flow_units(self, clearances: Array) -> Array:
        return np.asarray(self._areas * clearances)

    @property
    def _areas(self) -> Array:
        return np.array([film.section.area for film in self.own])

    def changeable(self) -> Self:
        data = self.data
        own = data._replace(
            films=data.films.copy(),
            cells=data.cells.copy(),
            feed_holes=data.feed_holes.copy(),
            channels=data.channels.copy(),
        )
        return replace(self, data=own)

    def supplied(self, shares: Array) -> Self:
        own = tuple(supplied(film, float(share)) for film, share in zip(self.own, shares, strict=True))
        return replace(self, own=own)

    def smooth(self, ring_shares: Sequence[float]) -> tuple[FilmData, ...]:
        """See Films.smooth: as the mean over the angle of openings that turn."""

        means: list[FilmData] = []
        for i, film in enumerate(self.own):
            openings, drop = film.section.holes, 0.0
            centrifugal = float(self.data.films[i].centrifugal)
            if openings and ring_shares[i] > 0.0 and centrifugal > 0.0 and openings[0].pressure > 0.0:
                drop = centrifugal * ring_shares[i] ** 2 * film.section.pressure_scale / openings[0].pressure
            means.append(mean_film(film, len(openings), drop))
        return tuple(means)

    def smooth_ends(self, films: Sequence[FilmData]) -> tuple[EndFlow | MeanEndFlow, ...]:
        tables = [film for film in films if isinstance(film, MeanFilm)]
        pairs = enumerate(zip(self.own, tables, strict=True))
        return tuple(mean_end_flow(own, fields, self.data, i) for i, (own, fields) in pairs)


def _field(place: Array, total: float, near: FilmForce | None) -> Array | None:
    """The field to begin from with the journal at rest at `place` (2,), see Films.force."""
    return None if near is None else near.foreseen(place, total).field


def no_wet(films: Sequence[VolumeFilm]) -> Array:
    """(WET or WET_WITH_GAS, fields, m, k) room for the state of fields of cells."""
    layers = WET_WITH_GAS if any(film.law.carries_gas for film in films) else WET
    return np.zeros((layers, len(films), *films[0].grid.shape))


def begin_wet(film: VolumeFilm, motion: Motion, solution: VolumeSolution | None, wet: Array) -> None:
    """wet (layers, m, k) <- of a film that has settled, or without a solution is full at the ambient pressure."""
    w, gas = (film.full(), None) if solution is None else (solution.w, solution.gas)
    wet[W] = wet[W_BEFORE] = w
    wet[OIL] = film.content(motion, w, None if gas is None else gas.carried)
    if film.law.carries_gas:
        wet[GAS] = wet[OIL] * (film.law.free_gas(film.cells(w), film.scales) if gas is None else gas.free)


def gas_of(film: VolumeFilm, wet: Array) -> Carried | None:
    """The free gas that the oil of a film has in its state (layers, m, k)."""
    return with_own_gas(wet[GAS] / wet[OIL]) if film.law.carries_gas else None


def missing_oil(film: VolumeFilm, now: Array, oil: Array, passed: Array) -> float:
    """Oil (m, k) of a film that its unknowns, which hold `now`, do not account for, with what artificial diffusion has
    created, over what has passed through: passed (FLOWS,)."""
    free = ~film.grid.fixed
    area = film.grid.area[free]
    # per turnover of the film's own oil, if less than that has passed so far
    through = max(float(max(passed[INFLOW], passed[OUTFLOW])), float((area * now[free]).sum()))
    return (abs(float((area * (now - oil)[free]).sum())) + abs(float(passed[CREATED]))) / through


def least_gaps(section: Section, d: Array) -> Array:
    """(k,) least H of a section at displacements d (k, 2) over the clearance."""
    if section.profile is None:
        return np.asarray(1.0 - np.hypot(d[:, 0], d[:, 1]))
    phi = np.linspace(0.0, 2.0 * math.pi, AROUND, endpoint=False)
    height = gap_height(section, (0.0, 0.0), phi) + d[:, :1] * np.sin(phi) - d[:, 1:] * np.cos(phi)
    return np.asarray(height.min(axis=1))


def unknown_with_gas(film: VolumeFilm, content: Array, before: Array, w: Array) -> Array:
    """(m, k) unknown of cells with oil fractions and free gas `content` (2, m, k); w: unknown of cells with the content
    `before`; a cell with too much oil for its gas keeps its pressure."""
    theta, free = content
    gas = with_own_gas(np.clip(free, 0.0, film.law.gas_content))
    changed = np.abs(content - before).max(axis=0) > SAME
    return np.where(changed, unknown_with_fraction(film, theta, np.maximum(film.full(), w), gas), w)


def unknown_at(film: VolumeFilm, theta: Array, before: Array, w: Array) -> Array:
    """(m, k) unknown of cells that hold theta; w: unknown of cells that held `before`.

    The first step asks for it: over so short a time the oil of a cell stays, and Newton's method leaps past the steep
    part of a law from afar. In a full cell the oil does not determine the pressure, and the unknown stays."""
    unknown = np.where(theta < 1.0, w, np.maximum(w, 0.0))
    changed = (theta < 1.0) & (np.abs(theta - before) > SAME)
    high = np.zeros(np.count_nonzero(changed))
    low = high - 2.0 - (film.scales.cavitation + film.scales.ambient) / film.scales.reference
    for _ in range(HALVES):
        middle = 0.5 * (low + high)
        more = film.law.cells(middle, film.scales).fraction > theta[changed]
        low, high = np.where(more, low, middle), np.where(more, middle, high)
    unknown[changed] = high
    return unknown
