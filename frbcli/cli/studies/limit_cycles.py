"""`frb limit-cycles`: static equilibria, Hopf points and branches of limit cycles over the rotor speed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.options import INPUTS, KEY_RANGE, Command, KeyRange, here, speeds_option
from frbcli.cli.progress import Display, OutputOptions, Outputs, computing, outputs_options
from frbcli.columns import document, documents, table_of

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.cycles.columns import CyclePoint, LimitCycles, UnbalancedWhirl
    from frbcli.cycles.stability_map import StabilityMap
    from frbcli.plot.curves import RunTrack
    from frbcli.plot.style import Picture
    from frbcli.scene.cost import Kernels

ASKED = "asked"
KINDS = {"hopf": "Hopf points", "fold": "folds"}


@click.command(cls=Command)
@case_argument
@speeds_option("those in the diagram; at given ones the cycles have their orbits")
@click.option("--parameter", "over", type=KEY_RANGE, metavar="KEY=LOW..HIGH", show_default="the speed of CASE",
              help="Parameter instead: a number of CASE, e.g. bearing.clearance='30..45 um', at --speed.")  # fmt: skip
@click.option("--and", "second", type=KEY_RANGE, metavar="KEY=LOW..HIGH",
              help="Draw a map: curves of Hopf points and folds over --parameter and this one.")  # fmt: skip
@click.option("--points", type=click.IntRange(2, 500), metavar="N", default=3, show_default=True,
              help="Number of values of --and at which curves are sought.")  # fmt: skip
@click.option("--with-unbalance", is_flag=True,
              help="Compute, too, the whirls that lock in with the unbalance at half the speed.")  # fmt: skip
@click.option("--runs", type=INPUTS, default=(), metavar="UP.h5,DOWN.h5",
              help="Draw the eccentricities of runs of CASE over the diagram.")  # fmt: skip
@outputs_options("CASE-limit-cycles.png, here")
@output_options
def command(
    case: Case,
    speeds: tuple[float, ...],
    over: KeyRange | None,
    second: KeyRange | None,
    points: int,
    with_unbalance: bool,
    runs: tuple[Path, ...],
    outputs: OutputOptions,
    terminal: Terminal,
) -> None:
    """Static equilibria of CASE over its speed, the Hopf points where a whirl begins, and the limit cycles from there.

    Limit cycles, stable or not, are without unbalance. The synchronous response with unbalance is shown next to them,
    and with --with-unbalance the whirls that lock in with it.
    """
    from frbcli.cycles.limit_cycles import limit_cycles, limit_cycles_over

    if ((over or second) and (len(speeds) > 1 or runs)) or (second and not over and speeds):
        raise click.UsageError("--runs and several --speed are of the diagram of one case over its speed.")
    if with_unbalance and (over or second):
        raise click.UsageError("--with-unbalance is of the diagram over the speed.")
    places = outputs.check(here(case.name, "-stability-map.png" if second else "-limit-cycles.png"))
    at = speeds[0] if speeds else case.speed.end
    if second is not None:
        _map(terminal, case, second, points, None if over is None else (over.key, over.low, over.high, at), places)
        return
    tracks = [track for name in runs for track in _tracks(name)]
    with computing(terminal, case, kernels=_kernels(case)) as shown:
        if over is not None:
            diagram = limit_cycles_over(case, over.key, over.low, over.high, at, _showing(shown))
        else:
            diagram = limit_cycles(case, speeds, _showing(shown), with_unbalance)
    _show(terminal, diagram)
    terminal.emit(_document(diagram) | places.write(terminal, diagram, picture=lambda: _figure(diagram, tracks)))


def _kernels(case: Case) -> Kernels:
    from frbcli.scene.gate.static import by_shooting

    return "both" if by_shooting(case) else "loop"


def _figure(diagram: LimitCycles, tracks: list[RunTrack]) -> Picture:
    from frbcli.plot.machine.limit_cycles import limit_cycles_figure

    return limit_cycles_figure(diagram, tracks)


def _map(
    terminal: Terminal,
    case: Case,
    second: KeyRange,
    points: int,
    first: tuple[str, str, str, float] | None,
    places: Outputs,
) -> None:
    """Map over the speed or a first number (key, from, to, speed in Hz), and a second one, with starting points."""
    from frbcli.cycles.stability_map import Across, stability_map
    from frbcli.scene.films import film_places

    across = None if first is None else Across(*first)
    with computing(terminal, case, kernels=_kernels(case)) as shown:
        chart = stability_map(case, second.key, second.low, second.high, points, shown.counting(), across)
    _show_map(terminal, chart)
    names = tuple(place.name for place in film_places(case))
    written = places.write(terminal, chart)
    terminal.emit(_map_document(names, chart) | written)


def _show_map(terminal: Terminal, chart: StabilityMap) -> None:
    rows = [
        (f"{row.value:.4g} {chart.unit}".strip(), point.kind, f"{point.value:.6g}", f"{point.frequency_Hz:.2f}",
         point.criticality or "")
        for row in chart.rows
        for point in row.special
    ]  # fmt: skip
    rows += [
        (f"{point.value:.4g} {chart.unit}".strip(), point.kind, f"{point.over:.6g}", f"{point.frequency_Hz:.2f}",
         "on a curve")
        for point in chart.special
    ]  # fmt: skip
    columns = (chart.key, "point", chart.over_unit or chart.over, "whirl Hz", "")
    if rows:
        terminal.table(chart.case.heading, columns, rows)
    else:
        terminal.sentence(f"{chart.case.heading}: no whirl begins or ends between these values.")
    for curve in chart.curves:
        values = [point.value for point in curve.points]
        extent = f"{len(values)} points from {min(values):.4g} to {max(values):.4g} {chart.unit}."
        terminal.sentence(" ".join([f"Curve of {KINDS[curve.kind]}: {extent}", *curve.notes]))
    for row in chart.rows:
        if row.problem:
            terminal.sentence(f"{row.value:.4g} {chart.unit}: {row.problem}")


def _map_document(names: tuple[str, ...], chart: StabilityMap) -> dict[str, object]:
    from frbcli.cycles.columns import map_point_columns, special_columns

    return {
        "command": "limit-cycles",
        "case": chart.case.name,
        "over": chart.over,
        "over_unit": chart.over_unit,
        "and": chart.key,
        "unit": chart.unit,
        "rows": [
            {
                "value": row.value,
                "special": documents(special_columns(names), row.special),
                "problem": row.problem or None,
            }
            for row in chart.rows
        ],
        "curves": [
            {
                "kind": curve.kind,
                "points": documents(map_point_columns(names), curve.points),
                "notes": curve.notes,
            }
            for curve in chart.curves
        ],
        "special": documents(map_point_columns(names), chart.special),
    }


def _tracks(path: Path) -> tuple[RunTrack, ...]:
    """The way up of a run, and the way down if it has one."""
    from frbcli.plot.curves import run_tracks
    from frbcli.results.store import read_run

    return run_tracks(read_run(path), path.stem)


def _showing(shown: Display) -> Callable[[int, float, float], None]:
    return lambda number, value, eccentricity: shown.redraw(
        f"cycle {number}: at {value:.4g}, eccentricity {eccentricity:.4f}"
    )


def _show(terminal: Terminal, diagram: LimitCycles) -> None:
    from frbcli.cycles.columns import SPEED, special_columns

    terminal.show(
        diagram.case.heading, table_of(special_columns(diagram.films, diagram.over, diagram.unit), diagram.special)
    )
    for number, branch in enumerate(diagram.branches):
        values = [point.value for point in branch.points]
        if not values:
            terminal.sentence(f"Branch {number + 1} has no cycles. {branch.note}")
            continue
        stable = sum(point.stable for point in branch.points)
        span = f"{min(values):.4g} to {max(values):.4g} {diagram.unit}"
        if diagram.over == SPEED:
            span = terminal.speeds.span(min(values), max(values))
        extent = f"{len(values)} cycles from {span}, {stable} stable."
        terminal.sentence(f"Branch {number + 1}: {extent} {branch.note}")
    for number, branch in enumerate(diagram.branches):
        for point in branch.points:
            if point.kind == ASKED:
                at = terminal.speeds.words(point.speed_Hz)
                terminal.result(f"{at}, branch {number + 1}: {_in_words(point)}")
    _show_with_unbalance(terminal, diagram)
    for note in (*diagram.notes, *_left_out(diagram)):
        terminal.sentence(note)
    terminal.result(f"{diagram.cost.cycles} cycles, {diagram.cost.cpu_s:.1f} CPU s")


def _in_words(point: CyclePoint) -> str:
    """A cycle at a speed that was asked for, with the uncertainties in the last digits."""
    from frbcli.units import with_uncertainty

    film, uncertainties = int(point.eccentricity_max.argmax()), point.eccentricity_max_uncertainty
    frequency = with_uncertainty(point.frequency_Hz, point.frequency_uncertainty_Hz, 3)
    uncertainty = None if uncertainties is None else float(uncertainties[film])
    eccentricity = with_uncertainty(float(point.eccentricity_max[film]), uncertainty, 5)
    return f"{frequency} Hz, {'stable' if point.stable else 'unstable'}, eccentricity {eccentricity}"


def _show_with_unbalance(terminal: Terminal, diagram: LimitCycles) -> None:
    """Where no whirl locks in with the unbalance and why, and a table of those that do."""
    from frbcli.cycles.columns import WHIRLS

    for number, branch in enumerate(diagram.branches):
        for reason in dict.fromkeys(missing.reason for missing in branch.missing):
            at = terminal.speeds.listed(missing.speed_Hz for missing in branch.missing if missing.reason == reason)
            terminal.sentence(f"Branch {number + 1} with unbalance, no whirl locks in at {at}: {reason}.")
    whirls = [(number, whirl) for number, branch in enumerate(diagram.branches) for whirl in branch.with_unbalance]
    if whirls:
        terminal.show("Locked in with unbalance", table_of(WHIRLS, whirls))


def _left_out(diagram: LimitCycles) -> list[str]:
    from frbcli.scene.changes import loss_note, step_times
    from frbcli.scene.gate.static import drives

    notes = []
    if any(point.kind == "torus" for point in diagram.special):
        notes.append("Beyond a torus point the motion has a second frequency: a run (frb runup) shows it.")
    if driven := " and ".join(drives(diagram.case)):
        notes.append(f"Branches are those without {driven}; a run (frb runup) shows the whirl with it.")
    if before := loss_note(diagram.case):
        notes.append(f'{before}; with time = "0 s" it is that after it.')
    if step_times(diagram.case):
        notes.append("The clearances are the initial ones; bearing.clearance_steps changes them during a run.")
    return notes


def _document(diagram: LimitCycles) -> dict[str, object]:
    from frbcli.cycles.columns import MISSING, equilibrium_columns, special_columns

    films, heat = diagram.films, diagram.case.heat is not None
    special = documents(special_columns(films, diagram.over), diagram.special)
    return {
        "command": "limit-cycles",
        "case": diagram.case.name,
        "over": diagram.over,
        "unit": diagram.unit,
        "equilibria": documents(equilibrium_columns(films, heat, diagram.tilts), diagram.equilibria),
        "branches": [
            {
                "from": None if branch.start is None else special[branch.start],
                "points": [_cycle(diagram, point) for point in branch.points],
                "note": branch.note,
                "with_unbalance": [_whirl(diagram, whirl) for whirl in branch.with_unbalance],
                "missing": documents(MISSING, branch.missing),
            }
            for branch in diagram.branches
        ],
        "synchronous": [_cycle(diagram, point) for point in diagram.synchronous],
        "special": special,
        "notes": diagram.notes,
        "cost": {"cpu_s": diagram.cost.cpu_s, "cycles": diagram.cost.cycles},
    }


def _cycle(diagram: LimitCycles, point: CyclePoint) -> dict[str, object]:
    """A cycle in JSON, with its orbits where it was asked for."""
    from frbcli.cycles.columns import cycle_columns

    orbits = {name: point.orbit(film) for film, name in enumerate(diagram.films)} if point.kind == ASKED else None
    row = document(cycle_columns(diagram.films, diagram.case.heat is not None, diagram.tilts), point)
    return row | ({} if orbits is None else {"orbits": orbits})


def _whirl(diagram: LimitCycles, whirl: UnbalancedWhirl) -> dict[str, object]:
    from frbcli.cycles.columns import line_columns, whirl_columns

    row = document(whirl_columns(diagram.films, diagram.case.heat is not None), whirl)
    return row | {"lines": documents(line_columns(diagram.films), whirl.lines)}
