"""A run: it is advanced in chunks, reports its progress, and can be stopped and resumed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.compiled import compiled_s, working_time
from frbcli.results.store import Run
from frbcli.rotor.loads import SpeedProfile
from frbcli.runs.error_budget import FewerCells, budget_of_segments, grows_from, quick_budget, summed
from frbcli.runs.films import (
    OF_THE_STEPS,
    KeptFilms,
    RunWear,
    Samples,
    fillings,
    film_signals,
    port_signals,
    tilt_signals,
)
from frbcli.runs.header import FLOW, named, pin_signals, recorded, ring_names
from frbcli.runs.heat import RunAxis, RunHeat
from frbcli.runs.inputs import (
    FilmNumbers,
    RunInputs,
    begin_to_turn,
    brakes,
    drive_signals,
    films_change,
    loop_drive,
    rotation_at,
    rotation_of,
    supplied,
)
from frbcli.runs.interruption import WrongCheckpoint, array, check_samples, restored
from frbcli.runs.start import (
    control_of,
    first_state,
    in_turn,
    largest_eccentricity,
    micro_cost,
    rotor_data,
    with_clearances,
    with_unbalance,
)
from frbcli.scene.cost import expected_cost, film_error_s
from frbcli.scene.coupling import coupling_named
from frbcli.scene.course import expected_course
from frbcli.scene.machine.system import Segment, System, make_segments
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.supply import advised
from frbcli.solve.cosimulation import advance_in_turn
from frbcli.solve.state import (
    CONTACT,
    FINISHED,
    METHODS,
    OUTPUTS,
    REJECTED,
    RUNNING,
    SOLVES,
    STEPS,
    STUCK,
    TIME,
    TURNS,
    LoopOutput,
)
from frbcli.solve.time_loop import NOTES, Notes, advance, advance_watched

BUFFER = 16384  # output samples between two looks at the clock, at least
# Steps between two looks at the clock, which cannot be interrupted: as many as take CHUNK_s.
FIRST_BUDGET, BUDGET, GROWTH = 4, 5000, 8.0
CHUNK_s = 0.1
# After so much of a run, or of its clock in s, its pace is known: the first steps from rest are short.
KNOWN_SHARE, KNOWN_s = 0.01, 1.0
# A run with this many times the expected steps makes no progress and is stopped.
RUNAWAY, FEWEST_STEPS = 100, 2_000_000
UNBOUNDED = 1e6  # displacement over the length of a machine without films from which it counts as unbounded
FARTHEST = 100.0  # clearances that the journals of a checkpoint may be away, also where contact is elastic


@dataclass(frozen=True)
class Progress:
    """The progress of a run. Times in s, speed in Hz; eccentricity: the largest of all films now, NaN without any;
    cpu_s: so far, and over_plan: over what the plan expected until now; for_error: of the second run, from which the
    error follows."""

    t_s: float
    end_s: float
    speed_Hz: float
    eccentricity: float
    steps: int
    steps_per_revolution: float
    simulated_ms_per_hour: float
    left_s: float
    for_error: bool = False
    cpu_s: float = 0.0
    over_plan: float = 0.0


def time_left(t: float, end: float, wall_s: float) -> float:
    """Time in s that a run takes from t in s on, by its pace so far; infinite before that is known."""
    known = t > 0.0 and (t >= KNOWN_SHARE * end or wall_s >= KNOWN_s)
    return wall_s * (end - t) / t if known else math.inf


class March:
    """A run: the constant parts, the state, the clock.

    Its machine may change (scene/machine/system.py): all segments exist from the start, and one is current.
    """

    def __init__(self, case: Case, plan: Plan, segments: Sequence[Segment], profile: SpeedProfile) -> None:
        self._case, self._plan = case, plan
        self._segments = [segment for segment in segments if segment.start < profile.end]
        self._profile = profile.with_stops(segment.start for segment in self._segments)
        self._inputs = RunInputs.of(case, segments[0].system)
        self._touched: float | None = None  # time in s at which a collar touches its pads
        self._take_up(0)
        system = self._system
        self._heat = RunHeat(self._segments[0].case, plan, system)
        self._control = control_of(case, plan, system.asperities)
        self._axis = RunAxis.of(case, self._profile, self._control.output_step) if case.loads_a_collar else None
        self._tableau = METHODS[plan.method].tableau
        with advised(case):
            self._state = first_state(case.start, self._inputs.at_start(self._heat.start), profile)
        begin_to_turn(case, system, self._state)
        self._kept = KeptFilms(case.output.films, system)
        self._wear = RunWear(case.contact.wear_rate, case.output.step, system.bodies)
        self._apart = coupling_named(plan.coupling).in_turn
        if self._apart:
            self._state = in_turn(self._inputs.at_start(self._heat.start), self._state, float(profile.speeds[0]))
        rows = max(BUFFER, 4 * (int(self._control.longest_step / self._control.output_step) + 2))
        self._q, self._v = np.empty((rows, system.rotor.size)), np.empty((rows, system.rotor.size))
        self._oil = np.zeros((rows, len(system.remembering)))
        self._output = LoopOutput(self._q, self._v, self._oil, self._heat.buffer(rows))
        # In addition to the motion, if the run records more of the films than follows from it: see solve/time_loop.py.
        self._watches = self._inputs.limited or any(kind in OF_THE_STEPS for kind in recorded(case))
        self._watches |= brakes(system) and bool(system.names)
        notes = system.rotor.size + NOTES * len(system.names) if self._watches else 0
        self._noted, self._out_noted = np.full(notes, np.nan), np.empty((rows, notes))
        # States at some fixed output times, at which the films are solved again and runs compared.
        self._sample_every = max(1, int(profile.end / self._control.output_step) // system.films.samples)
        warm = 2 * len(system.names) if films_change(case) else 0
        self._samples = np.empty((0, 2 * system.rotor.size + 1 + len(system.remembering) + warm))
        self._expected, self._course = expected_cost(case, plan, profile), expected_course(case, plan, profile)
        self._cpu_s = self._wall_s = 0.0
        self._compiled_s = compiled_s()
        self._budget = FIRST_BUDGET
        self._most_steps = max(FEWEST_STEPS, RUNAWAY * self._expected.steps)

    def _take_up(self, number: int) -> None:
        """Make a segment the current one; the time loop sees the profile up to its end."""
        self._current, self._system = number, self._segments[number].system
        ends = [segment.start for segment in self._segments[number + 1 :]]
        films = self._system.films
        self._ends = films.end_flows if FLOW in self._case.output.signals else ()
        self._far_open = films.far_open
        self._films = films.changeable() if self._inputs.change_films else films
        until = self._profile.until(ends[0] if ends else self._profile.end)
        drive = loop_drive(self._case, self._system)
        self._rotor = rotor_data(self._system, until, self._inputs.loop(self._system), drive)

    def _change(self) -> int:
        """At the end of a segment: the machine and the state of the next one. Returns the status of the run."""
        before, passed = self._warm, self._system
        self._take_up(self._current + 1)
        self._noted[:] = np.nan
        if self._system.films is passed.films:
            self._state = with_unbalance(passed, self._system, self._profile, self._state, self._apart)
            return RUNNING
        self._heat.take_up(self._segments[self._current].case, self._system)
        after = self._warm
        if largest_eccentricity(after, self._state) >= self._control.contact_eccentricity:
            return CONTACT  # the new clearance is below the displacement
        self._state = with_clearances(before, after, self._profile, self._state, self._apart)
        return RUNNING

    @property
    def case(self) -> Case:
        """The case of the run."""
        return self._case

    @property
    def plan(self) -> Plan:
        """The speed profile of the run."""
        return self._plan

    @property
    def system(self) -> System:
        """The current machine."""
        return self._system

    @property
    def _now(self) -> System:
        """The current machine with the clearances that heat has brought about."""
        films = self._system.films
        clearances = self._rotor.clearances[:: films.stations].tolist()
        return replace(self._system, films=replace(films, clearances=tuple(clearances)))

    @property
    def _warm(self) -> System:
        """The current machine at the temperatures of now."""
        return self._heat.warm(self._segments[self._current].case, self._plan, self._system)

    @property
    def _rotation(self) -> tuple[float, float, float]:
        """Angular acceleration, speed and angle of the rotor now, rad and s."""
        return rotation_of(self._system, self._profile, self._state)

    @property
    def samples(self) -> Array:
        """(k, 2 n + 1 + films) states so far at the fixed output times: see film_force_errors, and the mean oil
        fraction of each film, which is of no meaning where it keeps none; with heat clearances and scales behind."""
        return self._samples

    @property
    def time(self) -> float:
        """Time reached, s."""
        return float(self._state.numbers[TIME]) if self._touched is None else self._touched

    @property
    def starves(self) -> bool:
        """Whether a film has no inflow, so that a run without solution has starved."""
        return self._system.films.starving

    def compile(self) -> None:
        """Have the time loop compiled, or found in the cache, before the clock starts."""
        self._go(0)

    def _go(self, budget: int) -> tuple[int, int]:
        """At most `budget` steps. Returns (status, rows of the output written)."""
        films = self._heat.films or self._films
        given = self._rotor, films.loop, self._tableau, self._control, self._state, budget
        if self._apart:
            return advance_in_turn(*given, self._output, self._heat.kind)
        if self._watches:
            notes = Notes(self._noted, self._out_noted, self._far_open)
            return advance_watched(*given, self._output, self._heat.kind, notes)
        return advance(*given, self._output, self._heat.kind)

    def chunk(self) -> tuple[int, dict[str, Array]]:
        """Advance a while. Returns (status, signals of the output times passed)."""
        begun = working_time()
        budget = self._kept.steps(self.time, self._control.longest_step, self._budget)
        status, rows = self._go(budget)
        ended = working_time()
        spent = ended.wall_s - begun.wall_s
        self._cpu_s += ended.cpu_s - begun.cpu_s
        self._wall_s += spent
        self._budget = max(1, min(BUDGET, int(budget * min(GROWTH, CHUNK_s / max(spent, 1e-9)))))
        self._kept.take(self._now, self._state, self._rotation[2])
        first = int(self._state.numbers[OUTPUTS]) - rows
        times: Array = self._control.output_step * (first + np.arange(rows, dtype=np.float64))
        q, v, noted = (each[:rows] for each in (self._q, self._v, self._out_noted))
        samples = Samples(times, q, v, noted, rotation_at(self._system, self._profile, times, q, v, noted))
        speeds = samples.rotation.speeds
        kept = np.flatnonzero((first + np.arange(rows)) % self._sample_every == 0)
        warm = self._numbers(times)
        changed = () if warm is None else (warm.clearances[kept], warm.scales[kept])
        fresh = np.column_stack([self._q[kept], self._v[kept], speeds[kept], self._oil[kept], *changed])
        self._samples = np.concatenate([self._samples, fresh])
        signals = self._signals(samples, speeds) | self._heat.signals(rows)
        ahead = self._segments[self._current + 1 :]
        # The last step of a segment may be the last one of the budget, too: what resumes there finds the next segment.
        if ahead and (status == FINISHED or (status == RUNNING and self.time >= ahead[0].start)):
            status = self._change()
        if status == RUNNING and self._state.numbers[STEPS] > self._most_steps:
            status = STUCK
        if status == RUNNING and not self._system.names and self._grown() > UNBOUNDED:
            status = STUCK
        touch = None if self._axis is None else self._axis.touch(signals)
        if touch is not None:
            status, self._touched = CONTACT, float(times[touch])
            signals = {name: values[: touch + 1] for name, values in signals.items()}
        return status, signals

    def _grown(self) -> float:
        """Largest displacement of a point over the length of a machine without films, where no shell ends the motion
        of an unstable rotor."""
        places = (selection @ self._state.q for _, selection in self._system.rotor.points)
        return max(float(np.hypot(*place)) for place in places) / self._system.length

    def _signals(self, samples: Samples, speeds: Array) -> dict[str, Array]:
        times, q, v, system = samples.times, samples.q, samples.v, self._system
        signals = {"time_s": times, "speed_Hz": speeds / (2 * math.pi)}
        clearances = self._heat.clearances(len(times)) or system.clearances
        films = zip(system.names, system.rotor.journals, clearances, system.films.standing, strict=True)
        for name, selection, clearance, standing in films:
            journal = q @ selection.T + standing
            signals[named("eccentricity", name)] = np.hypot(journal[:, 0], journal[:, 1]) / clearance
        for name, selection in system.rotor.points:
            point = q @ selection.T
            signals[f"{name}_x_m"], signals[f"{name}_y_m"] = point[:, 0], point[:, 1]
        signals |= tilt_signals(system, q)
        for i, name in enumerate(system.names):
            if system.remembering[i]:
                signals[named("oil_fraction", name)] = self._oil[: len(times), i].copy()
        for name, spin in ring_names(system).items():
            signals[name] = v[:, spin] / (2 * math.pi)
        signals |= pin_signals(system, q, v) | port_signals(system, samples)
        kinds, warm = recorded(self._case), self._numbers(times)
        self._wear.add(system, warm, samples)
        signals |= self._inputs.signals(system, times, fillings(system, samples))
        signals |= {} if self._axis is None else self._axis.signals(times, speeds, q)
        signals |= drive_signals(self._rotor.drive, times, speeds)
        return signals | film_signals(system, self._control, samples, kinds, self._ends, warm)

    def _numbers(self, times: Array) -> FilmNumbers | None:
        """The numbers of the films that change, in the rows that the loop has written."""
        return supplied(self._system, self._heat.numbers(len(times)), self._inputs.shares(times))

    def snapshot(self) -> dict[str, Array]:
        """The checkpoint, from which the run continues with the same result."""
        clock = np.array([self._cpu_s, self._wall_s])
        noted = {"noted": self._noted} if self._watches and not np.isnan(self._noted).any() else {}
        others = {**noted, **self._wear.snapshot(), **self._heat.snapshot(), **self._kept.snapshot()}
        return {**self._state._asdict(), **others, "film_samples": self._samples, "clock": clock}

    def restore(self, checkpoint: Mapping[str, Array]) -> None:
        """Take up the state of a checkpoint. Raises WrongCheckpoint if it is not one of this run."""
        state = restored(checkpoint, self._state, self._profile, self._control.output_step)
        rows = math.ceil(state.numbers[OUTPUTS] / self._sample_every)
        samples = array(checkpoint, "film_samples", (rows, self._samples.shape[1]))
        clock = array(checkpoint, "clock", (2,))
        if self._watches and "noted" in checkpoint:
            self._noted = array(checkpoint, "noted", self._noted.shape)
        self._state, self._samples = state, samples
        self._take_up(sum(segment.start <= self.time for segment in self._segments[1:]))
        if not np.all(self._now.eccentricities(state.q) <= FARTHEST):
            raise WrongCheckpoint("its journals are outside of their bearings")
        self._heat.take_up(self._segments[self._current].case, self._system)
        self._heat.restore(checkpoint)
        self._wear.restore(checkpoint)
        self._kept.restore(checkpoint, self.time)
        self._cpu_s, self._wall_s = (float(value) for value in clock)

    def check_samples(self, run: Run) -> None:
        """Raise WrongCheckpoint unless the samples of a run lead up to the restored state."""
        is_free = self._system.rotation is not None
        check_samples(run, int(self._state.numbers[OUTPUTS]), self._profile, self._control.output_step, is_free)

    def cost(self) -> dict[str, float]:
        """The cost of the run so far, compilation apart and without tabulating the films."""
        numbers = self._state.numbers
        wall = max(self._wall_s, 1e-9)
        return {
            "cpu_s": self._cpu_s,
            "error_cpu_s": 0.0,  # known when the run has ended
            "compile_cpu_s": compiled_s() - self._compiled_s,  # of this process
            "predicted_cpu_s": self._expected.cpu_s,
            "wall_s": self._wall_s,
            "steps": int(numbers[STEPS]),
            "rejected_steps": int(numbers[REJECTED]),
            "steps_per_revolution": float(numbers[STEPS] / numbers[TURNS]) if numbers[TURNS] > 0 else math.inf,
            "film_solves": int(numbers[SOLVES]),
            "ms_per_film_solve": 1e3 * self._cpu_s / max(float(numbers[SOLVES]), 1.0),
            "simulated_ms_per_hour": 1e3 * self.time / wall * 3600.0,
            **self._system.films.oil_passed(self._state.flows),
            **self._heat.passed(),
            **self._wear.deepest(),
            **(micro_cost(self._state, self._cpu_s) if self._apart else {}),
        }

    def error_so_far(self) -> dict[str, float | None]:
        """The part of the error that is known during a run."""
        known = quick_budget(self._now, self._state, self._rotation[2])
        return {**known, **self._heat.balance()}

    def again(self, plan: Plan) -> March:
        """This run from its beginning, by another plan. Raises NotConverged if it does not begin."""
        return March(self._case, plan, make_segments(self._case, plan), self._profile)

    def error(self, until: float, fewer: FewerCells | None = None) -> dict[str, float | None]:
        """The error of the run, point by point until a time in s: the largest of its segments. fewer: the same run on
        fewer cells."""
        steps = summed(self._state.errors, until / self._profile.end)
        times: Array = self._sample_every * self._control.output_step * np.arange(len(self._samples), dtype=np.float64)
        passed = self._segments[: self._current + 1]
        errors = budget_of_segments(self.error_so_far(), passed, self._plan, until, steps, times, self._samples, fewer)
        if fewer is not None and len(passed) == 1:
            errors["error_grows_from_s"] = grows_from(
                self._now, self._state.errors, fewer, times, self._samples, until, self._profile.end
            )
        return errors

    @property
    def film_error_s(self) -> float:
        """Expected CPU time of the error of the film forces."""
        return film_error_s(self._case, self._plan)

    def progress(self, until: float | None = None) -> Progress:
        """The progress of the run. until: end in s of a run that is repeated for its error."""
        numbers = self._state.numbers
        t, end = self.time, self._profile.end if until is None else until
        here = self._now.eccentricities(self._state.q)
        rate, left = t / max(self._wall_s, 1e-9), time_left(t, end, self._wall_s)
        return Progress(
            t_s=t,
            end_s=end,
            speed_Hz=self._rotation[1] / (2 * math.pi),
            eccentricity=float(np.max(here)) if len(here) else math.nan,
            steps=int(numbers[STEPS]),
            steps_per_revolution=float(numbers[STEPS] / numbers[TURNS]) if numbers[TURNS] > 0 else math.inf,
            simulated_ms_per_hour=1e3 * 3600.0 * rate,
            left_s=left,
            for_error=until is not None,
            cpu_s=self._cpu_s,
            over_plan=self._cpu_s / max(self._expected.cpu_s * self._course.share(t), 1e-9),
        )
