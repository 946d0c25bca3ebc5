"""Which films that are not mass-conserving are tabulated before a run, and why others are solved on cells during it."""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.grid import Mesh
from frbcli.scene.films import film_places, is_plain

SOLUTIONS = "table over eccentricity, direction and speed"
SOLUTION_MESH = Mesh(axial=6, circumferential=48)  # cells
# 90 % of the forces up to an eccentricity of 0.95 have a smaller error, from interpolation and cells together.
SOLUTION_ERROR = 6e-3
TABLE_TARGET = 5e-4  # the smallest target for which splines through some thousand solutions are sufficient
TURNING = "openings or lobes do not turn with the line of centres"


def table_obstacle(case: Case) -> str:
    """Why films that are not all clipped cannot be tabulated; empty if they can."""
    film, oil = case.film, case.oil
    for cavitation in case.cavitations:
        if law_named(cavitation).keeps_oil:
            return f"{cavitation} is mass-conserving: the force does not depend on the motion alone"
        if not law_named(cavitation).tabulated:
            return f"{cavitation} has no such table"
    if film.grid == "half-speed":
        return "a half-speed grid needs cells"
    for place in film_places(case):
        if place.feed_holes is not None or not is_plain(place.geometry):
            return TURNING
        if place.geometry.ends == "free-to-air":
            return "the flow out of free ends is not in the table"
        supply = getattr(place.geometry.supply, "pressure", oil.ambient_pressure)
        equal = supply == oil.ambient_pressure == oil.cavitation_pressure
        if film.penalty.pressure == "dimensionless" and not equal:
            return "with the dimensionless pressure, a supply or cavitation pressure would be a fourth axis"
    if film.solution == "auto" and case.accuracy.target < TABLE_TARGET:
        return f"a table is too coarse for a target below {TABLE_TARGET:g}"
    return ""


def solution_fault(case: Case, clipped: bool, tabulated: bool) -> Fault | None:
    """The fault of film.solution. clipped: whether all films are clipped; tabulated: whether clipped films can be
    tabulated."""
    if case.film.solution != "table":
        return None
    obstacle = table_obstacle(case)
    if clipped:
        obstacle = "" if tabulated else TURNING
    if not obstacle:
        return None
    return Fault("film.solution", "table", None, f"is not possible: {obstacle}.", "Choose auto or cells.")
