"""`frb sweep`: one case with many settings, on all cores or on a cluster."""

from __future__ import annotations

import math
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.options import (
    INPUT,
    OUTPUT_FOLDER,
    SPEED_OPTION,
    Command,
    check_outputs,
    complete_case,
    force_option,
    forced,
    gathered,
    here,
    look_options,
)
from frbcli.cli.progress import Display, display, draw, picture_switch
from frbcli.cli.transient import ENDED_EARLY, EXIT_CODES
from frbcli.errors import input_error
from frbcli.results.records import WHOLE
from frbcli.units import SpeedUnit

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from frbcli.studies.sweep import Sweep, SweepPoint
    from frbcli.studies.sweep_points import Distribution

LONGEST_TABLE = 40  # points of the printed table; its file and JSON have all


@dataclass(frozen=True)
class Pool:
    """Where the points are computed, see the options of the command."""

    jobs: int
    backend: str
    scheduler: str


@dataclass(frozen=True)
class Kept:
    """The results that are kept, see the options of the command."""

    no_runs: bool
    table_format: str
    picture: bool


@dataclass(frozen=True)
class Machines:
    """How machines are sampled whose numbers scatter, see the options of the command."""

    samples: int
    correlations: tuple[str, ...]
    seed: int
    below: float | None

    def points(self, distributions: Sequence[Distribution], others: object) -> Sequence[Mapping[str, str]]:
        """The machines. others: keys with several values, or a list of points, with which nothing can scatter. Raises
        InputError."""
        from frbcli.studies.sweep_points import read_correlation, samples

        if others:
            problem, remedy = "gives several values while other keys scatter.", "Sweep each of its values by itself."
            raise input_error("sweep", "--set", "", problem, remedy)
        correlations = dict(map(read_correlation, self.correlations))
        return samples(distributions, self.samples, correlations, self.seed)


@click.command(cls=Command)
@click.argument("source", metavar="CASE", type=INPUT, shell_complete=complete_case)
@click.option("--set", "settings", multiple=True, metavar="KEY=V1,V2",
              help="Values of a key, or LOW..HIGH UNIT / COUNT; several keys make a grid, KEY=V1,V2;KEY=V1,V2 change "
              "together. One value holds for all. Repeatable.")  # fmt: skip
@click.option("--samples", type=int, default=64, show_default=True, metavar="N",
              help="Number of machines, a power of 2, whose keys scatter: KEY=normal(MEAN, DEVIATION), "
              "uniform(LOW, HIGH) or truncated(MEAN, DEVIATION, LOW, HIGH).")  # fmt: skip
@click.option("--correlation", "correlations", multiple=True, metavar="KEY,KEY=R",
              help="Correlation of two keys that scatter. Repeatable.")  # fmt: skip
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True,
              help="Seed of the Sobol sequence of the machines.")  # fmt: skip
@click.option("--below", type=SPEED_OPTION, metavar="SPEED",
              show_default="the highest of CASE",
              help="Speed below which the share of machines that whirl is given.")  # fmt: skip
@click.option("--list", "list_file", type=INPUT, metavar="POINTS.csv",
              help="Points one by one: keys in the first line, values below.")  # fmt: skip
@click.option("-o", "--output", type=OUTPUT_FOLDER, metavar="DIR", show_default="CASE-sweep, here",
              help="Directory of all results.")  # fmt: skip
@click.option("--stability", is_flag=True, help="Compute the threshold speed alone, instead of a run-up.")
@click.option("--no-runs", is_flag=True, help="Keep no run files.")
@click.option("--format", "table_format", type=click.Choice(["csv", "parquet"]), default="csv", show_default=True,
              help="Format of the table; parquet needs the extra frbcli[parquet].")  # fmt: skip
@picture_switch
@click.option("--jobs", type=int, default=-1, metavar="N", show_default="one for each core", help="Processes.")
@click.option("--backend", type=click.Choice(["loky", "dask"]), default="loky", show_default=True,
              help="loky computes on this machine.")  # fmt: skip
