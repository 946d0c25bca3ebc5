"""Which films whose law makes oil are tabulated before a run, and why others are solved on cells during it."""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.rectangles.table import Mesh
from frbcli.scene.films import film_places, is_plain

SOLUTIONS = "table over eccentricity, direction and speed"
SOLUTION_MESH = Mesh(axial=6, circumferential=48)  # cells
# What nine of ten forces are off by up to an eccentricity of 0.95, by its interpolation and by its cells together.
SOLUTION_ERROR = 6e-3
TABLE_TARGET = 5e-4  # the smallest target of accuracy that splines through some thousand solutions serve
TURNING = "openings or lobes stand while the line of centres turns"


def table_obstacle(case: Case) -> str:
    """Why films that are not all clipped cannot be tabulated, or nothing."""
    film, oil = case.film, case.oil
    for cavitation in case.cavitations:
        if law_named(cavitation).keeps_oil:
            return f"{cavitation} keeps its oil: the force does not follow from the motion alone"
        if not law_named(cavitation).tabulated:
            return f"{cavitation} has no such table"
    if film.grid != "fixed":
        return f"a {film.grid} grid is one of cells"
    for place in film_places(case):
        if place.feed_holes is not None or not is_plain(place.geometry):
            return TURNING
        if place.geometry.ends == "free-to-air":
            return "what leaves at free ends is no part of the table"
        supply = getattr(place.geometry.supply, "pressure", oil.ambient_pressure)
        equal = supply == oil.ambient_pressure == oil.cavitation_pressure
        if film.penalty.pressure == "dimensionless" and not equal:
            return "a supply or cavitation pressure beside one that follows the speed would be a fourth axis"
    if film.solution == "auto" and case.accuracy.target < TABLE_TARGET:
        return f"a table is too coarse for a target below {TABLE_TARGET:g}"
    return ""


def solution_fault(case: Case, clipped: bool, tabulated: bool) -> Fault | None:
    """What is wrong with the way that a case wants its films solved. clipped: whether all of them are; tabulated:
    whether those can be."""
    if case.film.solution != "table":
        return None
    obstacle = table_obstacle(case)
    if clipped:
        obstacle = "" if tabulated else TURNING
    if not obstacle:
        return None
    return Fault("film.solution", "table", None, f"cannot be: {obstacle}.", "Choose auto or cells.")
