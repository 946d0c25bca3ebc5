"""A run under way: it is advanced chunk by chunk, tells how far it is, and can be put down and taken up again."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from frbcli.case.schema import Case
from frbcli.film.published.film import PublishedFilm
from frbcli.rotor.excitation import SpeedProfile
from frbcli.scene.cost import expected_cost
from frbcli.scene.plan import Plan
from frbcli.scene.stretches import Stretch
from frbcli.solve.clearance_step import largest_eccentricity, with_clearances
from frbcli.solve.cosimulation import in_turn, micro_cost
from frbcli.solve.error_budget import FIRST, error_budget, quick_budget
from frbcli.solve.film_error import SAMPLES
from frbcli.solve.macro_step import advance_in_turn
from frbcli.solve.march import advance
from frbcli.solve.oil import no_oil_comes_in, oil_passed
from frbcli.solve.published_march import advance_published
from frbcli.solve.run_header import named, ring_names
from frbcli.solve.start import first_state, rotor_data
from frbcli.solve.state import (
    CONTACT,
    ERROR_NOW,
    FINISHED,
    OUTPUTS,
    REJECTED,
    RUNNING,
    SOLVES,
    STEPS,
    TIME,
    TURNS,
    Array,
    Control,
    State,
)
from frbcli.solve.tableau import METHODS

BUFFER = 4096  # output samples between two looks at the clock, at least
BUDGET, CELL_BUDGET = 500, 50  # steps between two looks at the clock: some milliseconds
LONGEST_STEP = 1e-3  # s; a slow rotor still falls, and its shaft still vibrates


@dataclass(frozen=True)
class Progress:
    """What a run tells while it goes on. Times in s, speed in Hz; eccentricity: the largest of all films now."""

    t_s: float
    end_s: float
    speed_Hz: float
    eccentricity: float
    steps: int
    steps_per_revolution: float
    simulated_ms_per_hour: float
    left_s: float


class March:
    """A run under way: the constant parts, the state, the clock.

    Its machine may change on the way (scene/stretches.py): all stretches are there from the beginning, one is current.
    """

    def __init__(self, case: Case, plan: Plan, stretches: Sequence[Stretch], profile: SpeedProfile) -> None:
        self._case, self._plan = case, plan
        self._stretches = [stretch for stretch in stretches if stretch.start < profile.end]
        self._profile = profile.with_stops(stretch.start for stretch in self._stretches)
        self._take_up(0)
        system = self._system
        self._control = control_of(case, plan)
        self._tableau = METHODS[plan.method].tableau
        self._state = first_state(case.start, system, profile)
        self._apart = plan.coupling == "co-simulation"
        if self._apart:
            self._state = in_turn(system, self._state, float(profile.speeds[0]))
        self._advance: Callable[..., Any] = advance_in_turn if self._apart else advance
        if isinstance(system.films, PublishedFilm):
            self._advance = advance_published
        rows = max(BUFFER, 4 * (int(LONGEST_STEP / self._control.output_step) + 2))
        self._q, self._v = np.empty((rows, system.rotor.size)), np.empty((rows, system.rotor.size))
        self._oil = np.empty((rows, len(system.remembering)))
        # States at a few fixed output times, at which the films are solved again on a finer mesh.
        self._sample_every = max(1, int(profile.end / self._control.output_step) // SAMPLES)
        self._samples = np.empty((0, 2 * system.rotor.size + 1))
        self._error_history = FIRST
        self._predicted_cpu_s = expected_cost(case, plan, profile).cpu_s
        self._cpu_s = self._wall_s = 0.0
        self._budget = BUDGET if plan.cells is None else CELL_BUDGET

    def _take_up(self, number: int) -> None:
        """Make a stretch the current one; the time loop sees the profile up to its end."""
        self._current, self._system = number, self._stretches[number].system
        ends = [stretch.start for stretch in self._stretches[number + 1 :]]
        self._rotor = rotor_data(self._system, self._profile.until(ends[0] if ends else self._profile.end))

    def _change(self) -> int:
        """At the end of a stretch: the machine and the state of the next one. Returns the status of the run."""
        before = self._system
        self._take_up(self._current + 1)
        if largest_eccentricity(self._system, self._state) >= self._control.contact_eccentricity:
            return CONTACT  # a shell that closes upon the journal
        self._state = with_clearances(before, self._system, self._profile, self._state, self._apart)
        return RUNNING

    @property
    def time(self) -> float:
        """Time reached, s."""
        return float(self._state.numbers[TIME])

    @property
    def starves(self) -> bool:
        """Whether a film gets no oil, so that a run that cannot go on has run dry."""
        return no_oil_comes_in(self._system)

    def compile(self) -> None:
        """Have the time loop compiled, or found in the cache, before the clock starts."""
        self._advance(
            self._rotor, self._system.films, self._tableau, self._control, self._state, 0, self._q, self._v, self._oil
        )

    def chunk(self) -> tuple[int, dict[str, Array]]:
        """Advance a while. Returns (status, signals of the output times passed)."""
        cpu, wall = time.process_time(), time.perf_counter()
        status, rows = self._advance(
            self._rotor,
            self._system.films,
            self._tableau,
            self._control,
            self._state,
            self._budget,
            self._q,
            self._v,
            self._oil,
        )
        self._cpu_s += time.process_time() - cpu
        self._wall_s += time.perf_counter() - wall
        first = int(self._state.numbers[OUTPUTS]) - rows
        times = (first + np.arange(rows)) * self._control.output_step
        speeds = self._profile.speed(times)
        kept = np.flatnonzero((first + np.arange(rows)) % self._sample_every == 0)
        fresh = np.column_stack([self._q[kept], self._v[kept], speeds[kept]])
        self._samples = np.concatenate([self._samples, fresh])
        self._error_history = np.vstack([self._error_history, self._state.numbers[[TIME, ERROR_NOW]]])
        signals = self._signals(times, speeds, self._q[:rows], self._v[:rows])
        if status == FINISHED and self._current + 1 < len(self._stretches):
            status = self._change()
        return status, signals

    def _signals(self, times: Array, speeds: Array, q: Array, v: Array) -> dict[str, Array]:
        signals = {"time_s": times, "speed_Hz": speeds / (2 * math.pi)}
        system = self._system
        for name, pick, clearance in zip(system.names, system.rotor.journals, system.clearances, strict=True):
            journal = q @ pick.T
            signals[named("eccentricity", name)] = np.hypot(journal[:, 0], journal[:, 1]) / clearance
        for name, pick in system.rotor.points:
            point = q @ pick.T
            signals[f"{name}_x_m"], signals[f"{name}_y_m"] = point[:, 0], point[:, 1]
        for i, name in enumerate(system.names):
            if system.remembering[i]:
                signals[named("oil_fraction", name)] = self._oil[: len(times), i].copy()
        for name, spin in zip(ring_names(system), system.spins, strict=True):
            signals[name] = v[:, spin] / (2 * math.pi)
        return signals

    def snapshot(self) -> dict[str, Array]:
        """All that is needed to go on as if the run had not stopped."""
        clock = np.array([self._cpu_s, self._wall_s])
        history = {"film_samples": self._samples, "error_history": self._error_history}
        return {**self._state._asdict(), **history, "clock": clock}

    def restore(self, checkpoint: dict[str, Array]) -> None:
        """Take up the state of a checkpoint."""
        self._state = State(*(np.array(checkpoint[name]) for name in State._fields))
        self._take_up(sum(stretch.start <= self.time for stretch in self._stretches[1:]))
        self._samples = checkpoint["film_samples"].reshape(-1, 2 * self._system.rotor.size + 1)
        self._error_history = checkpoint["error_history"].reshape(-1, 2)
        self._cpu_s, self._wall_s = (float(value) for value in checkpoint["clock"])

    def cost(self) -> dict[str, float]:
        """What the run has cost so far, without compilation and without tabulating the films."""
        numbers = self._state.numbers
        wall = max(self._wall_s, 1e-9)
        return {
            "cpu_s": self._cpu_s,
            "predicted_cpu_s": self._predicted_cpu_s,
            "wall_s": self._wall_s,
            "steps": int(numbers[STEPS]),
            "rejected_steps": int(numbers[REJECTED]),
            "steps_per_revolution": float(numbers[STEPS] / numbers[TURNS]) if numbers[TURNS] > 0 else math.inf,
            "film_solves": int(numbers[SOLVES]),
            "ms_per_film_solve": 1e3 * self._cpu_s / max(float(numbers[SOLVES]), 1.0),
            "simulated_ms_per_hour": 1e3 * self.time / wall * 3600.0,
            **oil_passed(self._system, self._state),
            **(micro_cost(self._state, self._cpu_s) if self._apart else {}),
        }

    def error_so_far(self) -> dict[str, float | None]:
        """The error of a run that goes on, as far as it costs nothing to know."""
        return quick_budget(self._system, self._state, self._profile.angle(self.time))

    def error(self, events: Iterable[Mapping[str, Any]] = ()) -> dict[str, float | None]:
        """The error of the run: the largest of its stretches."""
        times: Array = self._sample_every * self._control.output_step * np.arange(len(self._samples), dtype=np.float64)
        begins = [stretch.start for stretch in self._stretches[: self._current + 1]]
        budgets = [self.error_so_far()]
        for stretch, first, last in zip(self._stretches, begins, [*begins[1:], math.inf], strict=False):
            there = (times >= first) & (times < last)
            budgets.append(
                error_budget(
                    stretch.case, self._plan, stretch.system, self.time, self._error_history, times[there],
                    self._samples[there], events,
                )
            )  # fmt: skip
        return _largest(budgets)

    def progress(self) -> Progress:
        """For people who wait."""
        numbers = self._state.numbers
        t, end = self.time, self._profile.end
        here = self._system.rotor.journals @ self._state.q / np.array(self._system.clearances)[:, None]
        rate = t / max(self._wall_s, 1e-9)
        return Progress(
            t_s=t,
            end_s=end,
            speed_Hz=float(self._profile.speed(np.array([t]))[0]) / (2 * math.pi),
            eccentricity=float(np.max(np.hypot(here[:, 0], here[:, 1]))),
            steps=int(numbers[STEPS]),
            steps_per_revolution=float(numbers[STEPS] / numbers[TURNS]) if numbers[TURNS] > 0 else math.inf,
            simulated_ms_per_hour=1e3 * 3600.0 * rate,
            left_s=(end - t) / rate if rate > 0 else math.inf,
        )


def _largest(budgets: Sequence[Mapping[str, float | None]]) -> dict[str, float | None]:
    """The largest value of each key, None where it has none."""
    keys = {key: None for budget in budgets for key in budget}
    known = {key: [value for budget in budgets if (value := budget.get(key)) is not None] for key in keys}
    return {key: max(values, default=None) for key, values in known.items()}


def control_of(case: Case, plan: Plan) -> Control:
    """What the case and its plan allow the time loop to do."""
    contact = case.contact
    stiffness = contact.stiffness if contact.policy == "elastic" and contact.stiffness is not None else 0.0
    return Control(
        tolerance=plan.tolerance,
        steps_per_revolution=plan.steps_per_revolution,
        longest_step=LONGEST_STEP if plan.macro_step is None else min(LONGEST_STEP, plan.macro_step),
        output_step=case.output.step,
        contact_eccentricity=contact.eccentricity,
        contact_stiffness=stiffness,
        linearised=plan.coupling == "dynamic-static-semi-implicit",
    )
