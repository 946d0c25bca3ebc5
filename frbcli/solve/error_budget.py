"""The error budget of a run: what each approximation leaves, and what all of them leave of the displacements."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.rotor import TurbochargerRotor
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.rotor.reduction import reduction_error
from frbcli.scene.coupling import APART, SEMI
from frbcli.scene.plan import Plan
from frbcli.scene.system import System
from frbcli.scene.turbocharger import all_modes, journals, kept_modes
from frbcli.solve.film_error import film_force_errors
from frbcli.solve.march import ERROR_MEMORY, NEWTON_SHARE
from frbcli.solve.oil import oil_defect
from frbcli.solve.state import ERROR_LARGEST, Array, State

# Of the absolute local errors of an embedded solution one order lower, summed as they fade in the films (ERROR_MEMORY):
# that is 2 to 29 times the true error of the journals, where it was measured (docs/accuracy.md).
COUNTED = 0.5
# A disk swings on for long after the films have calmed the journals: there the true error is 0.2 to 2.5 times the sum
# of all of them.
LASTING = 3.0
# A force that is wrong by a share moves its journal by so many shares of the eccentricity; cells on a mesh twice as
# fine still keep a third of their error.
FILM_REACH, CELL_REACH = 2.0, 3.0
BEFORE_WHIRL = 0.85  # of the time of its event: a whirl has grown for a while before it is seen
PARTING = ("onset", "contact")  # from there on two runs differ in phase, however exact they are
FIRST = np.zeros((1, 2))  # the history of the fading sum of local errors at the beginning of a run


def error_budget(
    case: Case,
    plan: Plan,
    system: System,
    end: float,
    history: Array,
    times: Array,
    samples: Array,
    events: Iterable[Mapping[str, Any]] = (),
) -> dict[str, float | None]:
    """The error of a run as its JSON has it, beside that of quick_budget. end: time reached, s.

    history: (k, 2) time in s and fading sum of the local errors then; times (m,) s, samples (m, 2 n + 1): see
    film_force_errors; events: of the run. None stands for what the run does not have: see docs/accuracy.md.
    """
    films = film_force_errors(plan, system, case, times, samples)
    until = quiet_until(events, end)
    force, short = films.relative(), plan.theory == "short"
    fading, whole = summed(history, until)
    by_films = (FILM_REACH if plan.cells is None else CELL_REACH) * (films.relative(until) or force or 0.0)
    quiet = samples[times <= until]
    eccentric, displaced = (_reach(system, quiet, parts) for parts in (_journals(system), _points(system)))
    return {
        "film_force_relative": force,
        "model_relative": force if short else None,
        "mesh_relative": None if short else force,
        "coupling": None if plan.coupling in (SEMI, APART) else NEWTON_SHARE * plan.tolerance,
        "modal_reduction": modal_reduction(case, system, samples),
        "eccentricity": COUNTED * fading + by_films * eccentric,
        "displacement": LASTING * whole + by_films * max(eccentric, displaced),
        "quiet_until_s": until,
    }


def summed(history: Array, until: float) -> tuple[float, float]:
    """(largest fading sum, sum without fading) of the local errors until a time, from the history of the fading one."""
    last = min(int(np.searchsorted(history[:, 0], until)), len(history) - 1)
    times, sums = history[: last + 1, 0], history[: last + 1, 1]
    # The fading sum E obeys dE = dS - E dt / ERROR_MEMORY.
    return float(sums.max()), float(sums[-1] + np.trapezoid(sums, times) / ERROR_MEMORY)


def _reach(system: System, samples: Array, parts: Iterable[tuple[Array, float]]) -> float:
    """Largest displacement over the clearance of some parts in the samples (m, 2 n + 1)."""
    places = (samples[:, : system.rotor.size] @ pick.T / clearance for pick, clearance in parts)
    return max((float(np.hypot(*at.T).max(initial=0.0)) for at in places), default=0.0)


def quick_budget(system: System, state: State, angle: float) -> dict[str, float | None]:
    """What is known of the error without any work, while a run goes on. angle: of the rotor, rad."""
    return {
        "time_integration": COUNTED * float(state.numbers[ERROR_LARGEST]),
        "film_force_relative": None,
        "oil_balance_relative": oil_defect(system, state, angle),
    }


def quiet_until(events: Iterable[Mapping[str, Any]], end: float) -> float:
    """Time in s until which runs can be compared point by point."""
    return min([end, *(BEFORE_WHIRL * float(event["t_s"]) for event in events if event["kind"] in PARTING)])


def modal_reduction(case: Case, system: System, samples: Array) -> float | None:
    """Relative error of the slowest natural frequencies by the rotor's modes that were left out, on springs as stiff as
    the films in the middle of the run; None for a rotor that has no modes, or without a state whose films are stiff."""
    if not isinstance(case.rotor, TurbochargerRotor) or not len(samples):
        return None
    modes = all_modes(case)
    kept = kept_modes(case.rotor, modes)
    if kept == len(modes.frequencies):
        return 0.0
    try:
        springs = _springs(case, system, samples[len(samples) // 2])
    except NotConverged:
        return None
    if not np.all(springs > 0.0):
        return None
    stations = np.stack([modes.at(journal.position) for journal in journals(case)])
    top = 2.0 * math.pi * max(case.speed.start, case.speed.end)
    return reduction_error(modes, kept, stations, springs, top).frequency


def _springs(case: Case, system: System, sample: Array) -> Array:
    """(b,) N/m: the mean of both directions of each bearing's stiffness, in series where a ring floats."""
    n = system.rotor.size
    q, v, omega = sample[:n], sample[n : 2 * n], float(sample[2 * n])
    omegas = system.omegas(omega, v[list(system.spins)])
    forces = (
        system.film_force(i, pick @ q, pick @ v, float(omegas[i])) for i, pick in enumerate(system.rotor.journals)
    )
    single = (-0.5 * float(np.trace(force.by_displacement)) for force in forces)
    return np.array([
        1.0 / (1.0 / next(single) + 1.0 / next(single)) if isinstance(bearing, FloatingRingBearing) else next(single)
        for bearing in case.bearings
    ])


def _journals(system: System) -> Iterable[tuple[Array, float]]:
    return zip(system.rotor.journals, system.clearances, strict=True)


def _points(system: System) -> Iterable[tuple[Array, float]]:
    """Disks and all else that moves; displacements count over the first film's clearance."""
    return ((pick, system.clearances[0]) for _, pick in system.rotor.points)
