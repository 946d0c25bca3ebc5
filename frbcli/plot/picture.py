"""The picture of any result, which its command writes and a notebook shows."""

from __future__ import annotations

from importlib import import_module

from frbcli.errors import input_error
from frbcli.plot.style import Picture

PICTURES = {  # class of a result: module in this room, and its function
    "AccuracyLadder": "studies.accuracy:accuracy_figure",
    "AgainstMeasured": "spectra.ridges:against_figure",
    "BearingSheet": "machine.bearing:bearing_figure",
    "Comparison": "studies.compare:comparison_figure",
    "CriticalMap": "machine.response:critical_map_figure",
    "DampedModes": "machine.modes:shapes_figure",
    "Fit": "spectra.ridges:fit_figure",
    "KinematicTest": "machine.film:kinematic_figure",
    "LimitCycles": "machine.limit_cycles:limit_cycles_figure",
    "Modes": "machine.modes:modes_figure",
    "Response": "machine.response:response_figure",
    "Run": "run.summary:summary_figure",
    "Stability": "machine.campbell:campbell_figure",
    "StabilityMap": "machine.stability_map:stability_map_figure",
    "Sweep": "studies.sweep:sweep_figure",
    "ThrustSheet": "thrust:thrust_figure",
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
    kinds = (kind.__name__ for kind in type(result).__mro__ if kind.__module__.startswith("frbcli."))
    place = next((PICTURES[kind] for kind in kinds if kind in PICTURES), None)
    if place is None:
        problem, remedy = "has no picture.", f"There are pictures of: {', '.join(PICTURES)}."
        raise input_error("picture", type(result).__name__, "", problem, remedy)
    module, _, name = place.partition(":")
    found: Picture = getattr(import_module(f"frbcli.plot.{module}"), name)(result)
    return found
