"""The picture of any result, which a notebook shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from frbcli.bearing_tests.kinematic import KinematicTest
from frbcli.cycles.maps.stability_map import StabilityMap
from frbcli.cycles.result import LimitCycles
from frbcli.errors import Fault, InputError
from frbcli.linear.bearing_sheet import BearingSheet
from frbcli.linear.critical_map import CriticalMap
from frbcli.linear.damped_modes import DampedModes
from frbcli.linear.modes import Modes
from frbcli.linear.response import Response
from frbcli.linear.stability import Stability
from frbcli.linear.thrust.sheet import ThrustSheet
from frbcli.plot.machine.bearing import bearing_figure
from frbcli.plot.machine.campbell import campbell_figure
from frbcli.plot.machine.critical_map import critical_map_figure
from frbcli.plot.machine.film import film_figure
from frbcli.plot.machine.history import history_figure
from frbcli.plot.machine.limit_cycles import limit_cycles_figure
from frbcli.plot.machine.modes import modes_figure
from frbcli.plot.machine.response import response_figure
from frbcli.plot.machine.shapes import shapes_figure
from frbcli.plot.machine.stability_map import stability_map_figure
from frbcli.plot.run.summary import summary_figure
from frbcli.plot.spectra.ridges import against_figure, fit_figure
from frbcli.plot.studies.accuracy import accuracy_figure
from frbcli.plot.studies.compare import comparison_figure
from frbcli.plot.studies.sweep import can_draw, sweep_figure
from frbcli.plot.style import Picture
from frbcli.plot.thrust import thrust_figure
from frbcli.results.store import Run
from frbcli.studies.against import AgainstMeasured
from frbcli.studies.compare import Comparison
from frbcli.studies.fit import Fit
from frbcli.studies.ladder import AccuracyLadder
from frbcli.studies.sweep.sweep import Sweep


def _kinematic(found: KinematicTest) -> Picture:
    return film_figure(found) if found.test == "rotation" else history_figure(found)


def _sweep(found: Sweep) -> Picture:
    if not can_draw(found):
        raise _refuse("Sweep", "needs one or two keys with several values, and a whirl.", "See its to_pandas().")
    return sweep_figure(found)


PICTURES: dict[type, Callable[[Any], Picture]] = {
    AccuracyLadder: accuracy_figure,
    AgainstMeasured: against_figure,
    BearingSheet: bearing_figure,
    ThrustSheet: thrust_figure,
    Comparison: comparison_figure,
    CriticalMap: critical_map_figure,
    DampedModes: shapes_figure,
    Fit: fit_figure,
    KinematicTest: _kinematic,
    LimitCycles: limit_cycles_figure,
    Modes: modes_figure,
    Response: response_figure,
    Run: summary_figure,
    Stability: campbell_figure,
    StabilityMap: stability_map_figure,
    Sweep: _sweep,
}


def picture(result: object) -> Picture:
    """The picture of a result, as its command draws it.

    Parameters
    ----------
    result : object
        A run, or what a function of `frbcli` returned: `stability`, `response`, `bearing_sheet`, `critical_map`,
        `natural_modes`, `damped_modes`, `limit_cycles`, `stability_map`, `rotation`, `squeeze`, `whirl`, `compare`,
        `against_measured`, `accuracy`, `fit`, `sweep`.

    Returns
    -------
    matplotlib.figure.Figure
        A notebook shows it where a cell ends with it; `figure.savefig("a.png")` writes it.

    Raises
    ------
    InputError
        If there is no picture of it.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.stability(frbcli.load_case("jeffcott", ["film.theory=short"]))
    >>> figure = frbcli.picture(found)
    >>> len(figure.axes)
    2
    """
    draw = next((draw for kind, draw in PICTURES.items() if isinstance(result, kind)), None)
    if draw is None:
        known = ", ".join(sorted(kind.__name__ for kind in PICTURES))
        raise _refuse(type(result).__name__, "has no picture.", f"There are pictures of: {known}.")
    return draw(result)


def _refuse(kind: str, problem: str, remedy: str) -> InputError:
    return InputError("picture", (Fault(kind, "", None, problem, remedy),))
