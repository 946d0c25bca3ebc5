"""The channels of floating rings: the pressure of their feed holes, or how they couple the two films of a ring."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.case.supplies.bores import Bores
from frbcli.case.supplies.supply import MIDDLE
from frbcli.errors import Fault
from frbcli.film.cells.channels.channel import Channel, FeedHole, channel_resistance
from frbcli.film.cells.film import VolumeFilm
from frbcli.scene.keys import bearing_key

INLETS = "a groove around one end of the outer film, or an end in an oil bath"


def coupled(bearing: FloatingRingBearing) -> bool:
    """Whether the channels of a ring couple its films."""
    return bearing.channels == "coupled"


def coupled_rings(case: Case) -> Iterator[tuple[str, FloatingRingBearing]]:
    """The rings whose channels couple their films, each with the key that says so."""
    for index, bearing in enumerate(case.bearings):
        if isinstance(bearing, FloatingRingBearing) and coupled(bearing):
            yield f"{bearing_key(case, index)}.channels", bearing


def coupling_faults(case: Case, problem: str, remedy: str) -> Iterator[Fault]:
    """The faults of all channels that couple films, where these are not modelled."""
    return (Fault(key, "coupled", None, problem, remedy) for key, _ in coupled_rings(case))


def opens_to_groove(bearing: FloatingRingBearing) -> bool:
    """Whether the channels open to a groove around the middle of the outer film, which holds its pressure."""
    return bearing.outer.supply.splits


def feed_holes_in_outer_film(bearing: FloatingRingBearing) -> Bores | None:
    """The feed holes of the outer film at the channels; None if these are not coupled or open to a groove."""
    supply = bearing.inner.supply.channels
    if supply is None or not coupled(bearing) or opens_to_groove(bearing):
        return None
    offset = (supply.axial_position - MIDDLE) * bearing.inner.width / bearing.outer.width
    return altered(supply, {"axial_position": MIDDLE + offset})


def centrifugal_pressure(case: Case, bearing: FloatingRingBearing) -> float:
    """Centrifugal pressure of a channel over the square of the ring speed, (4.27), Pa s^2."""
    if not bearing.centrifugal_pressure:
        return 0.0
    inside, outside = 0.5 * bearing.inner.diameter, 0.5 * bearing.outer.diameter
    return 0.5 * case.oil.density * (outside**2 - inside**2)


def resistance(case: Case, bearing: FloatingRingBearing) -> float:
    """Flow resistance of one channel in Pa s / m^3."""
    supply = bearing.inner.supply.channels
    assert supply is not None
    length = 0.5 * (bearing.outer.diameter - bearing.inner.diameter)
    return channel_resistance(supply.diameter, length, case.oil_viscosity)


def coupled_channels(case: Case, volumes: Sequence[VolumeFilm]) -> tuple[Channel, ...]:
    """The coupled channels of all rings. volumes: of all films in their order, the feed holes as their last holes."""
    channels: list[Channel] = []
    film = 0
    for bearing in case.bearings:
        if not isinstance(bearing, FloatingRingBearing):
            film += 1
            continue
        supply = bearing.inner.supply.channels
        if coupled(bearing) and supply is not None:
            inner = volumes[film].section.holes[-supply.count :]
            outer = volumes[film + 1].section.holes[-supply.count :]
            for index in range(supply.count):
                channels.append(
                    Channel(
                        inner=FeedHole(film, inner[index]),
                        outer=None if opens_to_groove(bearing) else FeedHole(film + 1, outer[index]),
                        resistance=resistance(case, bearing),
                        groove_pressure=bearing.outer.supply.gauge(case.oil.ambient_pressure),
                        centrifugal=centrifugal_pressure(case, bearing),
                    )
                )
        film += 2
    return tuple(channels)


def channel_faults(case: Case) -> Iterator[Fault]:
    """The faults of coupled channels."""
    for key, bearing in coupled_rings(case):
        problem, remedy = _problem(bearing)
        if problem:
            yield Fault(key, "coupled", None, problem, remedy)


def _problem(bearing: FloatingRingBearing) -> tuple[str, str]:
    supply, outer = bearing.inner.supply.channels, bearing.outer
    if supply is None:
        return "needs channels, and the inner film has no feed holes.", 'Write inner.supply.kind = "bores".'
    if supply.on == "journal":
        return "needs channels through the ring; the feed holes are in the journal.", 'Write inner.supply.on = "shell".'
    if not outer.supply.feeds and not {"oil-bath"} & {bearing.inner.ends, outer.ends}:
        return "leaves the bearing without a supply from outside.", f"Give it {INLETS}."
    if outer.supply.splits:
        if supply.axial_position == MIDDLE:
            return "", ""
        problem = "asks for feed holes next to a central groove, which makes two different outer films."
        return problem, "Put the feed holes in the middle, or the groove at an end of the outer film."
    if bearing.ring.spin == "free" and not outer.supply.plain:
        problem = f"asks for {outer.supply.kind} in the housing, which the feed holes of a turning ring pass."
        return problem, f"Give it {INLETS}, or a ring that does not turn."
    if bearing.ring.spin == "free" and outer.shell is not None:
        problem = f"asks for {outer.shell.words} in the housing, which the feed holes of a turning ring pass."
        return problem, f"Remove outer.{outer.shell.key}."
    return "", ""
