"""`frb waterfall`: the spectra of a run over time or rotor speed, or its amplitudes by order."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.files import INPUT, check_outputs, force_option, next_to
from frbcli.cli.options import TIME_OPTION, Command, Numbers, Span, gathered, look_options, over_option, signal_option
from frbcli.cli.progress import READING, display, draw_wanted, picture_option
from frbcli.cli.studies.fit import measured_options, run_of, show_columns
from frbcli.columns import table_of

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.analysis.order_tracking import OrderTrack
    from frbcli.analysis.spectrum import Direction
    from frbcli.plot.curves import Over
    from frbcli.results.store import Run

MICRO = 1e6


@dataclass(frozen=True)
class View:
    """How a run is looked at, see the options of the command."""

    over: Over | None
    cascade: bool
    window: float | None
    direction: Direction
    log: bool
    levels: tuple[float, float] | None
    linear: bool
    lines: tuple[float, ...] | None


@click.command(cls=Command)
@click.argument("run_file", metavar="RUN", type=INPUT)
@picture_option("RUN-waterfall.png")
@signal_option()
@click.option("--order", "orders", metavar="1,0.5", type=Numbers(),
              help="Amplitudes by order instead of spectra; exact also in a ramp of the speed.")  # fmt: skip
@over_option(None)
@click.option("--cascade", is_flag=True, help="Curves behind each other, in 3-D.")
@click.option("--window", type=TIME_OPTION, show_default="from the ramp, up to 0.2 s", help="Length of one spectrum.")
@click.option(
    "--direction",
    type=click.Choice(["x", "y", "forward"]),
    default="x",
    show_default=True,
    help="One coordinate, or the motion that turns with the rotor.",
)
@click.option("--log", is_flag=True, help="Logarithmic frequency axis; with --order logarithmic amplitudes.")
@click.option("--levels", type=Span(), metavar="A,B", show_default="-60,0",
              help="Range of the colours in dB, with --linear in um.")  # fmt: skip
@click.option("--linear", is_flag=True, help="Amplitudes in um instead of levels in dB.")
@click.option("--lines", type=Numbers(), metavar="1,0.5", show_default="orders of free whirls",
              help="Orders whose lines are drawn.")  # fmt: skip
@click.option("--columns", "listed", is_flag=True, help="List the columns of a measurement, with shapes and units.")
@measured_options
@force_option()
@look_options
@output_options
@gathered("view", View)
def command(
    run_file: Path,
    output: Path | None,
    signal: str,
    orders: tuple[float, ...] | None,
    view: View,
    listed: bool,
    measurement: Measurement | None,
    terminal: Terminal,
) -> None:
    """Draw the spectra of RUN in dB relative to the clearance, over time or rotor speed; or, with --order, its
    amplitudes by order.

    RUN is a run file, or a measurement as CSV, WAV, MAT or UFF, whose columns --x, --speed-column and so on name.
    """
    from frbcli.analysis.events import about_critical_speeds
    from frbcli.analysis.subsynchronous import with_whirl_names
    from frbcli.case.run import speed_unit_of
    from frbcli.results.columns import EVENTS

    if listed:
        show_columns(run_file, terminal)
        return
    if orders is not None and (view.cascade or view.window is not None):
        raise click.UsageError("--cascade and --window belong to spectra, not to --order.")
    if orders is not None and (view.levels is not None or view.linear or view.lines is not None):
        raise click.UsageError("--levels, --linear and --lines belong to spectra, not to --order.")
    target = output or next_to(run_file, "-waterfall.png" if orders is None else "-orders.png")
    check_outputs(picture=target)
    with display(terminal, READING):
        run = run_of(run_file, measurement, terminal, relative=orders is None and not view.linear)
    terminal = terminal.with_speeds_in(speed_unit_of(run))
    if orders is None:
        drawn = _spectra(terminal, run, signal, view, target)
    else:
        drawn = _orders(terminal, run, signal, orders, view.over or "speed", view, target)
    if measurement is not None:
        drawn["events"] = run.events
        if run.events:
            terminal.show("events", table_of(EVENTS, with_whirl_names(run.events)))
            for sentence in about_critical_speeds(run, run.events, terminal.speeds):
                terminal.sentence(sentence)
    document = {"command": "waterfall", "run": run_file, "output": target, "signal": signal}
    terminal.emit({**document, "direction": view.direction, **drawn})


def _spectra(terminal: Terminal, run: Run, signal: str, view: View, target: Path) -> dict[str, Any]:
    """Draw spectra, and return their part of the JSON document."""
    from frbcli.plot.waterfall import LevelScale, natural_axis, reading, run_spectra, waterfall_figure

    with display(terminal):
        levels = run_spectra(run, signal, view.window, view.direction)
    scale, axis = LevelScale(view.linear, view.levels, view.lines), view.over or natural_axis(levels)
    draw_wanted(
        terminal,
        lambda: waterfall_figure(
            run, axis, signal, view.cascade, view.window, view.direction, view.log, levels, scale, terminal.speeds
        ),
        target,
        "waterfall",
    )
    terminal.result(reading(levels))
    return {"over": axis, "window_s": levels.window_s, "synchronous_low_dB": float(levels.low_dB.max())}


def _orders(
    terminal: Terminal, run: Run, signal: str, orders: tuple[float, ...], axis: Over, view: View, target: Path
) -> dict[str, Any]:
    """Draw amplitudes by order, and return their part of the JSON document."""
    from frbcli.analysis.order_tracking import order_tracks
    from frbcli.plot.curves import orders_figure

    with display(terminal):
        tracks = order_tracks(run, orders, signal)
    draw_wanted(terminal, lambda: orders_figure(run, tracks, axis, view.direction, view.log), target, "orders")
    rows = [_largest(track, view.direction) for track in tracks]
    for row in rows:
        most = f"{MICRO * row['amplitude_max_m']:.3g} um at {terminal.speeds.words(row['speed_Hz'], 1)}"
        terminal.result(f"order {row['order']:g}: at most {most}, {row['t_s']:.3f} s")
    return {"over": axis, "orders": rows}


def _largest(track: OrderTrack, direction: Direction) -> dict[str, float]:
    """Where the motion of an order is largest."""
    amplitude = track.amplitude(direction)
    at = int(amplitude.argmax())
    return {
        "order": track.order,
        "amplitude_max_m": float(amplitude[at]),
        "t_s": float(track.time_s[at]),
        "speed_Hz": float(track.speed_Hz[at]),
    }
