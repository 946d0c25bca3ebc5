"""What cannot be solved on a section, said before it is tried."""

from __future__ import annotations

import itertools
import math

from frbcli.film.gap import Hole, Section

TURN = 2.0 * math.pi


def runs_dry(section: Section) -> bool:
    """Whether oil can leave the section but not enter it: its ends are free to air and nothing supplies it."""
    inlets = {"oil-bath", "groove"} & {section.near, section.far}
    return not inlets and not section.grooves and not section.holes


def section_faults(section: Section, d: tuple[float, float] = (0.0, 0.0)) -> list[str]:
    """Everything that is wrong with a section and the displacement d (over the clearance), each with its remedy."""
    return [*_size_faults(section), *_gap_faults(d), *_inlet_faults(section), *_overlaps(section)]


def _size_faults(section: Section) -> list[str]:
    sizes = {
        "radius": section.radius, "width": section.width, "clearance": section.clearance,
        "viscosity": section.viscosity, "ambient pressure": section.ambient_pressure,
    }  # fmt: skip
    faults = [f"the {name} is {value:g}: it must be greater than 0" for name, value in sizes.items() if not value > 0.0]
    if runs_dry(section):
        faults.append(
            "both ends are free to air and nothing supplies oil: the film runs dry. "
            "Give it a supply, or ends in an oil bath"
        )
    return faults


def _gap_faults(d: tuple[float, float]) -> list[str]:
    eccentricity = math.hypot(*d)
    if eccentricity < 1.0:
        return []
    return [f"the eccentricity is {eccentricity:g}, which leaves no gap: it must be less than 1 clearance"]


def _inlet_faults(section: Section) -> list[str]:
    faults = []
    for groove in section.grooves:
        if not 0.0 < groove.opening < TURN:
            faults.append(f"a groove opens over {math.degrees(groove.opening):g} deg: it must be between 0 and 360 deg")
    for hole in section.holes:
        where = f"the hole at phi = {math.degrees(hole.position):g} deg"
        if not (hole.half_angle > 0.0 and hole.half_width > 0.0):
            faults.append(f"{where} has no size: its half extents must be greater than 0")
        elif hole.half_angle >= math.pi:
            faults.append(f"{where} is wider than the whole turn: make it smaller")
        faults.extend(f"{where} {problem}" for problem in _reach(section, hole))
    return faults


def _reach(section: Section, hole: Hole) -> list[str]:
    """A hole may cross the plane of symmetry, where its other half lies, but no open end."""
    low, high = hole.axial - hole.half_width, hole.axial + hole.half_width
    tolerance = 1e-9 * section.width
    beyond = low < -tolerance or (high > section.width + tolerance and section.far != "symmetry")
    if not beyond and hole.axial <= section.width + tolerance:
        return []
    return [
        f"reaches from {1e3 * low:.4g} to {1e3 * high:.4g} mm, out of the film of 0 to {1e3 * section.width:.4g} mm: "
        "move it or make it smaller"
    ]


def _overlaps(section: Section) -> list[str]:
    faults = []
    for groove, other in itertools.combinations(section.grooves, 2):
        if _apart(groove.position, other.position) < 0.5 * (groove.opening + other.opening):
            faults.append(_overlap("the grooves at", groove.position, other.position))
    for a, b in itertools.combinations(section.holes, 2):
        if _holes_overlap(a, b):
            faults.append(_overlap("the holes at", a.position, b.position))
    for groove, hole in itertools.product(section.grooves, section.holes):
        if _apart(groove.position, hole.position) < 0.5 * groove.opening + hole.half_angle:
            faults.append(_overlap("a groove and a hole at", groove.position, hole.position))
    return faults


def _overlap(what: str, a: float, b: float) -> str:
    return f"{what} phi = {math.degrees(a):g} and {math.degrees(b):g} deg overlap: move them apart"


def _holes_overlap(a: Hole, b: Hole) -> bool:
    """Whether two holes touch; of round ones it is asked as of circles with the sum of their half extents."""
    around = _apart(a.position, b.position) / (a.half_angle + b.half_angle)
    along = abs(a.axial - b.axial) / (a.half_width + b.half_width)
    return math.hypot(around, along) < 1.0 if a.round and b.round else max(around, along) < 1.0


def _apart(a: float, b: float) -> float:
    """Angle between two directions, 0 to pi."""
    return abs(math.remainder(a - b, TURN))
