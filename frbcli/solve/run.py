"""Run-up and run-down: from a case to a run file."""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.published.film import PublishedFilm
from frbcli.results.store import Header, Run, RunWriter, check_output, read_run
from frbcli.rotor.excitation import SpeedProfile
from frbcli.scene.cost import expected_cost
from frbcli.scene.plan import Plan, make_plan
from frbcli.scene.system import System, make_system, run_down_profile, run_up_profile
from frbcli.solve.cosimulation import in_turn, micro_cost
from frbcli.solve.error_budget import FIRST, error_budget, quick_budget
from frbcli.solve.film_error import SAMPLES
from frbcli.solve.interrupt import held_back
from frbcli.solve.macro_step import advance_in_turn
from frbcli.solve.march import advance
from frbcli.solve.oil import no_oil_comes_in, oil_passed
from frbcli.solve.published_march import advance_published
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
CHECKPOINT_EVERY_s = 2.0
CHECKPOINT_SHARE = 0.05  # of the wall time that writing may take
STATUS, STARVED = {FINISHED: "finished", CONTACT: "contact"}, "starved"
PACKAGES = ("numpy", "scipy", "numba", "scikit-fem", "h5py")
PROGRAM = "frbcli"


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


Observer = Callable[[Progress], None]


def runup(case: Case, output: str | Path, resume: bool = False, observe: Observer | None = None) -> Run:
    """Run the rotor of a case up as its [speed] says and write the run to `output` (HDF5) as it goes.

    resume: go on with an interrupted run of the same case in `output`. observe: called some times a second.
    Raises InputError for a case that cannot be modelled or an output that cannot be written. Any end for a physical or
    numerical reason is the status of the run: "finished", "contact", "starved", "not-converged"; Ctrl-C ends it
    as "interrupted".
    """
    return _run("runup", case, run_up_profile(case), output, resume, observe)


def rundown(case: Case, output: str | Path, resume: bool = False, observe: Observer | None = None) -> Run:
    """Run up, hold, and run down again (section 7.2.2); otherwise as runup."""
    return _run("rundown", case, run_down_profile(case), output, resume, observe)


def _run(
    command: str, case: Case, profile: SpeedProfile, output: str | Path, resume: bool, observe: Observer | None
) -> Run:
    plan = make_plan(case)
    check_output(Path(output))
    earlier = _earlier(command, case, Path(output)) if resume else None
    if earlier is not None and earlier.status != "interrupted":
        return earlier
    system = make_system(case, plan)
    march = _March(case, plan, system, profile)
    if earlier is not None and earlier.checkpoint is not None:
        writer = RunWriter.resume(output)
        march.restore(earlier.checkpoint)
    else:
        writer = RunWriter(output, _header(command, case, system))
    march.compile()
    return _go(march, writer, observe)


def _go(march: _March, writer: RunWriter, observe: Observer | None) -> Run:
    """March to the end or to Ctrl-C; checkpoints are spaced so that writing takes a small share of the time."""

    def checkpoint(error: dict[str, float | None]) -> None:
        writer.checkpoint(march.snapshot(), march.cost(), error, march.time)

    status, saved, pause = RUNNING, time.monotonic(), CHECKPOINT_EVERY_s
    # An interruption between a step and its samples would tear them apart.
    with held_back() as interrupt:
        while status == RUNNING and not interrupt.asked:
            status, signals = march.chunk()
            writer.append(signals)
            if observe is not None:
                observe(march.progress())
            if status == RUNNING and time.monotonic() - saved > pause:
                began = time.monotonic()
                checkpoint(march.error_so_far())
                saved = time.monotonic()
                pause = max(CHECKPOINT_EVERY_s, (saved - began) / CHECKPOINT_SHARE)
        # The state stays in the file: what a run ended with can be looked at, and a longer run can start from it.
        checkpoint(march.error() if status == RUNNING else march.error_so_far())
    if status == RUNNING:
        return writer.so_far()
    from frbcli.analysis.events import find_events  # scipy.signal takes longer to import than a short run

    ended = STATUS.get(status, "not-converged")
    if status != FINISHED and march.starves:
        ended = STARVED
    so_far = writer.so_far(ended)
    events = [asdict(event) for event in find_events(so_far)]
    return writer.finish(ended, so_far.cost, march.error(events), events, march.time)


class _March:
    """A run under way: the constant parts, the state, the clock."""

    def __init__(self, case: Case, plan: Plan, system: System, profile: SpeedProfile) -> None:
        self._case, self._plan, self._system, self._profile = case, plan, system, profile
        self._rotor = rotor_data(system, profile)
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
        return status, self._signals(times, speeds, self._q[:rows], self._v[:rows])

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
        """The error of the run."""
        times: Array = self._sample_every * self._control.output_step * np.arange(len(self._samples), dtype=np.float64)
        return {
            **self.error_so_far(),
            **error_budget(
                self._case, self._plan, self._system, self.time, self._error_history, times, self._samples, events
            ),
        }

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


def named(quantity: str, film: str) -> str:
    """The name of a signal of a film or ring, which may be the only one."""
    return f"{quantity}_{film}" if film else quantity


def ring_names(system: System) -> list[str]:
    """The signals of the rings' speeds."""
    outer = [name for name, (inside, _) in zip(system.names, system.bodies, strict=True) if inside >= 0]
    return [f"{named('ring_speed', name.removesuffix('outer').rstrip('_'))}_Hz" for name in outer]


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


def _header(command: str, case: Case, system: System) -> Header:
    lengths = [f"{name}_{axis}_m" for name, _ in system.rotor.points for axis in "xy"]
    eccentricities = [named("eccentricity", name) for name in system.names]
    units = {"time_s": "s", "speed_Hz": "Hz", **dict.fromkeys(eccentricities, ""), **dict.fromkeys(lengths, "m")}
    remembering = [name for name, keeps in zip(system.names, system.remembering, strict=True) if keeps]
    units |= dict.fromkeys((named("oil_fraction", name) for name in remembering), "")
    units |= dict.fromkeys(ring_names(system), "Hz")
    return Header(
        title=case.title or case.name,
        command=command,
        case_name=case.name,
        case_text=case.source_text,
        units=units,
        versions={PROGRAM: _version(PROGRAM), "python": platform.python_version()}
        | {package: _version(package) for package in PACKAGES},
        references={"contact_eccentricity": case.contact.eccentricity, "clearance_m": system.clearances[0]}
        | {named("clearance_m", name): length for name, length in zip(system.names, system.clearances, strict=True)},
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # run from a checkout that is not installed
        return "unknown"


def _earlier(command: str, case: Case, path: Path) -> Run | None:
    """The run in `path` if it is one of this case; None if there is no file yet."""
    if not path.exists():
        return None
    run = read_run(path)
    if (run.command, run.case_text) != (command, case.source_text):
        name = run.case_name or "unnamed"
        problem = f"holds a {run.command} of another case ({name}) or of this one with other keys."
        remedy = "Give the case and the --set of that run, or another --output."
        raise InputError(str(path), (Fault("--resume", str(path), None, problem, remedy),))
    return run
