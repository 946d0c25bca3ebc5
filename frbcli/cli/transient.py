"""What run-up and run-down share: options, live progress, the closing table, the JSON document, the exit code."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from frbcli.cli.common import Terminal
from frbcli.cli.runs import OUTPUT, beside

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.results.store import Run
    from frbcli.solve.run import Observer, Progress

Function = TypeVar("Function", bound=Callable[..., Any])
Transient = Callable[..., "Run"]

EXIT_CODES = {"finished": 0, "interrupted": 130}  # anything else ended early for a reason that it names: 3
ENDED_EARLY = 3
REFRESH_Hz = 8
REASONS = {
    "contact": "The journal reached the shell (contact.eccentricity). "
    "To go on through contact: --set contact.policy=elastic --set contact.stiffness='1e9 N/m'.",
    "not-converged": "The step size fell to nothing. Try a smaller accuracy.target, or contact.policy=elastic.",
    "interrupted": "Go on with the same command and --resume.",
}


def run_options(function: Function) -> Function:
    """Give a command --output, --resume and --no-picture."""
    output = click.option(
        "--output", "-o", type=OUTPUT, default=None, metavar="RUN.h5", help="Run file. Default: CASE.h5 here."
    )
    resume = click.option("--resume", is_flag=True, help="Go on with an interrupted run in the run file.")
    picture = click.option("--picture/--no-picture", default=True, help="A summary picture beside the run.")
    return output(resume(picture(function)))


def transient(
    command: str, run_case: Transient, case: Case, output: Path | None, resume: bool, picture: bool, terminal: Terminal
) -> int:
    """Run a case with progress on the terminal, report, and return the exit code."""
    path = output or Path(f"{case.name or 'run'}.h5")
    with _progress(terminal) as observe:
        run = run_case(case, path, resume=resume, observe=observe)
    _report(run, terminal)
    if picture and len(run) > 1:
        from frbcli.plot.style import save_figure
        from frbcli.plot.summary import summary_figure

        target = beside(path, "-summary.png")
        save_figure(summary_figure(run), target)
        terminal.say(f"picture: {target}")
    terminal.say(f"run: {path}")
    terminal.emit(
        {
            "command": command,
            "run": str(path),
            "status": run.status,
            "t_end_s": run.t_end_s,
            "events": run.events,
            "cost": run.cost,
            "error": run.error,
        }
    )
    return EXIT_CODES.get(run.status, ENDED_EARLY)


@contextmanager
def _progress(terminal: Terminal) -> Iterator[Observer | None]:
    """An observer that keeps one line of the terminal up to date; None where nobody watches."""
    if not terminal.live:
        yield None
        return
    from rich.live import Live
    from rich.text import Text

    with Live(console=terminal.console(), refresh_per_second=REFRESH_Hz, transient=True) as live:
        yield lambda progress: live.update(Text(progress_line(progress)))


def progress_line(progress: Progress) -> str:
    """One line of at most 80 columns: time, speed, eccentricity, steps per revolution, pace, time left."""
    per_turn = f"{progress.steps_per_revolution:.0f}" if math.isfinite(progress.steps_per_revolution) else "-"
    return (
        f"{progress.t_s:6.3f}/{progress.end_s:g} s  {progress.speed_Hz:5.1f} Hz  eps {progress.eccentricity:5.3f}  "
        f"{per_turn} steps/rev  {progress.simulated_ms_per_hour:.2g} ms/h  {_clock(progress.left_s)} left"
    )


def _clock(seconds: float) -> str:
    if not math.isfinite(seconds):
        return "?"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"


def _report(run: Run, terminal: Terminal) -> None:
    """Status and its remedy, events, cost and error, for people."""
    terminal.say(f"{run.title}: {run.status} at {run.t_end_s:.4g} s")
    if run.status in REASONS:
        terminal.say(REASONS[run.status])
    if run.events:
        terminal.table(
            "events", ("event", "time in s", "speed in Hz", "frequency in Hz", "ratio"), map(_event_row, run.events)
        )
    terminal.table("cost and error", ("", "", ""), _cost_rows(run))


def _event_row(event: dict[str, Any]) -> tuple[str, ...]:
    def number(value: float | None, form: str) -> str:
        return "-" if value is None else format(value, form)

    name = event["kind"] if event["film"] is None else f"{event['kind']} {event['film']}"
    return (
        name,
        number(event["t_s"], ".3f"),
        number(event["speed_Hz"], ".1f"),
        number(event["frequency_Hz"], ".1f"),
        number(event["frequency_ratio"], ".3f"),
    )


def _cost_rows(run: Run) -> list[tuple[str, str, str]]:
    cost, error = run.cost, run.error
    film = error.get("film_force_relative")
    return [
        ("CPU time", f"{cost['cpu_s']:.3g} s", f"{cost['simulated_ms_per_hour']:.3g} simulated ms per hour"),
        (
            "steps",
            f"{cost['steps']}",
            f"{cost['steps_per_revolution']:.3g} per revolution, {cost['rejected_steps']} rejected",
        ),
        ("film solves", f"{cost['film_solves']}", f"{1e3 * cost['ms_per_film_solve']:.3g} us each"),
        ("error, time integration", f"{error['time_integration']:.1e}", "of the eccentricity"),
        ("error, film forces", "-" if film is None else f"{film:.1e}", "relative, against a finer mesh"),
    ]
