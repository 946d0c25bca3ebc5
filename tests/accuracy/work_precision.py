"""Error over CPU time of films on cells, for targets of 2e-2 to 5e-4, and before oil was carried
with second order: draws docs/images/work-precision.png from the measurements beside this file.

`cd tests && python -m accuracy.work_precision`. CPU time of the time loop of one core, the smaller of two runs; largest
error of the eccentricities against 144 x 10 cells and a tolerance of 2e-6.
"""

from __future__ import annotations

import json
from pathlib import Path

from frbcli.plot.style import BLACK, COLOURS, legend_below, new_figure, save_figure, styled

HERE = Path(__file__).parent
MEASURED = HERE / "work_precision.json"
PICTURE = HERE.parent.parent / "docs" / "images" / "work-precision.png"
MARKS = ("o", "s", "^", "D", "v", "P")


def main() -> None:
    measured = json.loads(MEASURED.read_text("utf-8"))
    with styled():
        figure = new_figure("Films on cells before the whirl", "error over cost of the time loop", height=4.8)
        axes = figure.subplots()
        for number, case in enumerate(measured["until_s"]):
            style = {"color": COLOURS[number % len(COLOURS)], "marker": MARKS[number], "markersize": 4.5}
            for kind, line in (("plan", "-"), ("before", ":")):
                times, errors, _ = zip(*sorted(measured[kind][case]), strict=True)
                axes.plot(times, errors, line, linewidth=1.2, label=case if kind == "plan" else None, **style)
        for line, label in (("-", "plan, targets of 2e-2 to 5e-4"), (":", "first order, cells at rest")):
            axes.plot([], [], line, color=BLACK, linewidth=1.2, label=label)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("CPU time of the time loop in s")
        axes.set_ylabel("largest error of the eccentricities")
        axes.grid(which="minor", visible=False)
        legend_below(figure, axes)
        save_figure(figure, PICTURE)


if __name__ == "__main__":
    main()
