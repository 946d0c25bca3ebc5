"""Amplitudes by order over rotor speed or time."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from frbcli.analysis.orders.order_tracking import OrderTrack
from frbcli.analysis.signals import joined, located
from frbcli.analysis.spectra.spectrum import Direction
from frbcli.plot.curves import Over
from frbcli.plot.signals import MICRO, heading
from frbcli.plot.style import legend_below, new_figure, styled
from frbcli.results.store import Run


def orders_figure(
    run: Run, tracks: Sequence[OrderTrack], over: Over = "speed", direction: Direction = "x", log: bool = False
) -> Figure:
    """The peak amplitude of each order of a point, a curve each; a run that goes up and down is drawn to and fro.

    tracks: of the same point, by `frbcli.analysis.orders.order_tracking.order_tracks`; log: logarithmic amplitude.
    """
    title, subtitle = heading([run])
    point = joined(*located(run, tracks[0].signal)).replace("_", " ")
    moves = f"forward motion of the {point}" if direction == "forward" else f"{direction} of the {point}"
    what = f"{moves} by order, windows of {tracks[0].revolutions} revolutions"
    with styled():
        figure = new_figure(title, f"{subtitle}\n{what}" if subtitle else what)
        axes = figure.subplots()
        for track in tracks:
            across = track.time_s if over == "time" else track.speed_Hz
            axes.plot(across, MICRO * track.amplitude(direction), label=named(track.order))
        axes.set_xlabel("time in s" if over == "time" else "rotor speed in Hz")
        axes.set_ylabel("amplitude in µm")
        axes.margins(x=0.0)
        if log:
            axes.set_yscale("log")
        else:
            axes.set_ylim(bottom=0.0)
        legend_below(figure, axes)
    return figure


def named(order: float) -> str:
    """Label of an order, such as 0.5X."""
    return f"{order:g}X"
