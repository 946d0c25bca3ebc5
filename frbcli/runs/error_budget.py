"""The error budget of a run: the error of each approximation, with the error of the film forces from films that are
solved again on a finer mesh, the error by the cells from two runs of the same machine on different cells, and the total
error of the displacements."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frbcli.arrays import Array, Truths
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.runs.films import oil_defect
from frbcli.runs.inputs import films_change
from frbcli.runs.start import control_of
from frbcli.scene.coupling import coupling_named
from frbcli.scene.films import bearing_springs
from frbcli.scene.machine.rotor import element_springs
from frbcli.scene.machine.system import Segment, System
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.cell_choice import gap_ratio
from frbcli.scene.planning.film_choice import Plan
from frbcli.solve.stage.forces import felt_motion
from frbcli.solve.state import ERROR_LARGEST, ERRORS_LARGEST, ERRORS_SUM, State
from frbcli.solve.time_loop import NEWTON_SHARE

CLOSER = 3.0  # most that a smaller gap than was expected counts
# A disk oscillates longer than its journals, which the films damp: its true error is 0.2 to 2.5 times the sum of all
# local errors.
LASTING = 3.0
BEFORE_WHIRL = 0.85  # of the time of its event: a whirl grows before it is detected
PARTING = ("onset", "self-excited", "contact")  # afterwards two runs differ in phase, whatever their accuracy

SMALL_FORCE, NO_FORCE = 0.1, 1e-9  # of the median one; of the largest one of a run, which counts as none
GROWN = 1.0 / 3.0  # share of the error of a run, before which it counts as small
QUANTILE = 0.9  # quantile of the errors, weighted with the force


@dataclass(frozen=True)
class CellErrors:
    """Largest errors of a run by its cells: of eccentricities, of displacements over the clearance, of the speeds of
    rings over the largest one of the rotor, of the mean oil fractions."""

    eccentricity: float
    displacement: float
    ring_speed: float
    oil_fraction: float


@dataclass(frozen=True)
class FewerCells:
    """A run on fewer cells. share: of the difference between the runs that the error of the finer one may be; samples:
    at the same times as the samples of the run, see March; the last ones may be missing; least: error of the
    eccentricity that is stated even if both runs agree, which they may by chance; no more than the largest
    eccentricity. expected: eccentricity that `least` holds for; a run with a smaller gap states more."""

    share: float
    samples: Array
    least: float = 0.0
    expected: float | None = None

    def at(self, there: Truths) -> FewerCells:
        """These errors at some of the times only, (m,) whether at each time of the run."""
        return replace(self, samples=self.samples[there[: len(self.samples)].nonzero()])

    def error(self, samples: Array, system: System) -> CellErrors | None:
        """Errors of a run in its samples; None if the run on fewer cells does not reach that far."""
        if len(samples) > len(self.samples):
            return None
        n, rotor, stations = system.rotor.size, system.rotor, system.films.stations
        journals = list(
            zip(system.films.seen(rotor.journals), np.repeat(system.clearances, stations).tolist(), strict=True)
        )
        other = self.samples[: len(samples)]
        apart = samples - other
        films = [_largest(apart[:, :n], *film) for film in journals]
        runs = samples[:, :n], other[:, :n]
        eccentric = [_parted(*runs, *film) for film in journals]
        points = [_largest(apart[:, :n], selection, system.length) for _, selection in rotor.points]
        spins = float(np.abs(apart[:, [n + spin for spin in system.spins]]).max(initial=0.0))
        top = max(float(np.abs(samples[:, 2 * n]).max(initial=0.0)), 1e-300)
        first = 2 * n + 1
        oil = float(np.abs(apart[:, first : first + len(system.names)][:, list(system.remembering)]).max(initial=0.0))
        reach = max(_largest(samples[:, :n], *film) for film in journals)
        closer = 1.0 if self.expected is None else min(gap_ratio(self.expected, reach), CLOSER)
        least = min(closer * self.least, reach)
        eccentricity, displacement = (max(least, self.share * off) for off in (max(eccentric), max([*films, *points])))
        return CellErrors(eccentricity, displacement, self.share * spins / top, self.share * oil)


def _largest(apart: Array, selection: Array, room: float) -> float:
    return float(np.hypot(*(apart @ selection.T).T).max(initial=0.0)) / room


def _parted(one: Array, other: Array, selection: Array, room: float) -> float:
    lengths = (np.hypot(*(q @ selection.T).T) for q in (one, other))
    return float(np.abs(np.subtract(*lengths)).max(initial=0.0)) / room


def error_budget(
    case: Case,
    plan: Plan,
    system: System,
    until: float,
    steps: tuple[float, float],
    times: Array,
    samples: Array,
    fewer: FewerCells | None = None,
) -> dict[str, float | None]:
    """The error of a run as in its JSON, without the part of quick_budget. until: see quiet_until, s.

    steps: as summed, until then; times (m,) s, samples (m, 2 n + 1 ...): see film_force_errors; fewer: the same run on
    fewer cells. None: the run does not have this error, see docs/accuracy.md.
    """
    films = film_force_errors(plan, system, case, times, samples)
    force, short = films.relative(), plan.theory == "short"
    fading, whole = _counted(system) * steps[0], steps[1]
    quiet = samples[times <= until]
    eccentric, displaced = (_reach(system, quiet, parts) for parts in (_journals(system), _points(system)))
    by_films = system.films.reach * (films.relative(until) or force or 0.0)
    in_films, in_points = by_films * eccentric, by_films * max(eccentric, displaced)
    cells, reduced = None if fewer is None else fewer.error(quiet, system), modal_reduction(case, system, samples)
    if cells is not None:
        in_films, in_points = cells.eccentricity, cells.displacement
    of_steps = {} if system.names else {"time_integration": LASTING * whole}
    return of_steps | {
        "film_force_relative": force,
        "model_relative": force if short else None,
        "mesh_relative": None if short else force,
        "coupling": NEWTON_SHARE * plan.tolerance if coupling_named(plan.coupling).iterates else None,
        "modal_reduction": None if reduced is None else reduced[0],
        "modal_reduction_amplitude": None if reduced is None else reduced[1],
        "cells": None if cells is None else cells.eccentricity,
        "eccentricity": fading + in_films if system.names else None,
        "displacement": LASTING * whole + in_points,
        "ring_speed": fading + cells.ring_speed if cells is not None and system.ring_count else None,
        "oil_fraction": fading + cells.oil_fraction if cells is not None and system.remembers else None,
        "quiet_until_s": until,
    }


def budget_of_segments(
    known: Mapping[str, float | None],
    segments: Sequence[Segment],
    plan: Plan,
    until: float,
    steps: tuple[float, float],
    times: Array,
    samples: Array,
    fewer: FewerCells | None = None,
) -> dict[str, float | None]:
    """The largest value of each part over the segments that a run has passed; otherwise as error_budget."""
    begins, budgets = [segment.start for segment in segments], [known]
    for segment, first, last in zip(segments, begins, [*begins[1:], math.inf], strict=True):
        there = (times >= first) & (times < last)
        less = None if fewer is None else fewer.at(there)
        budgets.append(
            error_budget(segment.case, plan, segment.system, until, steps, times[there], samples[there], less)
        )
    keys = {key: None for budget in budgets for key in budget}
    values = {key: [value for budget in budgets if (value := budget.get(key)) is not None] for key in keys}
    return {key: max(errors, default=None) for key, errors in values.items()}


def summed(errors: Array, share: float) -> tuple[float, float]:
    """(largest fading sum, sum without fading) of the local errors in a share of the time of a run; errors: of State.
    The span in which that share ends counts in full."""
    spans = max(1, math.ceil(share * errors.shape[1]))
    return float(errors[ERRORS_LARGEST, :spans].max()), float(errors[ERRORS_SUM, :spans].sum())


def grows_from(
    system: System, errors: Array, fewer: FewerCells, times: Array, samples: Array, until: float, end: float
) -> float | None:
    """Time in s until which a run has only GROWN of the error of its eccentricities that it states until a time; None
    if the run on fewer cells does not reach that far. errors: of State; end: of the run, s; others: see error_budget.

    An error that arises late is an error of the phase of a vibration which grows slowly: it begins to part two runs
    long before it is found.
    """
    quiet = times[times <= until]

    def stated(t: float) -> float:
        cells = fewer.error(samples[times <= t], system)
        return math.inf if cells is None else _counted(system) * summed(errors, t / end)[0] + cells.eccentricity

    whole = stated(until)
    if not math.isfinite(whole) or not len(quiet):
        return None
    return float(quiet[max(0, bisect_right(quiet.tolist(), GROWN * whole, key=stated) - 1)])


def _reach(system: System, samples: Array, parts: Iterable[tuple[Array, float]]) -> float:
    """Largest displacement over the clearance of some parts in the samples (m, 2 n + 1)."""
    places = (samples[:, : system.rotor.size] @ selection.T / clearance for selection, clearance in parts)
    return max((float(np.hypot(*at.T).max(initial=0.0)) for at in places), default=0.0)


def quick_budget(system: System, state: State, angle: float) -> dict[str, float | None]:
    """The part of the error that is known during a run. angle: of the rotor, rad."""
    return {
        "time_integration": _counted(system) * float(state.numbers[ERROR_LARGEST]),
        "film_force_relative": None,
        "oil_balance_relative": oil_defect(system, state, angle),
    }


def _counted(system: System) -> float:
    return system.films.counted_share(system.ring_count)


def quiet_until(events: Iterable[Mapping[str, Any]], end: float) -> float:
    """Time in s up to which runs can be compared at each time."""
    return min([end, *(BEFORE_WHIRL * float(event["t_s"]) for event in events if event["kind"] in PARTING)])


def modal_reduction(case: Case, system: System, samples: Array) -> tuple[float, float] | None:
    """Relative errors by the rotor's modes that were left out, on springs as stiff as the films in the middle of the
    run: of the slowest natural frequencies, and of the heights of peaks at critical speeds. None for a rotor that has
    no modes, or without a state whose films are stiff."""
    if case.rotor.symmetric or not len(samples):
        return None
    free, middle = shaft_of(case).free(), samples[len(samples) // 2]
    if free.kept == len(free.modes.frequencies):
        return 0.0, 0.0
    try:
        springs = _springs(case, system, middle)
    except NotConverged:
        return None
    if not np.all(springs > 0.0):
        return None
    springs = np.concatenate([springs, element_springs(case, float(middle[2 * system.rotor.size]))])
    top = 2.0 * math.pi * max(case.speed.start, case.speed.end)
    amplitude = free.reduced_on(np.maximum(springs[: len(free.journals)], 1e-300), top).amplitude
    return free.reduction_error(springs, top).frequency, amplitude


def _springs(case: Case, system: System, sample: Array) -> Array:
    """(b,) N/m: the mean of both directions of each bearing's stiffness, in series where a ring floats."""
    forces = (system.force(i, *motion) for i, motion in enumerate(system.motions(sample)))
    return np.array(bearing_springs(case, (-0.5 * float(np.trace(force.by_displacement[:2, :2])) for force in forces)))


