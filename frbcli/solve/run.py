"""Run-up and run-down: from a case to a run file."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.results.store import Run, RunWriter, check_output, read_run
from frbcli.rotor.excitation import SpeedProfile
from frbcli.scene.cost import ExpectedCost, expected_cost
from frbcli.scene.limits import require_affordable
from frbcli.scene.plan import Plan, make_plan
from frbcli.scene.stretches import make_stretches
from frbcli.scene.system import run_down_profile, run_up_profile
from frbcli.solve.error_budget import quiet_until
from frbcli.solve.fewer_cells import on_fewer_cells
from frbcli.solve.interrupt import held_back
from frbcli.solve.run_header import header
from frbcli.solve.state import CONTACT, FINISHED, RUNNING
from frbcli.solve.under_way import March, Progress

CHECKPOINT_EVERY_s = 2.0
CHECKPOINT_SHARE = 0.05  # of the wall time that writing may take
PROFILES = {"runup": run_up_profile, "rundown": run_down_profile}
STATUS, STARVED = {FINISHED: "finished", CONTACT: "contact"}, "starved"

Observer = Callable[[Progress], None]


def runup(case: Case, output: str | Path, resume: bool = False, observe: Observer | None = None) -> Run:
    """Run the rotor of a case up as its [speed] says and write the run to `output` (HDF5) as it goes.

    resume: go on with an interrupted run of the same case in `output`. observe: called some times a second.
    Raises InputError for a case that cannot be modelled or afforded, or an output that cannot be written. Any end for a
    physical or numerical reason is the status of the run: "finished", "contact", "starved", "not-converged"; Ctrl-C
    ends it as "interrupted".
    """
    return _run("runup", case, output, resume, observe)


def rundown(case: Case, output: str | Path, resume: bool = False, observe: Observer | None = None) -> Run:
    """Run up, hold, and run down again (section 7.2.2); otherwise as runup."""
    return _run("rundown", case, output, resume, observe)


def run_cost(command: str, case: Case) -> ExpectedCost:
    """What a "runup" or "rundown" of a case is expected to cost. Raises InputError for a case that cannot be modelled
    or afforded."""
    return _planned(command, case)[2]


def _planned(command: str, case: Case) -> tuple[Plan, SpeedProfile, ExpectedCost]:
    plan, profile = make_plan(case), PROFILES[command](case)
    cost = expected_cost(case, plan, profile)
    require_affordable(case, plan, cost)
    return plan, profile, cost


def _run(command: str, case: Case, output: str | Path, resume: bool, observe: Observer | None) -> Run:
    plan, profile, _ = _planned(command, case)
    check_output(Path(output))
    earlier = _earlier(command, case, Path(output)) if resume else None
    if earlier is not None and earlier.status != "interrupted":
        return earlier
    stretches = make_stretches(case, plan)
    march = March(case, plan, stretches, profile)
    if earlier is not None and earlier.checkpoint is not None:
        writer = RunWriter.resume(output)
        march.restore(earlier.checkpoint)
    else:
        writer = RunWriter(output, header(command, case, stretches))
    march.compile()
    return _go(march, writer, observe)


def _go(march: March, writer: RunWriter, observe: Observer | None) -> Run:
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
        checkpoint(march.error(march.time) if status == RUNNING else march.error_so_far())
    if status == RUNNING:
        return writer.so_far()
    from frbcli.analysis.events import find_events  # scipy.signal takes longer to import than a short run

    ended = STATUS.get(status, "not-converged")
    if status != FINISHED and march.starves:
        ended = STARVED
    so_far = writer.so_far(ended)
    events = [asdict(event) for event in find_events(so_far)]
    until, began = quiet_until(events, march.time), time.process_time()
    error = march.error(until, on_fewer_cells(march, until, observe))
    cost = {**so_far.cost, "error_cpu_s": time.process_time() - began}
    return writer.finish(ended, cost, error, events, march.time)


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
