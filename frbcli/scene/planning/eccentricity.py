"""The largest eccentricity that a run-up is expected to reach before a whirl, from static load and unbalance.

A journal without mass in a short film (short_bearing.py) falls from where it starts, in the first revolutions, while
the oil turns it; later it rests under its weight and unbalance. Openings, supply pressure and mass are left out.
scipy is not asked for the two numbers, since its import takes longer than a whole plan.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.schema import Case
from frbcli.film.cavitation.table import law_named
from frbcli.rotor.speed_profile import SpeedProfile
from frbcli.scene.machine.elements import element_parts
from frbcli.scene.planning.profiles import run_up_profile
from frbcli.scene.planning.short_bearing import CLOSEST, mobility, resting_load, slenderness_of
from frbcli.scene.shafts.table import shaft_of

FALL = 10.0 * 2.0 * math.pi  # rad until which a journal has fallen
STEP, MOST_STEPS, FEWEST_STEPS = 0.01, 5000, 200  # of the fall: its length over the clearance; their number
RISEN = 0.95  # share of the largest eccentricity below which the journal has risen again
LARGEST = 1.0 - CLOSEST
ECCENTRICITIES = np.linspace(0.0, LARGEST, 500)


def expected_eccentricity(case: Case) -> float | None:
    """The largest one of all films, at most LARGEST; None without films, and with rings or dampers, whose motion is not
    known before a run."""
    if len(case.films) != len(case.bearings) or not case.bearings:
        return None
    return max(_expected(case, film) for film in case.films)


def heavily_loaded(case: Case) -> bool:
    """Whether a film carries a mean pressure from which on its law needs shorter steps; False where the static load of
    the films is not known, as above."""
    if len(case.films) != len(case.bearings) or not case.bearings:
        return False
    load = _weight(case)
    return any(load > law_named(case.cavitation(film)).heavy * film.width * film.diameter for film in case.films)


def _expected(case: Case, film: FilmGeometry) -> float:
    """The largest eccentricity that is expected of one film in a run-up."""
    profile, slender = run_up_profile(case), slenderness_of(film)
    softness = (2.0 * film.clearance / film.diameter) ** 2 / (film.width * film.diameter * case.viscosity(film))
    weight, top = softness * _weight(case), 0.5 * abs(float(profile.speeds[-1]))
    unbalance = softness * _unbalance(case, 2.0 * top)
    return max(_fallen(case, profile, weight, slender), _resting(weight + unbalance, top, slender))


def _fallen(case: Case, profile: SpeedProfile, load: float, slender: float) -> float:
    """The largest eccentricity in the first revolutions, by the midpoint rule. load: over b D eta / psi^2, 1/s."""

    def velocity(time: float, e: Array) -> Array:
        turning = 0.5 * float(profile.speed(np.array([time]))[0])
        return load * mobility(e, slender) + turning * np.array([-e[1], e[0]])

    e, time, largest = np.array(case.start.displacement or (0.0, 0.0)), float(profile.times[0]), 0.0
    longest = (profile.end - time) / FEWEST_STEPS
    for _ in range(MOST_STEPS):
        largest = max(largest, float(np.hypot(*e)))
        if largest >= LARGEST or np.hypot(*e) < RISEN * largest:
            break
        if time >= profile.end or abs(profile.angle(time)) > FALL:
            break
        rate = velocity(time, e)
        step = min(STEP / max(float(np.hypot(*rate)), 1e-300), longest)
        e = e + step * velocity(time + 0.5 * step, e + 0.5 * step * rate)
        time += step
    return min(largest, LARGEST)


def _resting(load: float, turning: float, slender: float) -> float:
    """The eccentricity of a journal at rest under a load as above; turning: mean speed of the surfaces, rad/s."""
    if turning == 0.0:
        return 0.0
    carried = [turning * resting_load(e, slender) for e in ECCENTRICITIES.tolist()]
    return float(np.interp(load, carried, ECCENTRICITIES))


def _weight(case: Case) -> float:
    """Static load of a film, N, shared by all of them."""
    x, y = 0.0, -shaft_of(case).mass * case.rotor.gravity
    for force in element_parts(case).forces:
        x, y = x + force.force[0], y + force.force[1]
    return math.hypot(x, y) / _films(case)


def _unbalance(case: Case, omega: float) -> float:
    """Force of the unbalance on a film, N, with omega rad/s, or with the natural frequency of the shaft, if that is
    lower: a faster rotor turns about its centre of mass."""
    shaft = shaft_of(case)
    square = omega**2 if shaft.compliance == 0.0 else min(omega**2, 1.0 / shaft.compliance)
    return shaft.disk_mass * shaft.eccentricity * square / _films(case)


def _films(case: Case) -> int:
    return shaft_of(case).equal_bearings * len(case.bearings)