def _journals(system: System) -> Iterable[tuple[Array, float]]:
    films = system.films
    return zip(films.seen(system.rotor.journals), np.repeat(system.clearances, films.stations).tolist(), strict=True)


def _points(system: System) -> Iterable[tuple[Array, float]]:
    """Disks and all other points; displacements are relative to the length of the system."""
    return ((selection, system.length) for _, selection in system.rotor.points)


@dataclass(frozen=True)
class FilmErrors:
    """Errors and sizes of the forces of all films at sampled states of a run. times: (m,) s; errors, sizes: (m,) N."""

    times: Array
    errors: Array
    sizes: Array

    def relative(self, until: float = math.inf) -> float | None:
        """Relative error that 90 % of the force does not exceed, in states until a time in s; None without any.

        States are weighted with their force."""
        kept = self.times <= until
        errors, sizes = self.errors[kept], self.sizes[kept]
        if not len(errors) or sizes.max() <= NO_FORCE * self.sizes.max():  # a film that runs dry has no force at first
            return None
        # At states with a very small force, as at the start, the error is relative to the usual force.
        scales = np.maximum(sizes, SMALL_FORCE * float(np.median(sizes)))
        relative = errors / np.maximum(scales, NO_FORCE * float(sizes.max()))
        order = np.argsort(relative)
        carried = np.cumsum(sizes[order])
        return float(relative[order][np.searchsorted(carried, QUANTILE * carried[-1])])


