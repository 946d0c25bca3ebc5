"""Faults of a section that cannot be solved, found before it is tried."""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

from frbcli.film.cavitation.law import Law
from frbcli.film.gap import NO_BATH, Hole, Section

TURN = 2.0 * math.pi
MOST_OPENED = 1.0 - 1e-6  # of a section by its openings: beyond, no film is left


class SectionFault(NamedTuple):
    """A fault of a section, and its remedy."""

    problem: str
    remedy: str


def runs_dry(section: Section) -> bool:
    """Whether oil can leave the section but not enter it: its ends are free to air and nothing supplies it."""
    inlets = {"oil-bath", "groove"} & {section.near, section.far}
    return not inlets and not section.grooves and not section.holes and section.bath <= NO_BATH


def starves(section: Section) -> bool:
    """Whether a film that conserves its oil has no inflow: its ends are free to air, and nothing supplies it but a
    groove along the edge z = 1 with a pressure that is not above the cavity pressure."""
    if "oil-bath" in (section.near, section.far) or section.grooves or section.holes or section.bath > NO_BATH:
        return False
    return section.far != "groove" or section.ambient_pressure + section.far_pressure <= section.cavitation_pressure


def no_inflow(section: Section) -> bool:
    """Whether no pressure pushes oil into the section: nothing opens into it, and no edge is above its cavities."""
    if section.grooves or section.holes:
        return False
    edges = {"oil-bath": 0.0, "groove": section.far_pressure} | ({"free-to-air": 0.0} if section.bath > NO_BATH else {})
    highest = max((edges[edge] for edge in (section.near, section.far) if edge in edges), default=-math.inf)
    return section.ambient_pressure + highest <= section.cavitation_pressure


def is_unfed(section: Section, law: type[Law]) -> bool:
    """Whether a film has no pressurised supply. It depends on the law: a film that empties does so in an oil bath,
    too; a film whose cavities have a pressure below p_cav draws oil from any groove."""
    if law.empties:
        return no_inflow(section)
    return runs_dry(section) if law.keeps_oil and not law.starves else starves(section)


def section_faults(section: Section) -> list[SectionFault]:
    """Everything that is wrong with a section, each with its remedy."""
    return [*_size_faults(section), *_profile_faults(section), *_inlet_faults(section), *_overlaps(section)]


def _size_faults(section: Section) -> list[SectionFault]:
    sizes = {
        "radius": section.radius, "width": section.width, "clearance": section.clearance,
        "viscosity": section.viscosity, "ambient pressure": section.ambient_pressure,
    }  # fmt: skip
    faults = [
        SectionFault(f"the {name} is {value:g}", "It must be greater than 0.")
        for name, value in sizes.items()
        if not value > 0.0
    ]
    if runs_dry(section):
        problem = "both ends are free to air and nothing supplies oil: the film runs dry"
        faults.append(SectionFault(problem, "Give it a supply, or ends in an oil bath."))
    return faults


def _profile_faults(section: Section) -> list[SectionFault]:
    problem, remedy = ("", "") if section.profile is None else section.profile.fault
    return [SectionFault(problem, remedy)] if problem else []


def _inlet_faults(section: Section) -> list[SectionFault]:
    faults = []
    for groove in section.grooves:
        if not 0.0 < groove.opening < TURN:
            problem = f"a groove opens over {math.degrees(groove.opening):g} deg"
            faults.append(SectionFault(problem, "It must be between 0 and 360 deg."))
    for hole in section.holes:
        where = f"the hole at phi = {math.degrees(hole.position):g} deg"
        if not (hole.half_angle > 0.0 and hole.half_width > 0.0):
            faults.append(SectionFault(f"{where} has no size", "Its half extents must be greater than 0."))
        elif hole.half_angle >= math.pi:
            faults.append(SectionFault(f"{where} is wider than the whole turn", "Make it smaller."))
        if beyond := _reach(section, hole):
            faults.append(SectionFault(f"{where} {beyond}", "Move it or make it smaller."))
    if not faults and _opened(section) > MOST_OPENED:
        faults.append(SectionFault("its openings leave no land", "Take fewer of them, or smaller ones."))
    return faults


def _opened(section: Section) -> float:
    """The share of the section that grooves and holes take, a round hole as the rectangle around it."""
    grooves = sum(groove.opening for groove in section.grooves) / TURN
    return grooves + sum(4.0 * hole.half_angle * hole.half_width for hole in section.holes) / (TURN * section.width)


def _reach(section: Section, hole: Hole) -> str:
    """The place of a hole that leaves the film, else nothing: it may cross the plane of
    symmetry, where its other half lies, but no open end."""
    low, high = hole.axial - hole.half_width, hole.axial + hole.half_width
    tolerance = 1e-9 * section.width
    beyond = low < -tolerance or (high > section.width + tolerance and section.far != "symmetry")
    if not beyond and hole.axial <= section.width + tolerance:
        return ""
    return f"reaches from {1e3 * low:.4g} to {1e3 * high:.4g} mm, out of the film of 0 to {1e3 * section.width:.4g} mm"


def _overlaps(section: Section) -> list[SectionFault]:
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


def _overlap(what: str, a: float, b: float) -> SectionFault:
    return SectionFault(f"{what} phi = {math.degrees(a):g} and {math.degrees(b):g} deg overlap", "Move them apart.")


def _holes_overlap(a: Hole, b: Hole) -> bool:
    """Whether two holes touch; of round ones it is asked as of circles with the sum of their half extents."""
    around = _apart(a.position, b.position) / (a.half_angle + b.half_angle)
    along = abs(a.axial - b.axial) / (a.half_width + b.half_width)
    return math.hypot(around, along) < 1.0 if a.round and b.round else max(around, along) < 1.0


def _apart(a: float, b: float) -> float:
    """Angle between two directions, 0 to pi."""
    return abs(math.remainder(a - b, TURN))