@click.option("--scheduler", default="", metavar="ADDRESS", help="Address of the dask cluster, e.g. tcp://10.0.0.1:8786.")
@force_option()
@look_options
@output_options
@gathered("kept", Kept)
@gathered("pool", Pool)
@gathered("machines", Machines)
def command(
    source: Path,
    settings: tuple[str, ...],
    list_file: Path | None,
    output: Path | None,
    stability: bool,
    kept: Kept,
    pool: Pool,
    machines: Machines,
    terminal: Terminal,
) -> int:
    """Compute CASE at many points: one table, one picture (a curve over one key, a map over two), all runs.

    The same command resumes an interrupted sweep.
    """
    from frbcli.case.reading.load import load_case
    from frbcli.studies.sweep import Workers, check_table_format, sweep, write_table

    fixed, distributions = _scattered(settings)
    fixed, axes = _axes(fixed)
    case = load_case(source, fixed)
    points = machines.points(distributions, axes or list_file) if distributions else _points(axes, list_file)
    check_table_format(kept.table_format)
    folder = output or here(case.name, "-sweep")
    table, target = folder / f"sweep.{kept.table_format}", folder / "sweep.png"
    _check_places(table, target if kept.picture else None)
    method = "stability" if stability else "runup"
    workers = Workers(pool.backend, pool.jobs, pool.scheduler)
    with display(terminal) as shown:
        swept = sweep(case, points, folder, method, not kept.no_runs, workers, _progress(shown))
    _report(swept, terminal)
    write_table(swept, table, kept.table_format, forced())
    terminal.result(f"table: {table}")
    document: dict[str, Any] = {"command": "sweep", "case": case.name, "points": swept.table().documents()}
    if distributions and any(point.status != "interrupted" for point in swept.points):
        document["scatter"], drawn = of_machines(swept, machines.below, target if kept.picture else None, terminal)
    else:
        drawn = _picture(swept, target, terminal) if kept.picture else None
    terminal.emit({**document, "table": table, "picture": drawn})
    return _exit_code(swept)


def _scattered(settings: Sequence[str]) -> tuple[list[str], list[Distribution]]:
    """Other settings, and the distributions of the keys that scatter."""
    from frbcli.studies.sweep_points import read_distribution

    others: list[str] = []
    distributions: dict[str, Distribution] = {}
    for setting in settings:
        key, _, text = setting.partition("=")
        distribution = read_distribution(key.strip(), text)
        if distribution is None:
            others.append(setting)
        elif key.strip() in distributions:
            raise input_error("sweep", "--set", setting, "sets a key a second time.", "Give it one distribution.")
        else:
            distributions[key.strip()] = distribution
    return others, list(distributions.values())


def _check_places(table: Path, picture: Path | None) -> None:
    """Raises InputError if the results of a sweep cannot be written into a directory that is there already."""
    if table.parent.is_dir():  # else it is made, or that is refused
        from frbcli.results.write import TABLES

        check_outputs((table, TABLES[table.suffix[1:]]), picture=picture)


def _axes(settings: Sequence[str]) -> tuple[list[str], list[dict[str, tuple[str, ...]]]]:
    """Settings of one value, which hold for all points, and the values of the other keys, those together that are
    linked."""
    from frbcli.studies.sweep_points import LINK, read_values, split_values

    fixed: list[str] = []
    axes: list[dict[str, tuple[str, ...]]] = []
    seen: set[str] = set()
    for setting in settings:
        together: dict[str, tuple[str, ...]] = {}
        for part in split_values(setting, LINK):
            key, equals, text = part.partition("=")
            values = read_values(text)
            if not equals or len(values) < 2:
                fixed.append(part)
                continue
            if key.strip() in seen:
                remedy = "Write all its values in one --set."
                raise input_error("sweep", "--set", setting, "sets a key a second time.", remedy)
            if not all(values):
                raise input_error("sweep", "--set", setting, "has an empty value.", "Write e.g. --set key=v1,v2.")
            seen.add(key.strip())
            together[key.strip()] = values
        if together:
            axes.append(together)
    return fixed, axes


def _points(axes: Sequence[Mapping[str, Sequence[str]]], list_file: Path | None) -> Sequence[Mapping[str, str]]:
    from frbcli.studies.sweep_points import linked, product, read_list

    if list_file is None and not axes:
        remedy = "Write e.g. --set key=v1,v2, or --list FILE."
        raise input_error("sweep", "--set", "", "gives no key several values.", remedy)
    points: Sequence[Mapping[str, str]] = [{}] if list_file is None else read_list(list_file)
    for together in axes:
        points = product(points, linked(together))
    return points


