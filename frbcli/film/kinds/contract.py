"""The contract of all kinds of films: a machine uses its films by these functions alone.

Film i has a journal whose displacement `place` (2,) in m and velocity `rate` (2,) in m/s are relative to its shell;
`total` is omega_J + omega_S, `slip` omega_J - omega_S, in rad/s. Forces act on the journal, by a whole bearing. Films
that see four coordinates have the tilts about x and y behind the displacement, and moments in N m behind the force.

Steady finite-volume films have pressure and flow as bearing sheets ask for them, whether or not their gaps are even
along the axis.

Films whose force follows from the motion alone: closed forms, tables, chains between axial grooves, and solutions
that were tabulated before.

The force of one film at many moments of a motion, compiled.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.ends import FLOWS, outflow
from frbcli.film.cells.data import WET
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution
from frbcli.film.cells.linearised import LinearFilm, film_at
from frbcli.film.cells.mean_film import MeanEndFlow
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section
from frbcli.film.grid import FINER, SAMPLES, Mesh
from frbcli.film.mean_fields import MeanFilm
from frbcli.film.penalty_table.film import SourceFilm
from frbcli.film.penalty_table.table import PenaltyTableFilm, with_half_the_nodes
from frbcli.film.rectangles.end_flow import EndFlow, end_flow, make_end_flow
from frbcli.film.rectangles.film import FilmForce, direct_force, evaluate, make_film
from frbcli.film.rectangles.film_force import FilmData, film_force
from frbcli.film.rectangles.short import ShortFilm

Part = tuple[VolumeFilm, Motion]


class FieldFilm(Protocol):
    """A whole bearing as the parts that are solved for it. d: (2,) displacement of the journal over the clearance, with
    its tilts in rad behind it, (4,), of a film that sees them; total: omega_J + omega_S in rad/s."""

    @property
    def section(self) -> Section:
        """Its section, over the whole width or one of two equal ones."""
        ...

    def ends(self, d: Array) -> Array:
        """(k, 2) displacements over the clearance where the gap may be the smallest along the axis."""
        ...

    def parts(self, d: Array, total: float) -> tuple[Part, ...]:
        """The films with the motions that they see, whose forces, torques and flows add up."""
        ...

    def outflow(self, solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> float:
        """What leaves a part, which the solver has solved, through its open ends, m^3/s."""
        return outflow(solver.film, motion, solver.film.pressure(solution.state), solver.data)


@dataclass(frozen=True)
class EvenFilm(FieldFilm):
    """A film whose gap is the same along the axis. See FieldFilm."""

    film: VolumeFilm

    @property
    def section(self) -> Section:
        return self.film.section

    def ends(self, d: Array) -> Array:
        return np.asarray(d)[None]

    def parts(self, d: Array, total: float) -> tuple[Part, ...]:
        motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), total)
        return ((film_at(self.film, math.hypot(*motion.d), total), motion),)


# (i, place, rate, total) -> force of a better film, and of the film, (2,) N each. Raises NotConverged.
Compared = Callable[[int, Array, Array, float], tuple[Array, Array]]

# (share, place, total, start) -> the film at rest with its journal at `place`, on cells that lie by a share of one cell
# further around; start: field of a film near by, None without. Raises NotConverged.
LinearOf = Callable[[float, Array, float, Array | None], LinearFilm]


@dataclass(frozen=True)
class Films(ABC):
    """All films of a machine, made once. clearances: (films,) m."""

    clearances: tuple[float, ...]

    coordinates: ClassVar[int] = 2  # of a journal that its film sees: 2, or 4 with its tilts
    on_cells: ClassVar[bool] = False  # whether the time loop solves them on cells
    stations: ClassVar[int] = 1  # places along a film at which the time loop has its journal: the middle, or both ends
    samples: ClassVar[int] = SAMPLES  # states of a run that are kept for the error of its forces
    # Of the absolute local errors of an embedded solution one order lower, summed as they fade in the films: that is 2
    # to 29 times the true error of the journals, where it was measured (docs/accuracy.md).
    counted: ClassVar[float] = 0.5
    counted_beside_rings: ClassVar[float] = 0.5
    # A relative error of the force moves the journal by as large a share of the eccentricity.
    reach: ClassVar[float] = 2.0
    cavitation_factor: ClassVar[str] = "none"  # "global" | "local" | "none": torque of missing oil, see FilmModel

    @property
    def count(self) -> int:
        """Number of films."""
        return len(self.clearances)

    @property
    @abstractmethod
    def loop(self) -> Any:
        """The films as the time loop takes them."""

    @abstractmethod
    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        """Force and derivatives of film i; of a film that keeps oil, when this has settled. near: of the same film in a
        motion near by, from which it may be sought. Raises NotConverged."""

    @property
    def standing(self) -> Array:
        """(films, coordinates) of journals in their shells when nothing has moved: other than 0 in shells that tilt."""
        return np.zeros((self.count, self.coordinates))

    def seen(self, journals: Array) -> Array:
        """(films stations, 2, ...) displacements, or what else of journals (films, coordinates, ...), as the time loop
        sees it: as it is, or at both ends of bearings in which they tilt."""
        return journals

    def ends(self, places: Array) -> Array:
        """(films stations, 2) displacements over the clearance that have to stay within the gap, of journals at places
        (films, coordinates)."""
        return np.asarray(self.seen(places) / np.repeat(self.clearances, self.stations)[:, None])

    @property
    def remembering(self) -> tuple[bool, ...]:
        """Which films keep oil of their own, so that their force does not follow from the motion alone."""
        return (False,) * self.count

    @property
    def sheared(self) -> Array:
        """(films,) share of each gap in which oil is sheared: all but its feed holes and grooves."""
        return np.ones(self.count)

    def harmonic_gaps(self, places: Array) -> Array:
        """(films,) harmonic means of H, by Sommerfeld's integral of 1 / H, of journals at places (films, coordinates)
        in m."""
        eccentricity = np.linalg.norm(places, axis=1) / np.array(self.clearances)
        return np.asarray(np.sqrt(np.maximum(1.0 - eccentricity**2, 1e-6)))

    def sheared_oil(self, places: Array, films: Sequence[FilmForce]) -> Array:
        """(films,) share of Couette's torque that missing oil leaves, of films as they are solved, journals at places
        (films, coordinates)."""
        return np.ones(self.count)

    def compared(self) -> Compared | None:
        """The force and the force of a better film, None where there is no better one."""
        return None

    @property
    def compared_states(self) -> int | None:
        """Number of samples of a run at which forces are compared where that takes long; None: at all of them."""
        return None

    def counted_share(self, ring_count: int) -> float:
        """Share of the sum of the local errors of a run that counts as its error. ring_count: of rings that turn."""
        return self.counted if ring_count == 0 else self.counted_beside_rings

    def first_state(self, places: Array, totals: Array) -> tuple[Array, Array]:
        """wet (WET, films, m, k) and flows (2, films, q) that a run begins with, journals at rest at places (films,
        coordinates): settled where that is possible, else full at the ambient pressure."""
        return np.zeros((WET, 0, 0, 0)), np.zeros((2, 0, FLOWS))

    def refill(
        self, i: int, before: Films, d: tuple[float, float], wet: Array, flows: Array
    ) -> tuple[float, float] | None:
        """Film i takes over the oil of the same film with another clearance; wet and flows are changed. d: over
        the clearance, in the frame of its openings. The force in N of the oil that it then holds, None where it keeps
        none."""
        return None

    def oil_defect(self, displacements: Sequence[tuple[float, float]], wet: Array, flows: Array) -> float | None:
        """Oil that is not accounted for, over what has passed through; the largest of all films, None if none keeps
        oil. displacements: (films stations) over the clearance, in the frame of their openings."""
        return None

    def oil_passed(self, flows: Array) -> dict[str, float]:
        """Oil in m^3 that came into all films that keep theirs, left them, and was created; empty if there are none."""
        return {}

    @abstractmethod
    def power_and_flow(
        self, i: int, place: Array, total: float, slip: float, drag: float, near: FilmForce | None = None
    ) -> tuple[float, float]:
        """Power in W that a film at rest dissipates, and flow in m^3/s through its open ends. drag: eta R^3 B / C of
        the bearing in N m s; near: see force. Raises NotConverged."""

    def heat_ends(self) -> Any:
        """Data from which the heat of the time loop computes the oil that leaves; empty of films that follow a tilt,
        of which runs have no heat."""
        return ()

    @property
    def end_flows(self) -> tuple[EndFlow, ...]:
        """The oil that leaves as it follows from the motion; empty where it is part of the films' state."""
        return ()

    @property
    def far_open(self) -> Array:
        """(films,) 1 where the far end of a section on cells is open; empty for other films."""
        return np.zeros(0)

    def flow_units(self, clearances: Array) -> Array:
        """(k, films) m^3/s: the unit of the flow that the time loop notes, clearances (k, films) m."""
        return np.ones_like(clearances)

    def smallest_gap(self, i: int, d: Array) -> Array:
        """(k,) least H of film i at displacements d (k, 2) over the clearance."""
        return np.asarray(1.0 - np.hypot(d[:, 0], d[:, 1]))

    @property
    def starving(self) -> bool:
        """Whether a film is mass-conserving and has no pressurised supply, so that its force decays."""
        return False

    def changeable(self) -> Self:
        """A copy whose arrays the time loop may change."""
        return self

    def scaled(self, scales: Array, clearances: Array) -> Self | None:
        """These films with other clearances (films,) in m, and with tables that serve when velocities are multiplied
        by scales (films,); None where they have to be made anew."""
        return None

    def supplied(self, shares: Array) -> Self:
        """These films with shares (films,) of their gauge supply pressures: their forces and their first state, not
        what the time loop takes."""
        return self

    def with_half_the_nodes(self) -> Self:
        """The films with every other node of their tables of solutions on cells, where they have such."""
        return self

    def smooth(self, ring_shares: Sequence[float]) -> tuple[FilmData, ...]:
        """The films as forces that follow smoothly from the motion alone; empty of films that follow a tilt.
        ring_shares: (films,) speed of the ring outside of each film over its total, 0 without one that turns."""
        return ()

    def smooth_ends(self, films: Sequence[FilmData]) -> tuple[EndFlow | MeanEndFlow, ...]:
        """The oil that leaves, as it follows smoothly from the motion alone. films: see smooth."""
        return self.end_flows

    @property
    def fields(self) -> tuple[FieldFilm, ...]:
        """The films with steady fields of pressure and flow whose gaps are not even along the axis; empty where they
        are."""
        return ()

    @property
    def with_fields(self) -> tuple[VolumeFilm, ...]:
        """The films with their fields of pressure, flow and oil; empty where these are not kept."""
        return ()

    def linear(self, i: int, cells: tuple[int, int]) -> LinearOf:
        """Film i, of a law that keeps oil, on cells (around, along) of its own, linearised with its oil; along: of a
        half of the width where the gap is even. Raises NotImplementedError of a kind that keeps none."""
        raise NotImplementedError

    @property
    def film_of_cells(self) -> NDArray[np.int64]:
        """(fields,) number of the film that each field of m x k cells in the time loop belongs to."""
        return np.zeros(0, dtype=np.int64)

    def gaps(self, d: Array) -> Array:
        """H in the cells of all fields, (fields, m, k) or (fields, m, 1), of displacements d (films stations, 2) over
        the clearance, in the frame of their openings; (0, 0, 0) of films without cells."""
        return np.ones((0, 0, 0))

    @property
    def gas_contents(self) -> Array:
        """(fields,) free and dissolved gas over the oil of each field, 0 of oil that carries none; empty where none
        does."""
        return np.zeros(0)

    def oil_unknowns(self, content: Array, near: Array, w: Array) -> Array:
        """(fields, m, k) unknowns of films with a content, from unknowns w of films with the content near.

        content, near: oil fractions of all fields, and behind them, where oil carries gas, their free gas over the
        oil."""
        return w


