"""The eccentricity that a plan expects, with its profiles and the short bearing.

What the theory of the short bearing knows of a film before anything is solved: the error of its force, how a journal
falls, and where it rests.

The largest eccentricity that a run-up is expected to reach before a whirl, from static load and unbalance.

A journal without mass in a short film (short_bearing.py) falls from where it starts, in the first revolutions, while
the oil turns it; later it rests under its weight and unbalance. Openings, supply pressure and mass are left out.
scipy is not asked for the two numbers, since its import takes longer than a whole plan.

The speed of the rotor over time: run-up and run-down.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.schema import Case
from frbcli.case.surroundings.over_time import OverTime
from frbcli.errors import Fault, InputError
from frbcli.film.cavitation.table import law_named
from frbcli.rotor.loads import SpeedProfile, speed_profile
from frbcli.scene.inputs import input_faults, input_times
from frbcli.scene.machine.elements import element_parts, table_faults, table_times
from frbcli.scene.shafts.table import shaft_of

# The mean error of a short section is SHORT (b/D)^2 (1 - eps)^-SHORT_POWER, to 20 % for b/D <= 0.4.
SHORT, SHORT_POWER = 0.45, 1.3
CLOSEST = 0.02  # smallest gap over the clearance that is distinguished


def slenderness_of(film: FilmGeometry) -> float:
    """Width of a section over the diameter."""
    return film.width / film.diameter / (2 if film.supply.splits else 1)


def short_error(slender: float, eccentricity: float) -> float:
    """Relative error of the force of the short-bearing theory, for sections of b/D = slender."""
    return float(SHORT * slender**2 * (1.0 - eccentricity) ** -SHORT_POWER)


def mobility(e: Array, slender: float) -> Array:
    """(2,) velocity over the clearance of a journal at e (2,) in a film that cavitates, under a load W along -y, over
    psi^2 W / (b D eta), in addition to the mean velocity of the oil.

    The mobility of the short bearing (Booker, "Dynamically loaded journal bearings: mobility method of solution",
    J. Basic Eng. 87, 1965), and more by the force that a longer bearing lacks.
    """
    room = max(1.0 - float(np.hypot(*e)), CLOSEST)
    along, left = -e[1], e[0]  # of the load, and to the left of it
    ahead = max(1.0 - along, CLOSEST)
    size = (1.0 + short_error(slender, 1.0 - room)) / slender**2
    return size * np.array([-4.0 * left * ahead**1.5 / math.pi**2, -(ahead**2.5) / math.pi])


def resting_load(eccentricity: float, slender: float) -> float:
    """Load of a journal at rest over b D eta omega / psi^2, omega being the mean speed of both surfaces: Ocvirk's, less
    by the error of the short bearing."""
    e = eccentricity
    short = slender**2 * e * math.hypot(4.0 * e, math.pi * math.sqrt(1.0 - e * e)) / (1.0 - e * e) ** 2
    return short / (1.0 + short_error(slender, e))


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
    """Force of unbalance and bow on a film, N, with omega rad/s, or with the natural frequency of the shaft, if that is
    lower: a faster rotor turns about its centre of mass. A bow bends a shaft as an unbalance of that eccentricity."""
    shaft = shaft_of(case)
    square = omega**2 if shaft.compliance == 0.0 else min(omega**2, 1.0 / shaft.compliance)
    return shaft.disk_mass * (shaft.eccentricity + shaft.bow) * square / _films(case)


def _films(case: Case) -> int:
    return shaft_of(case).equal_bearings * len(case.bearings)


def run_up_profile(case: Case) -> SpeedProfile:
    """From the first to the last speed of the case, or through its points. Raises InputError for a table over time that
    ends before."""
    times, speeds = case.speed.course
    return _with_tables(case, list(times), list(speeds))


def run_down_profile(case: Case) -> SpeedProfile:
    """Up, hold, and back down (section 7.2.2). Raises InputError for a speed through points, which define the way down
    themselves, for an axial load over time, and for a table over time that ends before."""
    speed = case.speed
    if case.drive is not None:
        whole = case.drive.duration + case.drive.down_duration
        return _with_tables(case, *map(list, case.drive.course(case.polar_inertia, whole)))
    if speed.times:
        problem = "say how the speed goes down, too."
        fault = Fault("speed.points", f"{len(speed.times)} points", None, problem, "Call `frb runup`.")
        raise InputError(case.name or "case", (fault,))
    if case.axial is not None and isinstance(case.axial.load, OverTime):
        problem = "changes over time, and a run-down has each speed twice: a speed has more than one load."
        fault = Fault("axial.load", "over time", None, problem, "Give one load, or one with the square of the speed.")
        raise InputError(case.name or "case", (fault,))
    times, speeds = [0.0, speed.duration], [speed.start, speed.end]
    if speed.hold > 0.0:
        times.append(times[-1] + speed.hold)
        speeds.append(speed.end)
    times.append(times[-1] + speed.down_duration)
    speeds.append(speed.start)
    return _with_tables(case, times, speeds)


def _with_tables(case: Case, times: list[float], speeds: list[float]) -> SpeedProfile:
    """The profile through speeds in Hz at times in s, with kinks of no angle at the rows of tables over time."""
    faults = (*table_faults(case, times[0], times[-1]), *input_faults(case, times[0], times[-1]))
    if faults:
        raise InputError(case.name or "case", faults)
    stops = (*table_times(case).tolist(), *input_times(case), *(() if case.drive is None else case.drive.stops))
    return speed_profile(times, [2 * math.pi * value for value in speeds]).with_stops(stops)