def _progress(shown: Display) -> Callable[[SweepPoint, int, int], None]:
    """A line that is redrawn on a terminal, else one for each point."""
    began = time.monotonic()
    before: list[int] = []  # its first entry: the points that an earlier call had computed

    def observe(point: SweepPoint, done: int, whole: int) -> None:
        before.append(done - 1)
        computed = done - before[0]
        left = (time.monotonic() - began) / computed * (whole - done)
        outcome = point.message or _result(point, shown.speeds)
        settings = ", ".join(f"{key}={value}" for key, value in point.settings.items())
        shown.line(f"{done}/{whole}  {left:.0f} s left  {settings}: {outcome}")

    return observe


def _result(point: SweepPoint, unit: SpeedUnit) -> str:
    event = point.first("threshold") or point.first("onset")
    return point.status if event is None else f"{event['kind']} {unit.words(event['speed_Hz'], 1)}"


def _report(swept: Sweep, terminal: Terminal) -> None:
    table = swept.table().with_speeds_in(terminal.speeds)
    terminal.table(swept.case.heading, table.heads(), table.cells()[:LONGEST_TABLE])
    if len(swept.points) > LONGEST_TABLE:
        terminal.result(f"{LONGEST_TABLE} of {len(swept.points)} points; the table's file and --json give all.")
    failed = [point for point in swept.points if point.status not in WHOLE]
    if any(point.status == "interrupted" for point in failed):
        terminal.remark("Interrupted; the same command resumes the sweep.")
    elif failed:
        terminal.result(
            f"{len(failed)} of {len(swept.points)} points did not finish; the table's file has the reasons."
        )


def _picture(swept: Sweep, target: Path, terminal: Terminal) -> Path | None:
    from frbcli.plot.studies import can_draw, sweep_figure

    if not can_draw(swept):
        terminal.remark("No picture: it needs one or two keys with several values, and a point with a whirl.")
        return None
    return draw(terminal, lambda: sweep_figure(swept), target)


def _exit_code(swept: Sweep) -> int:
    statuses = {point.status for point in swept.points}
    if "interrupted" in statuses:
        return EXIT_CODES["interrupted"]
    return 0 if statuses <= set(WHOLE) else ENDED_EARLY


def of_machines(
    swept: Sweep, below_Hz: float | None, target: Path | None, terminal: Terminal
) -> tuple[dict[str, Any], Path | None]:
    """Tables and picture of the scatter, and its part of the JSON document."""
    from frbcli.studies.sweep import scatter

    seen, unit = scatter(swept, below_Hz), terminal.speeds
    rows = [(f"{percent:g} %", _within(speed, unit)) for percent, speed in seen.percentiles]
    terminal.table(f"{seen.count} machines", ("share", "whirl at or below"), rows)
    if seen.sensitivities:
        terminal.table("sensitivities", ("key", "per standard deviation", "rank correlation"), [
            (one.key, unit.words(one.per_deviation_Hz), f"{one.rank:+.2f}") for one in seen.sensitivities
        ])
        terminal.result(f"A linear model explains {100.0 * seen.explained:.0f} % of the variance of the speed.")
    low, high = (100.0 * limit for limit in seen.interval)
    share = f"{100.0 * seen.share:.1f} % of the machines whirl below {unit.words(seen.below_Hz)}"
    terminal.result(f"{share} (95 % interval {low:.1f} to {high:.1f} %).")
    if seen.left_out:
        terminal.result(f"{seen.left_out} machines without a known result are left out.")
    drawn = None
    if target is not None:
        from frbcli.plot.studies import scatter_figure

        drawn = draw(terminal, lambda: scatter_figure(swept.case.heading, seen), target)
    percentiles = [{"percent": percent, "speed_Hz": speed} for percent, speed in seen.percentiles]
    document = asdict(seen) | {"percentiles": percentiles}
    del document["speeds_Hz"]
    return document, drawn


def _within(speed: float, unit: SpeedUnit) -> str:
    if math.isinf(speed):
        return "none up to the highest speed"
    return "the lowest speed" if speed == 0.0 else unit.words(speed, 1)
