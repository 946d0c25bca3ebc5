"""A limit cycle on its branch: how large it is, and how many harmonics it has."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.cycles.method.balance import moments, motion_along, unpacked
from frbcli.cycles.method.continuation import Place
from frbcli.cycles.method.floquet import Multipliers
from frbcli.cycles.parts.machine import Machine

FIRST_HARMONICS = 5  # of a cycle of no size
MOMENTS = 256  # of a period at which eccentricities are taken
FOLD, FLIP, TORUS, HOPF = "fold", "flip", "torus", "hopf"
ASKED = "asked"  # a cycle at a speed that was asked for


@dataclass(frozen=True)
class Cycle:
    """A limit cycle. place: on its branch, with its tangent; machine: whose cycle it is; y: see balance.py;
    eccentricity_max: (F,)."""

    place: Place
    machine: Machine
    y: Array
    eccentricity_max: Array
    multipliers: Multipliers
    kind: str = ""


def with_harmonics(vector: Array, c: int, harmonics: int, numbers: int = 2) -> Array:
    """Unknowns of a cycle with other harmonics, new ones zero. numbers: how many stand behind them, frequency, speed
    and what else."""
    body = np.zeros(c * (2 * harmonics + 1))
    kept = min(len(body), len(vector) - numbers)
    body[:kept] = vector[:kept]
    return np.concatenate([body, vector[-numbers:]])


def resized(place: Place, c: int, harmonics: int) -> Place:
    """The place with other harmonics, new ones zero; as it was found."""
    tangent = with_harmonics(place.tangent, c, harmonics)
    return replace(place, y=with_harmonics(place.y, c, harmonics), tangent=tangent / np.linalg.norm(tangent))


def resized_like(place: Place, other: Place, c: int) -> Place:
    """The place with as many harmonics as another."""
    return place if len(place.y) == len(other.y) else resized(place, c, (len(other.y) - 2) // c // 2)


def eccentricities(machine: Machine, y: Array) -> Array:
    """(F,) largest eccentricity of each film on the cycle y."""
    motion = unpacked(y[:-2], machine.size)
    u, _ = motion_along(motion, max(MOMENTS, moments(len(motion))))
    return largest_of(u[:, : 2 * machine.film_count])


def largest_of(displacements: Array) -> Array:
    """(F,) largest eccentricities of displacements (n, 2 F)."""
    return np.asarray(np.hypot(displacements[:, 0::2], displacements[:, 1::2]).max(axis=0))


def largest(machine: Machine, y: Array) -> float:
    """The largest eccentricity of all films on the cycle y."""
    return float(eccentricities(machine, y).max())


def amplitude(machine: Machine, y: Array) -> float:
    """Size over the clearance of what is not the mean of the cycle."""
    motion = unpacked(y[:-2], machine.size)[1:, : 2 * machine.film_count]
    return float(2.0 * np.abs(motion).max(initial=0.0))


def passed_rest(machine: Machine, before: Place, after: Place) -> bool:
    """Whether the cycle has shrunk to rest between two places: behind it the branch comes back."""
    one, other = (unpacked(place.y[:-2], machine.size)[1] for place in (before, after))
    return bool(np.sum(np.conj(one) * other).real < 0.0)
