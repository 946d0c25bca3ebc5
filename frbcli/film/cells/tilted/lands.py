"""A bearing whose journal tilts as the lands that are solved for it, and the sum of their loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from frbcli.film.cells.loads import FilmLoads, GasBalance, OilBalance, Torque
from frbcli.film.cells.motion import Motion, Path
from frbcli.film.gap import Section


@dataclass(frozen=True)
class Land:
    """A section of a bearing with the motion that it sees.

    side: 1, or -1 where z of the section runs against z of the bearing; centre: of the middle of the section, in m from
    the bearing's. """

    section: Section
    motion: Motion
    side: float
    centre: float

    def moment(self, loads: FilmLoads) -> tuple[float, float]:
        """Moments in N m about the middle of the bearing, from those about the middle of the section."""
        x, y = loads.force
        return self.side * loads.moment[0] - self.centre * y, self.side * loads.moment[1] + self.centre * x


def lands(section: Section, motion: Motion, mirrored: bool) -> tuple[Land, ...]:
    """The lands of a bearing: its section, or the two next to a groove in the middle where they differ.

    motion: of the bearing, its slopes over the whole width; mirrored: whether z of a single section runs against z of
    the bearing. """
    if not motion.tilts:
        return (Land(section, motion, -1.0 if mirrored else 1.0, 0.0),)
    return tuple(_land(one, motion, side, centre) for one, side, centre in parts(section, mirrored))


def parts(section: Section, mirrored: bool) -> tuple[tuple[Section, float, float], ...]:
    """The sections that a bearing whose journal tilts is solved on, with side and centre of each, see Land."""
    if section.copies == 1:
        return ((section, -1.0 if mirrored else 1.0, 0.0),)
    one = replace(section, copies=1)
    return tuple((one, side, -side * 0.5 * section.width) for side in (1.0, -1.0))


def land_paths(section: Section, path: Path, mirrored: bool) -> tuple[tuple[Section, Path], ...]:
    """The section of each of the lands, and the motion that it sees over time while the bearing sees `path`."""

    def path_of(number: int) -> Path:
        return lambda time: lands(section, path(time), mirrored)[number].motion

    return tuple((land.section, path_of(number)) for number, land in enumerate(lands(section, path(0.0), mirrored)))


def _land(section: Section, motion: Motion, side: float, centre: float) -> Land:
    place, share = centre / section.bearing_width, side * section.width / section.bearing_width
    moved = [
        ((middle[0] + place * growth[0], middle[1] + place * growth[1]), (share * growth[0], share * growth[1]))
        for middle, growth in ((motion.d, motion.slope), (motion.v, motion.slope_rate))
    ]
    (d, slope), (v, slope_rate) = moved
    return Land(section, Motion(d, v, motion.omega, slope, slope_rate), side, centre)


def summed(films: Sequence[tuple[Land, FilmLoads]]) -> FilmLoads:
    """The loads of a bearing, summed over its lands."""
    loads = [each for _, each in films]
    moments = [land.moment(each) for land, each in films]
    if len(loads) == 1:
        return replace(loads[0], moment=moments[0])
    oil = [each.oil for each in loads]
    passed = [max(each.in_m3_s, each.out_m3_s) for each in oil]
    lost = sum(each.defect_relative * size for each, size in zip(oil, passed, strict=True))
    return FilmLoads(
        force=_sum([each.force for each in loads]),
        torque=Torque(sum(each.torque.couette for each in loads), sum(each.torque.poiseuille for each in loads)),
        p_max=max(each.p_max for each in loads),
        p_min=min(each.p_min for each in loads),
        oil_fraction=sum(each.oil_fraction for each in loads) / len(loads),
        oil=OilBalance(
            sum(each.in_m3_s for each in oil),
            sum(each.out_m3_s for each in oil),
            sum(each.supply_m3_s for each in oil),
            sum(each.ends_m3_s for each in oil),
            lost / sum(passed) if sum(passed) > 0.0 else 0.0,
        ),
        moment=_sum(moments),
        gas=_gas([each.gas for each in loads if each.gas is not None]),
    )


def _gas(parts: Sequence[GasBalance]) -> GasBalance | None:
    """The gas of a bearing, summed over its lands, which hold about as much oil."""
    if not parts:
        return None
    return GasBalance(
        sum(each.share for each in parts) / len(parts),
        sum(each.in_m3_s for each in parts),
        sum(each.out_m3_s for each in parts),
        sum(each.released_m3_s for each in parts),
        max(each.defect_relative for each in parts),
    )


def _sum(vectors: Sequence[tuple[float, float]]) -> tuple[float, float]:
    return sum(x for x, _ in vectors), sum(y for _, y in vectors)