def couette_power(place: Array, clearance: float, force: Array, total: float, slip: float, drag: float) -> float:
    """Power in W of a full film at rest: Couette's resistance to the slip, and the moment of the force about the middle
    of the shell, which turns with half of the total."""
    d = place / clearance
    resistance = drag * 2.0 * math.pi / math.sqrt(1.0 - float(d @ d))
    return resistance * slip**2 + 0.5 * float(place[0] * force[1] - place[1] * force[0]) * total


@dataclass(frozen=True)
class NoFilms(Films):
    """No film at all."""

    clearances: tuple[float, ...] = ()

    @property
    def loop(self) -> Any:
        """No films for the time loop."""
        return ()

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        """Raises IndexError: there is no film."""
        raise IndexError(i)

    def power_and_flow(
        self, i: int, place: Array, total: float, slip: float, drag: float, near: FilmForce | None = None
    ) -> tuple[float, float]:
        """Raises IndexError: there is no film."""
        raise IndexError(i)


@dataclass(frozen=True)
class TableFilms(Films):
    """data: of each film; sections: over the whole width, see whole_width of gap.py; scales: None, or by what the
    velocities of each film have to be multiplied for its table, see Films.scaled; shares: None, or of their gauge
    supply pressures, see Films.supplied: r F(w / r) is the force with r times these."""

    data: tuple[FilmData, ...]
    sections: tuple[Section, ...]
    scales: tuple[float, ...] | None = field(default=None, kw_only=True)
    shares: tuple[float, ...] | None = field(default=None, kw_only=True)

    @property
    def loop(self) -> Any:
        """The films as the time loop takes them."""
        return self.data

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        if self.scales is None:
            return evaluate(self.data[i], self.clearances[i], place, rate, total)
        s = self.scales[i]
        force = evaluate(self.data[i], self.clearances[i], place, s * np.asarray(rate), s * total)
        r = 1.0 if self.shares is None else self.shares[i]
        return FilmForce(r * force.force, r * force.by_displacement, r * s * force.by_velocity)

    @cached_property
    def end_flows(self) -> tuple[EndFlow, ...]:
        return tuple(make_end_flow(section, film) for section, film in zip(self.sections, self.data, strict=True))

    def heat_ends(self) -> Any:
        return self.end_flows

    def power_and_flow(
        self, i: int, place: Array, total: float, slip: float, drag: float, near: FilmForce | None = None
    ) -> tuple[float, float]:
        d, c = place / self.clearances[i], self.clearances[i]
        power = couette_power(place, c, self.force(i, place, np.zeros(2), total).force, total, slip, drag)
        scale = 1.0 if self.scales is None else self.scales[i]
        w = 0.5 * total * np.array([d[1], -d[0]])
        leaving = end_flow(self.end_flows[i], float(d[0]), float(d[1]), float(w[0]), float(w[1]), scale)
        return power, c * leaving

    def scaled(self, scales: Array, clearances: Array) -> Self | None:
        return replace(self, clearances=tuple(clearances.tolist()), scales=tuple(scales.tolist()))

    def supplied(self, shares: Array) -> Self:
        scales = np.ones(self.count) if self.scales is None else np.asarray(self.scales)
        return replace(self, scales=tuple((scales / shares).tolist()), shares=tuple(shares.tolist()))

    def smooth(self, ring_shares: Sequence[float]) -> tuple[FilmData, ...]:
        return self.data


