"""Channels that couple two films hydraulically: where they open, what flows through them, as arrays for the kernels.

A mouth lies over some cells of a film, whose oil and pressure follow the law of that film like those of all others.
Each cell of a mouth exchanges oil with the channel over a conductance that is large against that of the gap, so that
they have one pressure as long as they are full; a mouth in a cavity takes what comes at the pressure of the cavity.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.film.cells.data import (
    CHANNEL_NUMBERS,
    CONDUCTANCE,
    EXCHANGE,
    FILM,
    FLOW_SCALE,
    GROOVE_PRESSURE,
    INNER,
    MOUTH,
    MOUTH_NUMBERS,
    OUTER,
    PRESSURE_SCALE,
    RESISTANCE,
    SLOT,
    THROWN,
    UNKNOWN,
    VolumeFilms,
)
from frbcli.film.cells.openings import hole_opening
from frbcli.film.cells.plain.film import VolumeFilm
from frbcli.film.gap import Hole
from frbcli.film.grid import Array

IN_GROOVE = -1.0  # in place of a mouth
OPENNESS = 1e5  # of a mouth over its gap, centred: the conductances between channel and film, and along the film


@dataclass(frozen=True)
class Mouth:
    """Where a channel opens: the number of the film, and a hole of its section."""

    film: int
    hole: Hole


@dataclass(frozen=True)
class Channel:
    """A bore between two films. inner, outer: its mouths, the outer one None where it opens to a groove of a gauge
    pressure in Pa; resistance in Pa s / m^3; thrown: in Pa s^2, see CHANNEL_NUMBERS."""

    inner: Mouth
    outer: Mouth | None
    resistance: float
    groove_pressure: float
    thrown: float


def channel_resistance(diameter: float, length: float, viscosity: float) -> float:
    """Pa s / m^3 of laminar flow through a round bore (Hagen and Poiseuille); m, m, Pa s."""
    return 128.0 * viscosity * length / (math.pi * diameter**4)


def with_channels(data: VolumeFilms, films: Sequence[VolumeFilm], channels: Sequence[Channel]) -> VolumeFilms:
    """The films with channels between them; the cells of their mouths, given in `films`, become unknown.

    A bore that is too small for the mesh has no cells: its channel is closed.
    """
    channels = [channel for channel in channels if _is_open(films, channel.inner) and _is_open(films, channel.outer)]
    if not channels:
        return data
    cells = data.cells.copy()
    rows, mouths, places = np.zeros((len(channels), CHANNEL_NUMBERS)), [], []
    slots = dict.fromkeys(range(len(films)), 0)

    def opened(mouth: Mouth) -> int:
        film, size = films[mouth.film], cells[mouth.film]
        inside = _cells(film, mouth)
        slot = slots[mouth.film]
        slots[mouth.film] += 1
        size[UNKNOWN][inside], size[EXCHANGE][inside] = 1.0, _conductances(film)[inside]
        size[MOUTH][inside] = 1.0 + slot
        numbers = np.zeros(MOUTH_NUMBERS)
        numbers[FILM], numbers[SLOT] = mouth.film, slot
        section = film.section
        numbers[FLOW_SCALE] = section.copies * section.radius * section.width * section.clearance
        numbers[PRESSURE_SCALE], numbers[CONDUCTANCE] = section.pressure_scale, size[EXCHANGE][inside].sum()
        mouths.append(numbers)
        places.append(np.argwhere(inside))
        return len(mouths) - 1

    for row, channel in zip(rows, channels, strict=True):
        row[INNER] = opened(channel.inner)
        row[OUTER] = IN_GROOVE if channel.outer is None else opened(channel.outer)
        row[RESISTANCE], row[GROOVE_PRESSURE] = channel.resistance, channel.groove_pressure
        row[THROWN] = channel.thrown
    filled = np.full((len(places), max(map(len, places)), 2), -1, dtype=np.int64)
    for place, own in zip(filled, places, strict=True):
        place[: len(own)] = own
    return data._replace(cells=cells, channels=rows, mouths=np.array(mouths), mouth_cells=filled)


def _cells(film: VolumeFilm, mouth: Mouth) -> NDArray[np.bool_]:
    """(m, k) those under a mouth."""
    return hole_opening(film.section, mouth.hole, film.grid.phi, film.grid.z).inside


def _is_open(films: Sequence[VolumeFilm], mouth: Mouth | None) -> bool:
    return mouth is None or bool(_cells(films[mouth.film], mouth).any())


def _conductances(film: VolumeFilm) -> Array:
    """(m, k) of each cell to a channel above it."""
    around, along = np.diff(film.grid.phi)[:, None], np.diff(film.grid.z)[None, :]
    return np.asarray(OPENNESS * (along / around + film.section.aspect * around / along), dtype=np.float64)
