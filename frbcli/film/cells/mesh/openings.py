"""Grooves, pockets and bores on the cells of a section: which cells they hold, where their edges are, their area."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.gap import NO_BATH, AxialGroove, Hole, Section

NO_HOLE = 1e-3  # of the cells at its middle: a hole smaller than this supplies nothing


class Opening(NamedTuple):
    """A groove or hole on cells. inside: (m, k) those whose middles it holds; around, along: (m, k) distances from the
    middle of a cell to its edge, in rad at the same z and over the width at the same phi, negative within; cover:
    (m, k) the share of each cell's area that it takes."""

    inside: NDArray[np.bool_]
    around: Array
    along: Array
    cover: Array


def groove_opening(groove: AxialGroove, phi: Array, z: Array) -> Opening:
    """A groove over the whole width on cells with the boundaries phi (m + 1,) in rad and z (k + 1,) over [0, 1]."""
    shape = len(phi) - 1, len(z) - 1
    half = 0.5 * groove.opening
    around = np.abs(wrapped(0.5 * (phi[1:] + phi[:-1]) - groove.position)) - half
    cover = _interval_cover(phi, groove.position, half)
    spread = np.broadcast_to(around[:, None], shape)
    return Opening(spread < 0.0, spread, np.full(shape, -np.inf), np.broadcast_to(cover[:, None], shape))


def hole_opening(section: Section, hole: Hole, phi: Array, z: Array, height: Array) -> Opening:
    """A bore or pocket on cells with the boundaries phi (m + 1,) in rad and z (k + 1,) over [0, 1].

    height: (k,) axial positions of their unknowns."""
    middle, half = hole.axial / section.width, hole.half_width / section.width
    across = np.abs(wrapped(0.5 * (phi[1:] + phi[:-1]) - hole.position))[:, None]
    along = np.abs(height - middle)[None, :]
    u, v = across / hole.half_angle, along / half
    if hole.round:
        inside = np.hypot(u, v) < 1.0
        reach_u, reach_v = np.sqrt(np.maximum(1.0 - v**2, 0.0)), np.sqrt(np.maximum(1.0 - u**2, 0.0))
        cover = _ellipse_cover(phi, z, hole, middle, half)
    else:
        inside = np.maximum(u, v) < 1.0
        reach_u, reach_v = np.ones_like(v), np.ones_like(u)
        cover = _interval_cover(phi, hole.position, hole.half_angle)[:, None] * _share(z, middle - half, middle + half)
    if not inside.any() and cover.max() > 0.0:
        inside = _at_middle(np.hypot(u, v), cover, np.diff(phi)[:, None] * np.diff(z))
    return Opening(inside, across - hole.half_angle * reach_u, along - half * reach_v, cover)


def bathed(section: Section, phi: Array) -> Array:
    """(m,) share of each cell with the boundaries phi (m + 1,) whose free ends lie in the bath at the bottom."""
    if section.bath <= NO_BATH:
        return np.zeros(len(phi) - 1)
    return _interval_cover(phi, math.pi, math.pi - math.acos(section.bath))


def wrapped(angle: Array) -> Array:
    """Angles brought to [-pi, pi)."""
    return np.asarray(np.mod(angle + math.pi, 2.0 * math.pi) - math.pi, dtype=np.float64)


def _at_middle(distance: Array, cover: Array, area: Array) -> NDArray[np.bool_]:
    """The cells nearest to the middle of a hole that is smaller than a cell, so that a coarse mesh does not close it.

    Cells at the same distance go together, so that symmetry is kept.
    """
    nearest = np.round(distance - distance.min(), 9) == 0.0
    enough = (cover * area).sum() > NO_HOLE * (nearest * area).sum()
    return np.asarray(nearest & enough, dtype=np.bool_)


def _interval_cover(phi: Array, position: float, half: float) -> Array:
    """(m,) share of each of the intervals between the angles phi (m + 1,) that lies within half of a position."""
    first = phi[0] + math.fmod(position - phi[0], 2.0 * math.pi)
    turns = first + 2.0 * math.pi * np.arange(-1, 2)
    return np.asarray(sum(_share(phi, float(at) - half, float(at) + half) for at in turns), dtype=np.float64)


def _share(faces: Array, low: float, high: float) -> Array:
    """(n,) share of each of the intervals between the faces (n + 1,) that lies between low and high."""
    return np.asarray(np.diff(np.clip(faces, low, high)) / np.diff(faces), dtype=np.float64)


def _ellipse_cover(phi: Array, z: Array, hole: Hole, middle: float, half: float) -> Array:
    """(m, k) share of each cell within an ellipse, exact."""
    first = phi[0] + math.fmod(hole.position - phi[0], 2.0 * math.pi)
    v = np.clip((z - middle) / half, -1.0, 1.0)
    area = np.zeros((len(phi) - 1, len(z) - 1))
    for turn in (-1, 0, 1):
        u = np.clip((phi - first - 2.0 * math.pi * turn) / hole.half_angle, -1.0, 1.0)
        area += np.diff(np.diff(_disk_corner(u[:, None], v[None, :]), axis=0), axis=1)
    return area * hole.half_angle * half / (np.diff(phi)[:, None] * np.diff(z))


def _disk_corner(u: Array, v: Array) -> Array:
    """Area of the unit disk left of the abscissa u and below the ordinate v, each in [-1, 1]; the shapes broadcast."""
    half_chord = np.sqrt(1.0 - v**2)
    sides = _below_circle(np.minimum(u, -half_chord)) + np.abs(v) * (np.clip(u, -half_chord, half_chord) + half_chord)
    sides = sides + _below_circle(np.maximum(u, half_chord)) - _below_circle(half_chord)
    return np.asarray(_below_circle(u) + np.sign(v) * sides, dtype=np.float64)


def _below_circle(t: Array) -> Array:
    """Area between the abscissa and the upper unit half circle from -1 to t in [-1, 1]."""
    return np.asarray(0.5 * (t * np.sqrt(1.0 - t**2) + np.arcsin(t)) + 0.25 * math.pi, dtype=np.float64)
