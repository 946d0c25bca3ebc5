"""`frb runup` and `frb rundown`: options, live progress, the closing table, the JSON document, the exit code."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from frbcli.cli.common import Terminal, case_argument, output_options, wrapped
from frbcli.cli.options import RUN_FILE, Command, check_outputs, force_option, gathered, here, look_options, next_to
from frbcli.cli.progress import Display, LONGEST_LEFT_s, computing, display, draw, picture_switch, progress_line
from frbcli.columns import table_of
from frbcli.errors import FrbError

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.results.store import Run
    from frbcli.runs.march import Progress
    from frbcli.runs.run import Observer
    from frbcli.scene.cost import ExpectedCost

Function = TypeVar("Function", bound=Callable[..., Any])
Transient = Callable[..., "Run"]

EXIT_CODES = {"finished": 0, "standstill": 0, "input-error": 2, "interrupted": 130}
ENDED_EARLY = 3  # for any other reason, which is named
SUMMARY = "-summary.png"
SHOWN_s, SHOWN_BEFORE_s = 30.0, 5.0  # CPU time from which on it is said before a run, and of it before the first step
SLOW_AFTER_s, SLOWER = 5.0, 3.0  # CPU time after which a run may be called slow, and times its plan's that is


@dataclass(frozen=True)
class RunOptions:
    """The options of a run, see run_options."""

    output: Path | None
    resume: bool
    force: bool
    picture: bool
    verify: bool
    explain: bool
    uncertainty: bool


def run_options(function: Function) -> Function:
    """Give a command the options of a run; it receives `options: RunOptions`."""
    output = click.option(
        "-o", "--output", type=RUN_FILE, metavar="RUN.h5", show_default="CASE.h5, here", help="Run file."
    )
    resume = click.option("--resume", is_flag=True, help="Resume an interrupted run in the run file.")
    force = force_option("Replace the run in the run file, and a picture that frb did not write.", exposed=True)
    verify = click.option(
        "--verify", is_flag=True, help="Run again with half the tolerance and step size, and report the change."
    )
    explain = click.option(
        "--explain", is_flag=True, help="Name the Hopf point or fold behind each onset and offset of a whirl."
    )
    uncertainty = click.option(
        "--uncertainty", is_flag=True, help="Make a second, coarser run for the uncertainties of the events."
    )
    gathering = gathered("options", RunOptions)(function)
    return output(resume(force(verify(explain(uncertainty(picture_switch(look_options(gathering))))))))


@click.command(cls=Command)
@case_argument
@run_options
@output_options
def runup(case: Case, options: RunOptions, terminal: Terminal) -> int:
    """Run the rotor of CASE up and write the run to a file, with a summary picture next to it."""
    from frbcli.runs import run

    return transient("runup", run.runup, case, options, terminal)


@click.command(cls=Command)
@case_argument
@run_options
@output_options
def rundown(case: Case, options: RunOptions, terminal: Terminal) -> int:
    """Run the rotor of CASE up, hold it, and run it down again; write the run to a file, with a picture next to it."""
    from frbcli.runs import run

    return transient("rundown", run.rundown, case, options, terminal)


def transient(command: str, run_case: Transient, case: Case, options: RunOptions, terminal: Terminal) -> int:
    """Run a case with progress on the terminal, report, and return the exit code."""
    from frbcli.results.store import check_output
    from frbcli.runs.run import INTERRUPTED, run_cost, standing_run
    from frbcli.runs.second_run import SECOND_RUN

    path = options.output or here(case.name, ".h5")
    check_output(path)
    if options.picture:
        check_outputs(picture=next_to(path, SUMMARY))
    standing = standing_run(command, case, path, options.resume, options.force)
    complete = not options.uncertainty or (standing is not None and SECOND_RUN in standing.cost)
    if standing is not None and standing.status != INTERRUPTED and complete:
        terminal.remark(f"{path} holds this run already; --force computes it again.")
    cost = run_cost(command, case, options.uncertainty)
    if cost.total_s > SHOWN_s:
        terminal.remark(cost_line(cost))
    with computing(terminal, case) as shown:
        run = run_case(
            case, path, options.resume, _watch(terminal, shown), force=options.force, uncertainty=options.uncertainty
        )
    _report(case, run, terminal)
    terminal.result(f"run: {path}")
    verified = _verified(case, run, terminal) if options.verify and run.status != "interrupted" else None
    explained = _explained(case, run, terminal) if options.explain and run.status != "interrupted" else None
    terminal.emit(
        {
            "command": command,
            "run": str(path),
            "status": run.status,
            "t_end_s": run.t_end_s,
            "events": run.events,
            "cost": run.cost,
            "error": run.error if verified is None else {**run.error, "verified": verified},
            **({} if explained is None else {"explanations": explained}),
        }
    )
    if options.picture and len(run) > 1:
        from frbcli.plot.summary import summary_figure

        draw(terminal, lambda: summary_figure(run), next_to(path, SUMMARY))
    interrupted = verified is not None and verified["status"] == "interrupted"
    return exit_code("interrupted" if interrupted else run.status)


def cost_line(cost: ExpectedCost) -> str:
    """Expected cost of a run."""
    from frbcli.scene.cost import clock
    from frbcli.scene.cost_limits import memory

    before = f", {clock(cost.before_s)} of it before the first step" if cost.before_s > SHOWN_BEFORE_s else ""
    return f"This takes about {clock(cost.total_s)} of CPU time{before}, and {memory(cost.memory_B)} of memory."


def _watch(terminal: Terminal, shown: Display) -> Observer:
    """Shows the progress on a terminal, elsewhere as a line every now and then, and warns once if a run takes much
    longer than its plan expected."""
    from frbcli.scene.cost import clock

    said, show = False, shown.now_and_then()

    def observe(progress: Progress) -> None:
        nonlocal said
        show(progress_line(progress, terminal.speeds))
        if not said and progress.cpu_s > SLOW_AFTER_s and progress.over_plan > SLOWER:
            said = True
            left = (
                f"about {clock(progress.left_s)} left"
                if progress.left_s < LONGEST_LEFT_s
                else "and the end cannot be estimated"
            )
            terminal.remark(
                f"Warning: this run takes {progress.over_plan:.0f} times as long as its plan expected, {left}.\n"
                "Ctrl-C ends it and keeps the results so far."
            )

    return observe


def _verified(case: Case, run: Run, terminal: Terminal) -> dict[str, Any]:
    """The change in a finer run, as text and as part of the JSON document."""
    from frbcli.studies.accuracy import verify

    try:
        with display(terminal) as shown:
            change = verify(case, run, lambda progress: shown.redraw(f"again\n{progress_line(progress, shown.speeds)}"))
    except KeyboardInterrupt:
        terminal.remark("Interrupted before the end of the verification.")
        return {"status": "interrupted"}
    moved = terminal.speeds.words(abs(change.onset_Hz))
    onset = "" if math.isnan(change.onset_Hz) else f", and the onset of whirl by {moved}"
    what = "eccentricity changes" if case.films else "displacements change, over their length,"
    terminal.result(
        f"verified: with half the tolerance and step size the {what} by {change.eccentricity:.1e}\n"
        f"until {change.until_s:.3g} s{onset} ({change.status}, {change.cpu_s:.3g} s of CPU time)."
    )
    if change.coupling is not None:
        terminal.result(f"with rotor and films solved together it changes by {change.coupling:.1e}.")
    return {
        "status": change.status,
        "eccentricity": change.eccentricity,
        "quiet_until_s": change.until_s,
        "onset_speed_Hz": change.onset_Hz,
        "coupling": change.coupling,
        "cpu_s": change.cpu_s,
    }


def _explained(case: Case, run: Run, terminal: Terminal) -> tuple[str, ...]:
    """The causes of the whirls of a run, as text and for the JSON document."""
    from frbcli.cycles.limit_cycles import explanations, limit_cycles

    try:
        with computing(terminal, case):
            sentences = explanations(limit_cycles(case), run.events)
    except FrbError as error:
        sentences = (f"Not explained: {error}",)
    for sentence in sentences:
        terminal.sentence(sentence)
    return sentences


def exit_code(status: str) -> int:
    """The exit code for a run that ended so."""
    return EXIT_CODES.get(status, ENDED_EARLY)


def _show_whirls(run: Run, terminal: Terminal) -> None:
    """Where there are several, a line for each whirl: from where to where, and how large over which clearance."""
    from frbcli.analysis.signals import bearing_clearance
    from frbcli.analysis.subsynchronous import SIDES, whirls

    seen, unit, rows = whirls(run.events), terminal.speeds, []
    for whirl in seen if len(seen) > 1 else ():
        bearing, _, side = whirl.film.rpartition("_")
        room = bearing_clearance(run, bearing if side in SIDES else whirl.film)
        size = whirl.begin.get("amplitude")
        last = "end" if whirl.end is None else unit.number(whirl.end["speed_Hz"])
        ratios = [event["frequency_ratio"] for event in (whirl.begin, whirl.end) if event is not None]
        lengths = ("-", "-") if size is None or room is None else (f"{1e6 * size * room:.3g}", f"{1e6 * room:.3g}")
        name, first = f"{whirl.name} {whirl.film.replace('_', ' ')}".strip(), unit.number(whirl.begin["speed_Hz"])
        rows.append((name, first, last, " to ".join(f"{ratio:.2f}X" for ratio in ratios), *lengths))
    if rows:
        terminal.table("whirls", ("whirl", f"from, {unit.name}", f"to, {unit.name}", "frequency", "largest, um",
                                  "of clearance, um"), rows)  # fmt: skip


def _report(case: Case, run: Run, terminal: Terminal) -> None:
    """Status with its cause and remedy, events, cost and error, as text."""
    from frbcli.analysis.events import about_critical_speeds
    from frbcli.analysis.subsynchronous import with_whirl_names
    from frbcli.results.columns import EVENTS
    from frbcli.runs.advice import accuracy_advice, forced_advice, run_advice, run_end
    from frbcli.runs.second_run import about_certainty, account

    terminal.result(f"{run.title}: {run.status} at {run.t_end_s:.4g} s")
    for sentence in (*run_advice(case, run_end(run)), *accuracy_advice(case, run), *forced_advice(case)):
        terminal.remark(wrapped(sentence))
    if run.events:
        events = with_whirl_names(run.events)
        terminal.show("events", table_of(EVENTS, events))
        for sentence in about_certainty(run, events, terminal.speeds):
            terminal.sentence(sentence)
        _show_whirls(run, terminal)
    for sentence in about_critical_speeds(run, run.events, terminal.speeds):
        terminal.sentence(sentence)
    terminal.table("cost and error", ("", "", ""), account(run))