@dataclass(frozen=True)
class RectangleFilms(TableFilms):
    """Gaps made of rectangles. laws: of the films; theory: "short" | "finite"; mesh: the finest of the films'."""

    laws: tuple[str, ...]
    theory: str
    mesh: Mesh

    def compared(self) -> Compared:
        """See Films.compared: against the film of finite length, of the short bearing the error of the theory."""
        finer = Mesh(FINER * self.mesh.axial, FINER * self.mesh.circumferential)
        # Films between axial grooves have no table: the same film on the finer mesh is the reference.
        fine = [
            make_film(section, self.theory, law, finer) if section.grooves else None
            for section, law in zip(self.sections, self.laws, strict=True)
        ]

        def forces(i: int, place: Array, rate: Array, total: float) -> tuple[Array, Array]:
            section, better = self.sections[i], fine[i]
            if better is None:
                exact = direct_force(section, self.laws[i], finer, place, rate, total)
            else:
                exact = evaluate(better, section.clearance, place, rate, total).force
            return exact, self.force(i, place, rate, total).force

        return forces


@dataclass(frozen=True)
class SolutionFilms(TableFilms):
    """Films tabulated from solutions on cells. solved: what the tables are made of; mesh: cells."""

    solved: tuple[SourceFilm, ...]
    mesh: Mesh

    def with_half_the_nodes(self) -> Self:
        tables = (film for film in self.data if isinstance(film, PenaltyTableFilm))
        return replace(self, data=tuple(film._replace(table=with_half_the_nodes(film.table)) for film in tables))

    def compared(self) -> Compared:
        finer = Mesh(FINER * self.mesh.axial, FINER * self.mesh.circumferential)
        fine = [replace(film, mesh=finer) for film in self.solved]

        def forces(i: int, place: Array, rate: Array, total: float) -> tuple[Array, Array]:
            return fine[i].force(place, rate, total), self.force(i, place, rate, total).force

        return forces


