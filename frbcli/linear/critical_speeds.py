"""The critical speeds of the linearised rotor, with which resonances of a run are compared.

A mode of the rotor in its films whose natural frequency equals the rotor speed. The films are half-Sommerfeld ones,
full wherever they carry: a mass-conserving film has no eight coefficients, and the stiffness of a starved film changes
with time. A bearing model is linearised itself.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from frbcli.case.model import altered
from frbcli.case.schema import Case, FilmModel
from frbcli.errors import FrbError, NotConverged
from frbcli.linear.heat import Finder, machine_finder
from frbcli.linear.stability import eigenvalues
from frbcli.scene.films import rings
from frbcli.scene.plan import make_plan
from frbcli.scene.system import make_system

Array = NDArray[np.float64]

SPEEDS = 20  # between which natural frequencies are nearly straight
LOWEST = 0.01  # share of the highest speed
ABOVE = 1.2  # times the highest speed of a run: a mode a little above it is felt below
DAMPED = 1.0 / math.sqrt(2.0)  # damping ratio from which on unbalance causes no peak


def linear_critical_speeds(case: Case) -> tuple[float, ...] | None:
    """In Hz, ascending, of a case up to its highest speed and a little above; None where they are not known: for
    floating rings, whose films whirl from low speeds on, and where no resting position is found."""
    if rings(case):
        return None
    full = case
    if not case.film.bearing_model:
        film = FilmModel(cavitation="half-sommerfeld", theory=case.film.theory)
        full = altered(case, {"film": film})
    top = ABOVE * max(abs(case.speed.start), abs(case.speed.end))
    try:
        plan = make_plan(full)
        system = make_system(full, plan)
    except FrbError:  # an opening that this film does not know
        return None
    sweep = np.geomspace(top, LOWEST * top, SPEEDS).tolist() if top > 0.0 else []
    points = list(_modes(machine_finder(full, plan, system), sweep))
    found = (_crossings(below, above) for above, below in itertools.pairwise(points))
    return tuple(sorted(itertools.chain(*found))) if len(points) > 1 else None


def _modes(find: Finder, speeds_Hz: Sequence[float]) -> Iterator[tuple[float, Array]]:
    """Speed and natural frequencies (k,) in Hz of the modes that unbalance can excite, where the rotor can rest; from a
    fast journal near the middle outwards."""
    still, machine = np.zeros(2), None
    for speed in speeds_Hz:
        omega = 2.0 * math.pi * speed
        try:
            machine = find(omega, machine)
        except NotConverged:
            continue
        system = machine.system
        places, totals = system.rotor.journals @ machine.resting, system.omegas(omega, np.zeros(0))
        films = [system.film_force(i, place, still, float(totals[i])) for i, place in enumerate(places)]
        stiffness = -np.stack([film.by_displacement for film in films])
        damping = -np.stack([film.by_velocity for film in films])
        values = eigenvalues(system.rotor, omega, stiffness, damping)
        excited = values[(values.imag > 0.0) & (-values.real < DAMPED * np.abs(values))]
        yield speed, np.abs(excited) / (2.0 * math.pi)


def _crossings(below: tuple[float, Array], above: tuple[float, Array]) -> Iterator[float]:
    """Where natural frequencies equal the speed between two speeds: of each mode and the nearest one at the other."""
    (low, lower), (high, upper) = below, above
    for frequency in lower if len(upper) else ():
        off, then = frequency - low, upper[np.argmin(np.abs(upper - frequency))] - high
        if off >= 0.0 > then:
            yield float(low + (high - low) * off / (off - then))