def film_force_errors(plan: Plan, system: System, case: Case, times: Array, samples: Array) -> FilmErrors:
    """Errors of the film forces at sampled states, against the finite-length film on a finer mesh.

    times: (m,) s; samples: (m, 2 n + 1 or more) displacements, velocities, rotor speed in rad/s; where heat or inputs
    change films the last columns are clearances in m and scales of the films, see FilmNumbers: s times the scale gives
    the force of s times the velocities. For the short-bearing theory this is the error of the theory itself. In contact
    it refers to the film in the contact gap. Mass-conserving films are compared in their steady state; where there is
    none, they are left out.
    """
    forces = system.films.compared()
    if forces is None:
        return FilmErrors(*np.zeros((3, 0)))
    control, count, rows = control_of(case, plan), len(system.names), []
    changing = films_change(case)
    every = max(1, len(samples) // (system.films.compared_states or len(samples) or 1))
    for t, sample in zip(times[::every], samples[::every], strict=True):
        for i, (at, rate, total) in enumerate(system.motions(sample)):
            clearance, scale = system.clearances[i], 1.0
            if changing:
                now, scale = (float(sample[column * count + i]) for column in (-2, -1))
                at, rate = at * clearance / now, rate * clearance / now
            if control.contact_stiffness > 0.0:
                at, rate = clearance * felt_motion(control, at / clearance, rate / clearance)
            if np.hypot(*at[:2]) >= LARGEST_ECCENTRICITY * clearance:
                continue
            try:
                exact, force = forces(i, at, scale * rate, scale * total)
            except NotConverged:
                continue
            rows.append((float(t), float(np.hypot.reduce(force - exact)), float(np.hypot.reduce(exact))))
    table = np.array(rows).reshape(-1, 3)
    return FilmErrors(table[:, 0], table[:, 1], table[:, 2])