# Columns of film_samples: force (x, y), derivatives by d (xx, xy, yx, yy), by v (xx, xy, yx, yy), by omega (x, y).
FORCE, BY_D, BY_V, BY_OMEGA, COLUMNS = 0, 2, 6, 10, 12
DIFFERENCE = 1e-6  # relative, of the speed, for films whose force depends on it by more than the motion of the gap


def film_samples(film: FilmData, d: Array, v: Array, omega: Array) -> Array:
    """(n, COLUMNS) N, N and N s: force on the journal by one bearing and its derivatives at n moments.

    d: (n, 2) displacement over the clearance; v: (n, 2) its rate in 1/s; omega: (n,) omega_J + omega_S in rad/s.
    """
    rows = np.empty((len(d), COLUMNS))
    _sample(film, d, v, omega, rows)
    if isinstance(film, PenaltyTableFilm | MeanFilm):
        step = DIFFERENCE * np.maximum(np.abs(omega), 1.0)
        ahead, behind = np.empty_like(rows), np.empty_like(rows)
        _sample(film, d, v, omega + step, ahead)
        _sample(film, d, v, omega - step, behind)
        rows[:, BY_OMEGA:] = (ahead[:, :2] - behind[:, :2]) / (2.0 * step[:, None])
    return rows


def at_viscosity(film: FilmData, scale: float) -> FilmData:
    """The film with its viscosity times `scale`; ask it with scaled velocities. Pressures at openings that turn fall
    with the speed as it is."""
    return film._replace(drop=film.drop / scale**2) if isinstance(film, MeanFilm) else film


