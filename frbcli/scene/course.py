"""Expected course of a run: how many steps it takes and how many film solves, and when.

Before a whirl the journal moves little: a film needs few steps per revolution, and the guess of each stage is nearly
its solution. In a whirl the journal moves through most of the gap. Where half the rotor speed comes near to the natural
frequency of a stiff shaft, the whirl presses the journal into the shell. A mass-conserving film without inflow is never
quiet: it runs nearly dry and whirls from the start, and the fronts of its oil cross cells.

All numbers were measured on the shipped cases and on `jeffcott` with each cavitation law; docs/accuracy.md compares
predicted and real cost.

What the steps of a run resolve of loads and inputs that change with time, what its samples show of them, and the length
that displacements of a machine without films are compared with, instead of a clearance.

Steps end at the rows of a table, so that each row is followed; between rows a table is a line. The samples of a run
file show frequencies below half of their rate.

The speeds at which machines at rest are computed where none are asked for.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.case.reading.time_tables import inputs_of
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.table import law_named
from frbcli.film.section_faults import no_inflow
from frbcli.rotor.assembly import LinearRotor, held_rotor
from frbcli.rotor.loads import SpeedProfile, speed_profile
from frbcli.scene.coupling import coupling_named
from frbcli.scene.films import film_places, film_section, rings, turning_rings, turns_with_oil
from frbcli.scene.gate.rule import run_omega
from frbcli.scene.machine.rotor import harmonics_of, make_rotor, tables_of
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.film_choice import Decision, Plan, form_of

SPEEDS, SPEEDS_WITH_MEMORY = 60, 20  # 5 and 15 Hz apart from 0 to 300 Hz


def default_speeds(case: Case, count: int | None = None) -> tuple[float, ...]:
    """Speeds in Hz, greater than zero, that sweep the range of the case; fewer where a film keeps oil, whose memory
    takes longer to compute, or follows the tilt of its journal."""
    count = count or (SPEEDS_WITH_MEMORY if keeps_oil(case) or form_of(case).static_cells else SPEEDS)
    low, high = sorted((case.speed.start, case.speed.end))
    if low > 0.0:
        return tuple(np.unique(np.linspace(low, high, count)).tolist())
    return tuple(np.linspace(0.0, high, count + 1)[1:].tolist()) if high > 0.0 else ()


def keeps_oil(case: Case) -> bool:
    """Whether a film of the case is mass-conserving."""
    return form_of(case).solved and any(law_named(name).keeps_oil for name in case.cavitations)


STAGES = {"trbdf2": 2, "esdirk3": 3, "esdirk4": 5}  # implicit ones of a step
ERROR_ORDERS = {"trbdf2": 3, "esdirk3": 3, "esdirk4": 4}  # powers of the step size in the local error


RING_SOLVES = 1.5  # of a stage, of a finite-volume film at a ring that keeps no oil
# Steps of a journal that a whirl presses into an elastic shell over the steps of one that it presses into the oil
# alone: 1.3 to 3.4.
ELASTIC = 1.7
LONGEST_STEP_s = 1e-3  # of a run: also at low speed the rotor falls and its shaft vibrates
MOST_SAMPLES = 1000  # that a step may pass: what a run holds in memory before it writes them
SMOOTH = 7.0  # radians of a motion as large as the clearance that a step with a tolerance of 1 may pass
HARMONICS = 1.2  # frequency of a large whirl, with its harmonics, over the rotor speed
FADING = 0.01  # damping ratio of the vibration that a rotor begins with as it falls from the centre
# A whirl begins at this multiple of the frequency of the rotor on its shaft and on films of the stiffness load over
# clearance: 1.8 to 3.0 as measured.
WHIRL = 2.7
# Revolutions above that speed until a whirl has come near the shell, 30 to 80 as measured, and until it presses the
# journal into it: runs of 150 from 282 Hz on did not get there.
GROWN, PRESSED = 40.0, 280.0
NEAR = 0.9  # half the rotor speed over the natural frequency of the shaft, from where on it counts as near
TABLE_POINTS = 400  # of the speed profile
SLOWEST_Hz = 1e-6  # rotor speed below which revolutions are not counted


@dataclass(frozen=True)
class RunCourse:
    """times: (k,) s; steps, solves: (k,) numbers until then, solves summed over all films."""

    times: Array
    steps: Array
    solves: Array

    def share(self, time: float) -> float:
        """Share of the film solves until a time in s, without films of the steps."""
        done = self.solves if self.solves[-1] > 0.0 else self.steps
        return float(np.interp(time, self.times, done) / max(done[-1], 1e-300))


def expected_course(case: Case, plan: Plan, profile: SpeedProfile) -> RunCourse:
    """Expected course of a run along a speed profile: a number of steps per revolution, per second at low speed, or
    that which the tolerance needs."""
    times = np.linspace(profile.times[0], profile.end, TABLE_POINTS)
    omega = np.abs(profile.speed(times))
    turns = omega / (2.0 * math.pi)
    work, slowest = plan.form.work, whirl_speed(case)
    since = _summed(np.where(omega >= slowest, turns, 0.0), times)  # revolutions; what whirls from the start has grown
    whirls = (omega >= slowest) & ((since >= GROWN) | (slowest == 0.0))
    presses = whirls & (omega >= _pressing_speed(case)) & ((since >= PRESSED) | (slowest == 0.0))
    rate = np.maximum(1.0 / longest_step(case, plan), work.crowded * steps_of_a_turn(case, plan) * turns)
    pieces = np.clip(np.searchsorted(profile.times, times, side="right") - 1, 0, len(profile.times) - 2)
    rate = np.maximum(rate, 1.0 / np.diff(profile.times)[pieces])  # a step ends at each kink of the profile
    rate = np.maximum(rate, _resolving(case, plan, times, omega, whirls))
    pressed_steps, pressed_solves = plan.form.pressed(plan)
    pressed_steps *= ELASTIC if case.contact.gives_way else 1.0
    rate = np.where(presses, pressed_steps * rate, rate)
    iterations = _solves_of_a_stage(case, plan, whirls, rate / np.maximum(turns, SLOWEST_Hz))
    iterations = np.where(presses, pressed_solves * iterations, iterations)
    coupling = coupling_named(plan.coupling)
    if coupling.once:
        iterations = np.ones_like(rate)
    films = len(film_places(case)) * coupling.film_steps
    solves = rate * STAGES[plan.method] * iterations * films
    return RunCourse(times, _summed(rate, times), _summed(solves, times))


def longest_step(case: Case, plan: Plan) -> float:
    """Longest step of a run, s; limited by the periods of loads, and by the samples that are held in memory until they
    are written."""
    longest = LONGEST_STEP_s if plan.macro_step is None else min(LONGEST_STEP_s, plan.macro_step)
    fastest = max((abs(load.frequency) for load in harmonics_of(case)), default=0.0)
    if fastest > 0.0:
        longest = min(longest, 2.0 * math.pi / (plan.steps_per_revolution * fastest))
    return min(longest, MOST_SAMPLES * case.output.step)


def steps_of_a_turn(case: Case, plan: Plan) -> float:
    """Least steps per revolution: as many in a period of the highest order of the loads, too."""
    return plan.steps_per_revolution * max([1.0, *(abs(load.order) for load in harmonics_of(case))])


def whirl_speed(case: Case) -> float:
    """Rotor speed in rad/s from which a whirl is expected; 0 where nothing keeps the journal from it: rings, films
    that do not cavitate, films that run dry, a rotor without weight."""
    rotor, places = case.rotor, film_places(case)
    if not places:
        return math.inf
    free = rings(case) or runs_nearly_dry(case) or rotor.gravity == 0.0
    if form_of(case).solved:
        free = free or any(not law_named(name).cavitates for name in case.cavitations)
    if free:
        return 0.0
    square = max(place.geometry.clearance for place in places) / rotor.gravity + shaft_of(case).compliance
    return WHIRL / math.sqrt(square)


def runs_nearly_dry(case: Case) -> bool:
    """Whether a film is mass-conserving and no pressure pushes oil into it, nor draws it in."""
    return bool(_dry_laws(case))


def _dry_laws(case: Case) -> tuple[type[Law], ...]:
    """The laws of the films that run nearly dry."""
    if not form_of(case).solved:
        return ()
    laws = ((law_named(case.cavitation(place.geometry)), place) for place in film_places(case))
    return tuple(
        law
        for law, place in laws
        if law.keeps_oil and law.starves and no_inflow(film_section(case, place.geometry, place.feed_holes))
    )


def _pressing_speed(case: Case) -> float:
    """Rotor speed in rad/s from which a whirl comes near to the natural frequency of the shaft; infinite for a shaft so
    soft that its sag is larger than the clearance, which cannot press, for rotors without such a shaft or on rings,
    and for films that run nearly dry, which their fronts keep at short steps all along."""
    compliance = shaft_of(case).compliance
    if not compliance or not case.films or rings(case) or runs_nearly_dry(case):
        return math.inf
    stiff = case.rotor.gravity * compliance < film_places(case)[0].geometry.clearance
    return 2.0 * NEAR / math.sqrt(compliance) if stiff else math.inf


def _solves_of_a_stage(case: Case, plan: Plan, whirls: NDArray[np.bool_], per_turn: Array) -> Array:
    """(n,) of one film. per_turn: steps per revolution."""
    work = plan.form.work
    if turning_rings(case) and not any(law_named(name).keeps_oil for name in case.cavitations):
        return np.full_like(per_turn, RING_SOLVES)
    turning = any(turns_with_oil(case, place) for place in film_places(case))
    solves = plan.form.solves_of_a_stage(plan, per_turn, turning)
    return np.where(whirls, work.whirling, work.quiet) if solves is None else solves


def _resolving(case: Case, plan: Plan, times: Array, omega: Array, whirls: NDArray[np.bool_]) -> Array:
    """(n,) steps per second that the tolerance needs at the rotor speeds omega (n,) in rad/s.

    The local error of a motion A cos(w t) is A (w h / SMOOTH)^p of a method with an embedded solution of order p - 1.
    """
    shaft, order = shaft_of(case), ERROR_ORDERS[plan.method]
    clearance = film_places(case)[0].geometry.clearance if case.films else plan.length

    def steps(w: Array | float, size: Array | float) -> Array:
        return np.asarray(w / SMOOTH * (size / (plan.tolerance * clearance)) ** (1.0 / order), dtype=np.float64)

    turned = shaft.eccentricity + shaft.bow
    rate = np.maximum(steps(omega, turned), np.where(whirls, steps(HARMONICS * omega, clearance), 0.0))
    if shaft.compliance and case.start.position == "centre":  # it falls to its static equilibrium
        natural = 1.0 / math.sqrt(shaft.compliance)
        left = np.exp(-FADING * natural * (times - times[0]))
        rate = np.maximum(rate, steps(natural, case.rotor.gravity * shaft.compliance * left))
    if runs_nearly_dry(case):
        fronts = shaft.fronts * max(law.fronts for law in _dry_laws(case))
        rate = np.maximum(rate, plan.form.steps_at_fronts(plan, fronts) * omega / (2.0 * math.pi))
    return rate


def _summed(rate: Array, times: Array) -> Array:
    passed = np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(times))
    return np.concatenate([[0.0], passed])


CONTENT = 0.01  # of the largest amplitude in a table: below it a frequency does not count
ROUND_OFF = 1e-9
EVEN = 0.01  # share by which the intervals of an even table differ
CHOICE = "resolution"


def resolution_decisions(case: Case, plan: Plan) -> Iterator[Decision]:
    """How well the steps that are expected at the top speed resolve each load and each input over time."""
    tables = [(load.name, load.times, load.factors(load.times, load.times)) for load in tables_of(case)]
    tables += [(each.key, np.array(each.values.time), np.array([each.values.x]).T) for each in inputs_of(case)]
    harmonics = harmonics_of(case)
    if not (tables or harmonics):
        return
    omega = run_omega(case)
    step = 1.0 / float(expected_course(case, plan, speed_profile([0.0, 1.0], [omega, omega])).steps[-1])
    shown = 0.5 / case.output.step
    for load in harmonics:
        frequency = abs(load.order * omega + load.frequency) / (2.0 * math.pi)
        if frequency > 0.0:
            reason = f"{1.0 / (frequency * step):.0f} steps in a period{_unseen(frequency, shown)}"
            yield Decision(CHOICE, f"{load.name}: {frequency:.4g} Hz", reason)
    for name, times, values in tables:
        yield Decision(CHOICE, *_of_table(name, times, values, step, shown))


def _of_table(name: str, times: Array, values: Array, step: float, shown: float) -> tuple[str, str]:
    """Value and reason of the decision about a table."""
    shortest = float(np.diff(times).min())
    size = f"{name}: {len(times)} rows, at least {shortest:.4g} s apart"
    if shortest >= step:
        reason = f"{shortest / step:.0f} steps of {step:.2g} s between them at the top speed"
    else:
        reason = f"closer than the steps of {step:.2g} s at the top speed, which end at each row: more steps"
    highest = highest_frequency(times, values)
    if highest > 0.0:
        reason += f"; content up to {highest:.3g} Hz{_unseen(highest, shown)}"
    return size, reason


def _unseen(frequency: float, shown: float) -> str:
    """A remark on a frequency that the samples of a run do not show."""
    if frequency <= shown:
        return ""
    return f", above the {shown:.3g} Hz that samples of output.step show"


def highest_frequency(times: Array | Sequence[float], values: Array) -> float:
    """Highest frequency in Hz in a table (k, columns) of even times (k,) in s with CONTENT of its largest amplitude, a
    line between its ends left out; 0 for uneven times."""
    steps = np.diff(times)
    if len(steps) < 8 or np.abs(steps - steps.mean()).max() > EVEN * steps.mean():
        return 0.0
    k = len(values)
    line = values[0] + np.linspace(0.0, 1.0, k)[:, None] * (values[-1] - values[0])
    spectrum = np.abs(np.fft.rfft((values - line) * np.hanning(k)[:, None], axis=0)).max(axis=1)
    counts = np.flatnonzero(spectrum > max(CONTENT * spectrum.max(), ROUND_OFF * k * np.abs(values).max()))
    return float(counts[-1] / (k * steps.mean())) if len(counts) else 0.0


SMALLEST = 1e-9  # m: of a rotor that neither its weight nor an unbalance moves
LARGEST = 1.0  # m: bearings that let the rotor sag further do not hold it
SAGS, TURNS, LEAST = "the largest static deflection", "the unbalance over the mass", "the least that is taken"
LOADED = "the largest static deflection under a load that changes"


def reference_length(case: Case) -> tuple[float, str]:
    """Length in m, and which one it is: the largest static deflection of a point of a run at the first and the last
    speed, under the static load or another load at its largest, or the unbalance over the mass if that is larger, at
    least SMALLEST."""
    rotor = make_rotor(case)
    speeds = [2.0 * math.pi * speed for speed in (case.speed.start, case.speed.end)]
    sag = max(_sag(rotor, omega) for omega in speeds)
    pushed = (replace(rotor, static_load=column) for load in rotor.loads for column in load.largest)
    loaded = max((_sag(each, omega) for each in pushed for omega in speeds), default=0.0)
    return max((sag, SAGS), (loaded, LOADED), (shaft_of(case).eccentricity, TURNS), (SMALLEST, LEAST))


def _sag(rotor: LinearRotor, omega: float) -> float:
    """m; 0 where the bearings do not hold the rotor."""
    try:
        shape = held_rotor(rotor, omega).shape
    except NotConverged:
        return 0.0
    deflection = max((float(np.hypot(*(place @ shape))) for _, place in rotor.points), default=0.0)
    return deflection if deflection < LARGEST else 0.0
