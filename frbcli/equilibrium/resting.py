"""The static equilibrium of a machine at a given speed: K q = f_static + sum over films of m P^T F(P q, 0, omega).

Newton's method runs on all degrees of freedom of the rotor until no force is left over. Floating rings have their
speeds as unknowns instead of their angles, and the torques on them as equations (ring_speed.py). The same search serves
a machine, a journal under a load and a film in any form: they differ in the forces that are left over alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.equilibrium.ring_speed import dragged_speeds, pin_angles, ring_balance
from frbcli.errors import NotConverged
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.parabola import share_within
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.roughness.contact import ELASTIC_LIMIT, ElasticShell
from frbcli.rotor.assembly import HeldRotor, LinearRotor, held_rotor, sprung
from frbcli.rotor.port import pushed, settled
from frbcli.scene.machine.system import System

Films = TypeVar("Films")

ITERATIONS = 80
GAP_KEPT = 0.25  # a step may shrink 1 - eps of a journal to this share of it
SHORTER = 0.5  # of the share of a step that is tried, while the force that is left over does not fall
NEAR = 0.1  # share that a step leaves of the force left over, below which its change shows what the slopes lack
STUCK, GAIN = 10, 1e-3  # shortened steps in a row that each take less than this share of the force that is left over


@dataclass(frozen=True)
class ForceBalance(Generic[Films]):
    """Journals at given places. residual: (c films,) N left over on them, or N m; slope: (c films, c films) its
    derivative by the places; films: their state there, from which places near by are solved; off: step by which their
    fields may still have to follow, over their size."""

    residual: Array
    slope: Array
    films: Films
    off: float = 0.0

    @property
    def left(self) -> float:
        """Size of the residual, N."""
        return float(np.linalg.norm(self.residual))


@dataclass(frozen=True)
class Search:
    """When a search ends. step: over the clearance, a full step below it has arrived; negligible: over the clearance, a
    step below it is not taken any more, where films are dear; force: N, and so has less left
    over; share: smallest one of a step that is tried until less is left over; patience: places that may be no better
    one after the other, where forces have jumps; gap: over the clearance, a journal that is nearer to its shell and
    still not held there does not rest."""

    step: float
    force: float
    share: float
    patience: int = 0
    gap: float = 0.0
    negligible: float = 0.0


@dataclass(frozen=True)
class SearchEnd(Generic[Films]):
    """Where a search ended. position: (films, c) in m and rad; settled: whether the journals rest there; lacking:
    (c films, c films) what the slopes have been seen to lack on the way."""

    position: Array
    balance: ForceBalance[Films]
    settled: bool
    lacking: Array


def search_rest(
    balance: Callable[[Array, ForceBalance[Films] | None], ForceBalance[Films]],
    start: Array,
    ends: Callable[[Array], Array],
    search: Search,
    lacking: Array | None = None,
    besides: Callable[[Array], float] | None = None,
) -> SearchEnd[Films]:
    """Where journals rest, sought from `start` (films, c) in m, with tilts in rad where they have any, or (n,) of any
    unknowns.

    balance: of the journals at a position (films, c), and the balance at the position before, if there is one; ends:
    (k, 2) what has to stay within the gap at a position, over the clearance and linear in it; lacking: what the slopes
    are known to lack, see SearchEnd; besides: size of a step in what moves no journal, over the clearance, too. Raises
    what balance raises.
    """
    first = balance(start, None)
    best = here = SearchEnd(start, first, False, np.zeros_like(first.slope) if lacking is None else lacking)
    still = ends(np.zeros_like(start))
    since = stuck = 0
    for _ in range(ITERATIONS):
        current = here.balance
        if current.left < search.force:
            return replace(here, settled=True)
        slope = current.slope + here.lacking
        if not np.isfinite(slope).all() or _singular(slope):
            break
        solved = np.asarray(np.linalg.solve(slope, -current.residual), dtype=np.float64)
        step = solved.reshape(*here.position.shape)
        there, moved = ends(here.position), ends(step) - still
        if _leaves(there, moved, search.gap):
            break
        share = whole = min([1.0, *(largest_share(*pair) for pair in zip(there, moved, strict=True))])
        size = max(float(np.abs(moved).max()), besides(step) if besides else 0.0)
        if max(size, current.off) < search.negligible:
            return replace(here, settled=True)
        arrives = size < search.step
        while True:
            following = here.position + share * step
            new = balance(following, current)
            if arrives or new.left < current.left or SHORTER * share <= search.share:
                break
            share *= SHORTER
        settled = arrives and share == 1.0
        lacks = here.lacking if settled else _lacking(here.lacking, current, new, share * solved)
        here = SearchEnd(following, new, settled, lacks)
        since = 0 if arrives or new.left < best.balance.left else since + 1
        best = here if since == 0 else best
        stuck = stuck + 1 if share < whole and new.left > (1.0 - GAIN) * current.left else 0
        if here.settled or since > search.patience or stuck == STUCK:
            break
    return best


def _singular(slope: Array) -> bool:
    """Whether a matrix is singular, whatever the units of its rows and columns."""
    for axis in (1, 0):
        size = np.abs(slope).max(axis=axis, keepdims=True)
        if not size.all():
            return True
        slope = slope / size
    return bool(np.linalg.matrix_rank(slope) < len(slope))


def _lacking(before: Array, current: ForceBalance[Films], new: ForceBalance[Films], step: Array) -> Array:
    """(c films, c films) what the slopes lack, as those by the speeds of rings do, after a step (c films,): from the
    change of the residual along the step (Broyden, Math. Comp. 19, 1965). None while the step is long."""
    if not 0.0 < new.left < NEAR * current.left:
        return np.zeros_like(before)
    predicted = 0.5 * (current.slope + new.slope) @ step + before @ step
    return before + np.outer(new.residual - current.residual - predicted, step) / (step @ step)


def _leaves(places: Array, moved: Array, gap: float) -> bool:
    """Whether a journal at places (k, 2) has less than the gap left and a step by `moved` (k, 2) takes it still nearer
    to its shell; all over the clearance."""
    beyond = np.linalg.norm(places, axis=1) > 1.0 - gap
    return bool((beyond & ((places * moved).sum(axis=1) > 0.0)).any())


def largest_share(position: Array, step: Array) -> float:
    """Largest share of a step (2,), at most 1, after which a journal at `position` (2,) keeps GAP_KEPT of its gap; both
    over the clearance."""
    return share_within(position, step, 1.0 - GAP_KEPT * (1.0 - float(np.linalg.norm(position))))


FilmBalance = ForceBalance[tuple[FilmForce, ...]]
SEARCH = Search(step=1e-10, force=0.0, share=1e-8, gap=1.0 - LARGEST_ECCENTRICITY)
STILL = 1e-6  # N: round-off of the films of a rotor without weight
ARM = 100.0  # clearances: torques on rings over it count next to forces, and not too much before the speeds are near
OUTER_START = 0.9  # eccentricity of the last start that is tried
# A position is foreseen from those at a few other speeds, as long as the sum of their weights without sign is below
# TRUSTED: four at even distances have 15, one step ahead.
REMEMBERED, TRUSTED = 4, 16.0


@dataclass(frozen=True)
class RestingPosition:
    """A machine at rest. displacements: (n,) in m, rings at their angle 0, or against their pin; journals: (films, c)
    in m, with the tilts in rad that films see; ring_speeds: (rings,) rad/s at which the torques on the rings balance,
    0 of those against a pin; films: the films there, () where nothing turns and nothing has to be carried;
    lacking: what their slopes were seen to lack, see SearchEnd, None where nothing was sought."""

    displacements: Array
    journals: Array
    ring_speeds: Array
    films: tuple[FilmForce, ...]
    lacking: Array | None = None

    @property
    def without_films(self) -> RestingPosition:
        """The position alone, to begin from with other films."""
        return replace(self, films=(), lacking=None)

    def moved(self, displacements: Array, ring_speeds: Array) -> RestingPosition:
        """This position moved by (n,) and (rings,), to begin from; journals are not followed."""
        moved, faster = self.displacements + displacements, self.ring_speeds + ring_speeds
        return replace(self, displacements=moved, ring_speeds=faster)

    def velocities(self, system: System) -> Array:
        """(n,) velocities of all degrees of freedom: the rings turn."""
        speeds = np.zeros_like(self.displacements)
        speeds[list(system.spins)] = self.ring_speeds
        return speeds


def lagrange(place: float, places: Sequence[float]) -> Array:
    """(k,) weights of values at k places, whose sum is the value at `place` on the polynomial through them; infinite
    or NaN where two places are one."""
    known, own = np.array(places), np.eye(len(places))
    with np.errstate(divide="ignore", invalid="ignore"):
        factors = np.where(own, 1.0, place - known) / (known[:, None] - known + own)
        return np.asarray(np.prod(factors, axis=1))


def weights_at(omega: float, omegas: Sequence[float]) -> Array:
    """(k,) weights of values at the last k of `omegas`, whose sum is the value at omega; of as many as are trusted, at
    least of the last one."""
    for count in range(min(len(omegas), REMEMBERED), 1, -1):
        weights = lagrange(omega, omegas[-count:])
        if float(np.abs(weights).sum()) < TRUSTED:
            return weights
    return np.ones(1)


def foreseen(omega: float, omegas: Sequence[float], positions: Sequence[RestingPosition]) -> RestingPosition:
    """The position at omega rad/s, with the fields of its films, as it follows from positions at other speeds, of which
    the last one is near."""
    weights = weights_at(omega, omegas)
    some = positions[-len(weights) :]
    displacements = weighted(weights, [each.displacements for each in some])
    journals = weighted(weights, [each.journals for each in some])
    speeds = weighted(weights, [each.ring_speeds for each in some])
    films = tuple(_foreseen(weights, each) for each in zip(*(each.films for each in some), strict=False))
    return RestingPosition(displacements, journals, speeds, films, some[-1].lacking)


def weighted(weights: Array, values: Sequence[Array | float]) -> Array:
    """The sum of arrays of one shape, each times its weight."""
    return np.asarray(np.tensordot(weights, np.array(values), axes=1))


def _foreseen(weights: Array, films: Sequence[FilmForce]) -> FilmForce:
    """The last of several films with the weighted sum of all their fields, where it is known how these follow."""
    last, slopes = films[-1], [film.slopes for film in films if film.slopes]
    fields = [film.field for film in films if film.field is not None and last.field is not None
              and film.field.shape == last.field.shape]  # fmt: skip
    if not len(slopes) == len(fields) == len(films):
        return last
    place, total = (weighted(weights, [getattr(each, name) for each in slopes]) for name in ("place", "total"))
    return replace(last, field=weighted(weights, fields), slopes=replace(slopes[-1], place=place, total=float(total)))


def resting_position(
    system: System,
    omega: float,
    start: Array | None = None,
    search: Search = SEARCH,
    neighbour: RestingPosition | None = None,
) -> RestingPosition:
    """Where the machine rests at omega rad/s, sought from the displacements `start` (n,), by default of the neighbour,
    if journals are within their gaps there, then from the centre. neighbour: a position near the start; its ring
    speeds, its film fields and the corrections of their slopes start the search.

    Raises NotConverged if no start leads to one.
    """
    if system.rotor.ports:
        return _at_ports(system, omega, start, search, neighbour)
    machine = RestEquations(system, omega)
    if not system.names:
        return machine.position(machine.held.shape, ())
    films, lacking = ((), None) if neighbour is None else (neighbour.films, neighbour.lacking)

    def sought(machine: RestEquations, first: Array, reach: float) -> SearchEnd[tuple[FilmForce, ...]]:
        def balance(unknowns: Array, before: FilmBalance | None) -> FilmBalance:
            return machine.balance(unknowns, before.films if before else films)

        return search_rest(balance, first, partial(machine.ends, reach=reach), search, lacking, machine.turned)

    left, tried = np.inf, 0
    for first, reach, sticks in machine.starts(start, neighbour):
        tried += 1
        end = sought(machine, sought(replace(machine, sticks=True), first, reach).position if sticks else first, reach)
        if end.settled and machine.outmost(end.position, reach) < LARGEST_ECCENTRICITY:
            return replace(machine.position(end.position, end.balance.films), lacking=end.lacking)
        left = min(left, end.balance.left)
    load = machine.held.load
    if not load.any() and left < STILL:  # films that do not turn hold nothing, and have nothing to hold
        return machine.position(machine.with_rings(machine.held.shape), ())
    raise NotConverged(
        f"No static equilibrium at {omega / (2 * np.pi):.4g} Hz below an eccentricity of {LARGEST_ECCENTRICITY}: "
        f"{tried} starts, residual {left:.3g} N of {np.linalg.norm(load):.3g} N. {_remedy(machine)}"
    )


def _at_ports(
    system: System, omega: float, start: Array | None, search: Search, neighbour: RestingPosition | None
) -> RestingPosition:
    """resting_position of a machine with ports, from the given start, the centre, and where the static load pushes each
    port over its length: a stop that nothing touches holds nothing."""

    def rest(flat: LinearRotor, q: Array) -> tuple[Array, RestingPosition]:
        position = resting_position(replace(system, rotor=flat), omega, q, search, neighbour)
        return position.displacements, position

    if start is None and neighbour is not None:
        start = neighbour.displacements
    starts = [] if start is None else [start]
    starts += [np.zeros(system.rotor.size), pushed(system.rotor)]
    return settled(system.rotor, omega, starts, rest, search.step)


def _remedy(machine: RestEquations) -> str:
    usual = "Ask for a higher speed, or give the bearing more viscosity, more width or less clearance."
    if machine.system.shell is None and machine.still.any():
        return f"{usual} A film between surfaces that do not turn carries nothing: a spring or an elastic shell does."
    return usual


@dataclass(frozen=True)
class RestEquations:
    """A machine at omega rad/s. Its unknowns (n,) are its displacements in m and rad, and in place of the angles of its
    rings their speeds over a unit. sticks: whether its rings are held."""

    system: System
    omega: float
    sticks: bool = False

    @cached_property
    def held(self) -> HeldRotor:
        """The rotor as the journals see it in their planes, whatever the films. Raises NotConverged."""
        rotor = self.system.rotor
        return held_rotor(replace(rotor, journals=rotor.journals[:, :2]), self.omega)

    @cached_property
    def _sprung(self) -> tuple[Array, Array]:
        return sprung(self.system.rotor.at(self.omega))

    @property
    def _ring_unit(self) -> float:
        """Speed of a ring in rad/s per unknown of 1 m: the speed of the rotor over a film's clearance."""
        return max(abs(self.omega), 1.0) / self.system.length

    @property
    def still(self) -> NDArray[np.bool_]:
        """(films,) which films lie between surfaces that do not turn."""
        system = self.system
        return np.asarray(system.omegas(self.omega, np.where(system.pinned, 0.0, self.omega)) == 0.0)

    def position(self, unknowns: Array, films: tuple[FilmForce, ...]) -> RestingPosition:
        """Where the machine rests, with its films there."""
        system = self.system
        displacements, speeds = self._parted(unknowns)
        journals = self.places(displacements)
        displacements[list(system.spins)] = pin_angles(system, self.omega, journals, films)
        return RestingPosition(displacements, journals, speeds, films)

    def _parted(self, unknowns: Array) -> tuple[Array, Array]:
        """(n,) displacements and (rings,) speeds in rad/s."""
        spins, displacements = list(self.system.spins), unknowns.copy()
        displacements[spins] = 0.0
        return displacements, unknowns[spins] * self._ring_unit

    def places(self, unknowns: Array) -> Array:
        """(films, c) coordinates of the journals in their shells."""
        return self.system.journals_of(unknowns)

    def ends(self, unknowns: Array, reach: float) -> Array:
        """See Films.ends, over the reach, 1 or an elastic shell's."""
        return np.asarray(self.system.films.ends(self.places(unknowns)) / reach)

    def outmost(self, unknowns: Array, reach: float) -> float:
        """The largest eccentricity over the reach."""
        return float(np.linalg.norm(self.ends(unknowns, reach), axis=1).max())

    def turned(self, step: Array) -> float:
        """By how much a step changes the speed of any ring, over the speed of the rotor."""
        return float(np.abs(step[list(self.system.spins)]).max(initial=0.0)) / self.system.length

    def starts(self, start: Array | None, neighbour: RestingPosition | None) -> Iterator[tuple[Array, float, bool]]:
        """Unknowns to begin from, each with its reach, and whether rings stick at first: those near by, the centre, and
        journals under their load."""
        system, clearances = self.system, np.array(self.system.clearances)[:, None]
        if neighbour is not None and start is None:
            start = neighbour.displacements
        if start is not None:
            near = self.with_rings(start, None if neighbour is None else neighbour.ring_speeds)
            reach = 1.0 if system.shell is None or self.outmost(near, 1.0) < 1.0 else ELASTIC_LIMIT
            if self.outmost(near, reach) < LARGEST_ECCENTRICITY:
                yield near, reach, False
        loads = self.held.load.reshape(-1, 2)
        size = np.linalg.norm(loads, axis=1, keepdims=True)
        along = np.divide(loads, size, out=np.zeros_like(loads), where=size > 0.0)
        journals = [np.zeros_like(loads), OUTER_START * clearances * along]
        carried = size[:, 0] / system.rotor.multiplicity
        if system.asperities is not None:
            journals.append(along * [[system.rubbing(i).standing(load)] for i, load in enumerate(carried.tolist())])
        tries = [(each, 1.0) for each in journals]
        if system.shell is not None and self.still.any():
            deep = along * self._pressed(system.shell, carried)[:, None]
            tries += [(np.where(self.still[:, None], deep, each), ELASTIC_LIMIT) for each in journals]
        for sticks in (False, True) if system.rough_rings else (False,):
            speeds = np.zeros(system.ring_count) if sticks else None
            for each, reach in tries:
                unknowns = self.with_rings(self.held.shape + self.held.following @ each.ravel(), speeds)
                if self.outmost(unknowns, reach) < 1.0:
                    yield unknowns, reach, sticks

    def _pressed(self, shell: ElasticShell, loads: Array) -> Array:
        """(films,) m by which films that carry nothing let their journals into their elastic shells, loads (films,) in
        N."""
        least = np.maximum(loads, np.finfo(float).tiny)
        return np.array([shell.pressed(*each) for each in zip(least.tolist(), self.system.clearances, strict=True)])

    def with_rings(self, displacements: Array, speeds: Array | None = None) -> Array:
        """(n,) unknowns at displacements (n,), the rings with speeds (rings,) in rad/s, by default those given by the
        drag of their films."""
        unknowns = displacements.copy()
        if speeds is None:
            speeds = dragged_speeds(self.system, self.omega, self.places(displacements))
        unknowns[list(self.system.spins)] = speeds / self._ring_unit
        return unknowns

    def balance(self, unknowns: Array, near: tuple[FilmForce, ...]) -> FilmBalance:
        """What acts on the rotor, and the torques on its rings over an arm. near: films near by, from whose fields
        finite-volume films are sought, if there are any."""
        system, rotor, (load, stiffness) = self.system, self.system.rotor, self._sprung
        displacements, speeds = self._parted(unknowns)
        places, bodies = self.places(displacements), np.append(self.omega, speeds)
        films = self._films(speeds, places, near)
        surplus, slope = load - stiffness @ displacements, -stiffness
        for many, journal, force in zip(rotor.multiplicity, rotor.journals, films, strict=True):
            own = many * journal.T
            surplus = surplus + own @ force.force
            slope = slope + own @ force.by_displacement @ journal
        if system.ring_count:
            spins, unit, arm = list(system.spins), self._ring_unit, ARM * system.length
            rings = ring_balance(system, bodies, places, films)
            pushes = rotor.multiplicity[:, None, None] * np.swapaxes(rotor.journals, 1, 2)
            slope[:, spins] += unit * (pushes @ rings.forces_by_speed).sum(axis=0)
            slope[spins] = rings.torques_by_place @ rotor.journals.reshape(-1, rotor.size) / arm
            slope[np.ix_(spins, spins)] = rings.torques_by_speed * unit / arm
            surplus[spins] = rings.torques / arm
            stopped = np.array(spins)[system.pinned | self.sticks]
            surplus[stopped], slope[stopped], slope[:, stopped] = -unknowns[stopped], 0.0, 0.0
            slope[stopped, stopped] = -1.0
        return ForceBalance(surplus, slope, films, max(film.off for film in films))

    def _films(self, speeds: Array, places: Array, near: tuple[FilmForce, ...]) -> tuple[FilmForce, ...]:
        """The films with journals at rest at places (films, c) and rings at speeds (rings,) in rad/s."""
        totals, slips = (of(self.omega, speeds).tolist() for of in (self.system.omegas, self.system.slips))
        return tuple(
            self.system.force(i, place, np.zeros_like(place), totals[i], near[i] if near else None, slips[i])
            for i, place in enumerate(places)
        )