def have_closed_forms(films: Sequence[FilmData]) -> bool:
    """Whether the force of every film is a formula, without lines of a table or of a mesh."""
    return all(isinstance(film, ShortFilm) for film in films)


@compiled()
def _sample(film: Any, d: Array, v: Array, omega: Array, rows: Array) -> None:
    """The rows of film_samples; by omega as far as it moves the gap, through w = v - (omega/2) J d (4.5)."""
    for i in range(d.shape[0]):
        f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = film_force(
            film, d[i, 0], d[i, 1], v[i, 0], v[i, 1], omega[i]
        )
        rows[i, 0], rows[i, 1] = f_x, f_y
        rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5] = k_xx, k_xy, k_yx, k_yy
        rows[i, 6], rows[i, 7], rows[i, 8], rows[i, 9] = d_xx, d_xy, d_yx, d_yy
        rows[i, 10] = 0.5 * (d_xx * d[i, 1] - d_xy * d[i, 0])
        rows[i, 11] = 0.5 * (d_yx * d[i, 1] - d_yy * d[i, 0])


def drag_factor(d: Array) -> tuple[Array, Array]:
    """Sommerfeld's integral of 1 / H over the turn at displacements (n, 2) over the clearance: (n,), and its gradient
    (n, 2)."""
    square = np.maximum(1.0 - np.sum(d**2, axis=1), 1e-6)
    factor = 2.0 * math.pi / np.sqrt(square)
    return factor, factor[:, None] * d / square[:, None]
