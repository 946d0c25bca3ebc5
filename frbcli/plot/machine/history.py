"""A squeeze or a whirl over its periods: the force or the pressure at the probe, with the gap (figures 4.15, 4.16)."""

from __future__ import annotations

from matplotlib.figure import Figure

from frbcli.bearing_tests.kinematic import KinematicTest
from frbcli.plot.machine.film import BAR, LINES, film_figure
from frbcli.plot.style import COLOURS, GREY, legend_below, new_figure, styled

HEIGHT = 5.4


def kinematic_figure(found: KinematicTest) -> Figure:
    """The films of a rotation, the history of a squeeze or a whirl."""
    return film_figure(found) if found.test == "rotation" else history_figure(found)


def history_figure(found: KinematicTest) -> Figure:
    """F_y of a squeeze and of a bearing model, the pressure at the probe of another whirl, over time for all models;
    below, the gap at phi = pi."""
    motion = found.case.motion
    assert motion is not None
    pressures = found.test == "whirl" and all(result.plan.form.solved for result in found.results)
    with styled():
        words = f"{found.test} with {motion.frequency:g} Hz, eccentricity {motion.eccentricity:g}"
        if motion.speed:
            words += f", journal turns with {motion.speed:g} Hz"
        if motion.tilt is not None:
            words += ", tilted"
        if len(found.results) == 1:  # else the legend names the models
            words += f", {found.results[0].plan.label}"
        figure = new_figure(found.case.heading, words, height=HEIGHT)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 1.0))
        for number, result in enumerate(found.results):
            history = result.history
            if history is None:
                continue
            values = history.probe_pressure / BAR if pressures else history.force[:, 1]
            label = result.plan.label
            label += "" if result.status == "ok" else ", not converged"
            colour, line = COLOURS[number % len(COLOURS)], LINES[number % len(LINES)]
            above.plot(history.time_s, values, color=colour, linestyle=line, label=label)
            below.plot(history.time_s, history.gap_ratio, color=GREY)
        force = "vertical force on the journal in N"
        above.set_ylabel("pressure at φ = 180°, z = B/4 in bar" if pressures else force)
        below.set_ylabel("gap H\nat φ = 180°")
        below.set_ylim(bottom=0.0)
        below.set_xlabel("time in s")
        below.margins(x=0.0)
        legend_below(figure, above)
    return figure
