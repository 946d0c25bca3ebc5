"""Channels that couple two films hydraulically: where they open, and what resists the flow through them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from frbcli.film.gap import Hole


@dataclass(frozen=True)
class FeedHole:
    """An opening of a channel: the number of the film, and a hole of its section."""

    film: int
    hole: Hole


@dataclass(frozen=True)
class Channel:
    """A bore between two films. inner, outer: its feed holes, the outer one None where it opens to a groove of a gauge
    pressure in Pa; resistance in Pa s / m^3; centrifugal: in Pa s^2, see CHANNEL."""

    inner: FeedHole
    outer: FeedHole | None
    resistance: float
    groove_pressure: float
    centrifugal: float


def channel_resistance(diameter: float, length: float, viscosity: float) -> float:
    """Pa s / m^3 of laminar flow through a round bore (Hagen and Poiseuille); m, m, Pa s."""
    return 128.0 * viscosity * length / (math.pi * diameter**4)
