"""The tilt of a journal against its shell in a kinematic test, and where it closes the gap.

A tilt (t_x, t_y) is a small rotation about the axes through the middle of the bearing: the centre of the journal at z
lies at (x + z t_y, y - z t_x).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from frbcli.case.bearing import SingleFilmBearing
from frbcli.case.schema import Case
from frbcli.film.gap import Section, smallest_gap
from frbcli.scene.gate.rule import ROTATION, SQUEEZE
from frbcli.scene.keys import bearing_key

Pair = tuple[float, float]
NONE = (0.0, 0.0)
AROUND = 36  # places of a whirl, between which only lobed shells have less gap


def tilt_of(case: Case) -> Pair:
    """Tilt of the journal against the shell in rad."""
    motion, bearing = case.motion, case.bearings[0]
    journal = NONE if motion is None or motion.tilt is None else motion.tilt
    shell = bearing.misalignment if isinstance(bearing, SingleFilmBearing) else None
    return journal if shell is None else (journal[0] - shell[0], journal[1] - shell[1])


def tilt_rate_of(case: Case) -> Pair:
    """How fast the journal tilts, in rad/s."""
    motion = case.motion
    return NONE if motion is None or motion.tilt_rate is None else motion.tilt_rate


def tilts(case: Case) -> bool:
    """Whether the gap of the bearing, or its rate of change, differs along the axis."""
    return tilt_of(case) != NONE or tilt_rate_of(case) != NONE


def states_moment(case: Case) -> bool:
    """Whether a kinematic test states the moment of the film force."""
    return case.motion is not None and (case.motion.states_moment or tilts(case))


def slope_of(tilt: Pair, section: Section) -> Pair:
    """Growth of the displacement over the clearance, or of its rate, over the width of the whole bearing."""
    length = section.bearing_width / section.clearance
    return length * tilt[1] + 0.0, -length * tilt[0] + 0.0  # no negative zero


def gaps_at_ends(section: Section, d: Pair, slope: Pair) -> Pair:
    """The least H at the ends z < 0 and z > 0 of a bearing; in between it is linear in z."""
    at = [(d[0] + side * slope[0], d[1] + side * slope[1]) for side in (-0.5, 0.5)]
    return smallest_gap(section, at[0]), smallest_gap(section, at[1])


def displacement_of(case: Case) -> Pair:
    """Displacement over the clearance that a rotation is given."""
    assert case.motion is not None
    e, angle = case.motion.eccentricity or 0.0, case.motion.angle
    return e * math.cos(angle), e * math.sin(angle)


def places_of(case: Case, test: str) -> list[Pair]:
    """Displacements over the clearance at which a test brings the ends of the journal nearest to the shell: the gap, a
    concave function of them, is least at the ends of a line and on the rim of a disk."""
    assert case.motion is not None
    e, toward = case.motion.eccentricity or 0.0, tilt_of(case)
    if test == ROTATION:
        return [displacement_of(case)]
    if test == SQUEEZE:
        return [(0.0, -e), (0.0, e)]
    begin = math.atan2(-toward[0], toward[1])  # the direction of the slope
    angles = (begin + 2.0 * math.pi * i / AROUND for i in range(AROUND))
    return [(e * math.cos(angle), e * math.sin(angle)) for angle in angles]


def least_gaps(section: Section, places: list[Pair], slope: Pair) -> Pair:
    """The least of gaps_at_ends of all places."""
    low, high = zip(*(gaps_at_ends(section, place, slope) for place in places), strict=True)
    return min(low), min(high)


def tilt_key(case: Case) -> tuple[str, str]:
    """The key that tilts the journal against the shell, and its value."""
    for key in ("tilt", "tilt_rate"):
        given = getattr(case.motion, key, None)
        if given is not None and any(given):
            return f"motion.{key}", as_text(given)
    tilt = tilt_of(case)
    return f"{bearing_key(case, 0)}.misalignment", as_text((-tilt[0], -tilt[1]))


def misaligned(case: Case) -> Iterator[tuple[str, str]]:
    """The key and the value of each shell that is not in line."""
    for index, bearing in enumerate(case.bearings):
        if bearing.misalignment is not None and any(bearing.misalignment):
            yield f"{bearing_key(case, index)}.misalignment", as_text(bearing.misalignment)


def as_text(given: Pair) -> str:
    """A tilt in rad, or its rate, as a fault shows it."""
    return f"{given[0]:.6g}, {given[1]:.6g}"
