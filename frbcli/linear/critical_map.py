"""The undamped critical speed map: critical speeds of a rotor over the stiffness of its bearings.

With equal stiffness in all directions a whirl has one complex coordinate, and at a rotor speed that equals its
frequency the equation of the rotor becomes

    k u = omega^2 (m - g) u forward,      k u = omega^2 (m + g) u backward,

m, g and k being mass, gyroscopic term and stiffness of one plane. Rings are left out: a bearing is one spring.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import Column, Table, Tabular, spread_table
from frbcli.errors import Fault, InputError
from frbcli.linear.modes import direct_springs
from frbcli.linear.stability_point import StabilityPoint
from frbcli.rotor.assembly import Link, assembled
from frbcli.scene.gate.gate import require
from frbcli.scene.machine.findings import findings
from frbcli.scene.machine.rotor import first_without_film, support_faults
from frbcli.scene.machine.turbocharger import shaft_of

STIFFNESSES = 61
DECADES = (-3.0, 2.0)  # about the stiffness on which the rotor as a rigid mass has its highest speed as frequency
SHOWN = 4  # slowest critical speeds of each direction



def _nth(direction: str, number: int) -> Callable[[Any], Array]:
    return lambda criticals: np.asarray(getattr(criticals, direction)[:, number])


# Of a CriticalMap, over the stiffness
CRITICAL_SPEEDS = (
    Column("stiffness", "N/m", "stiffness of every bearing"),
    *(Column(f"{direction}_{number + 1}", "Hz", f"critical speed of a {direction} whirl", _nth(direction, number))
      for direction in ("forward", "backward") for number in range(SHOWN)),
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class CriticalMap(Tabular):
    """stiffness: (k,) N/m of every bearing; forward, backward: (k, SHOWN) Hz, ascending, NaN where there are fewer;
    films: (speeds in Hz, stiffness in N/m of each bearing (n, b)) of the films of the case at rest, empty if they are
    not known, NaN for a bearing without direct stiffness: where a curve of a film crosses one of the map, the rotor has
    a critical speed."""

    case: Case
    stiffness: Array
    forward: Array
    backward: Array
    film_speeds_Hz: Array
    film_stiffness: Array

    def table(self) -> Table:
        """One row per stiffness."""
        return spread_table(CRITICAL_SPEEDS, self)


def critical_map(
    case: Case, stiffness: Sequence[float] | None = None, resting: Sequence[StabilityPoint] = ()
) -> CriticalMap:
    """Map the undamped critical speeds of a rotor over the stiffness of its bearings.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    stiffness : sequence of float, optional
        Stiffness in N/m of each bearing, above 0; by default over several decades.
    resting : sequence of StabilityPoint
        Points of `stability`, for the stiffness of the films.

    Returns
    -------
    CriticalMap
        Critical speeds in Hz at each stiffness.

    Raises
    ------
    InputError
        If a stiffness is not positive.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.critical_map(frbcli.load_case("turbocharger-car"), [1e6, 1e7])  # doctest: +SKIP
    """
    require(case)
    if case.elements:
        problem = "has coefficients of its own, and the map is of a rotor on springs of one stiffness."
        key, kind = first_without_film(case)
        remedy = "Leave --map out: the response has its own peaks."
        fault = Fault(key, kind, None, problem, remedy)
        raise InputError(case.name or "case", (fault,))
    on_ground = "the map is of a rotor on springs to the ground"
    if faults := support_faults(case, on_ground, "Leave --map out: the response has its own peaks."):
        raise InputError(case.name or "case", tuple(faults))
    given = _default(case) if stiffness is None else np.array(sorted(stiffness), dtype=np.float64)
    if not len(given) or not (np.isfinite(given).all() and given[0] > 0.0):
        fault = Fault("stiffness", "", None, "must be greater than 0.", 'Write e.g. "5e6 N/m".')
        raise InputError(case.name or "case", (fault,))
    plane = _plane(case)
    forward, backward = (np.array([_criticals(plane, k, sign) for k in given]) for sign in (-1.0, 1.0))
    known = [(point.speed_Hz, direct_springs(case, point.films)) for point in resting if point.rests and point.films]
    films = [(speed, springs) for speed, springs in known if not all(map(math.isnan, springs))]
    speeds, springs = np.array([speed for speed, _ in films]), np.array([each for _, each in films])
    return CriticalMap(case, given, forward, backward, speeds, springs.reshape(len(speeds), len(case.bearings)))


def _default(case: Case) -> Array:
    top = 2.0 * math.pi * max(abs(case.speed.start), abs(case.speed.end), 1.0)
    usual = (findings(case).mass or 1.0) * top**2 / 2.0
    return np.asarray(usual * np.logspace(*DECADES, STIFFNESSES), dtype=np.float64)


def _plane(case: Case) -> tuple[Array, Array, Array, Array]:
    """Mass, gyroscopic term, stiffness of the rotor without rings and damping, with all its modes, and the stiffness of
    springs of 1 N/m in all bearings, (n, n) of one plane."""
    shaft = shaft_of(case)
    films = [Link(shaft.journal(bearing.name), count=float(shaft.equal_bearings)) for bearing in case.bearings]
    rotor = assembled([shaft.undamped_body()], films)
    n = rotor.size // 2
    bearings = rotor.multiplicity[:, None, None] * np.swapaxes(rotor.journals, 1, 2)
    springs = (bearings @ rotor.journals).sum(axis=0)
    return rotor.mass[:n, :n], rotor.gyroscopic[:n, n:], rotor.stiffness[:n, :n], springs[:n, :n]


def _criticals(plane: tuple[Array, Array, Array, Array], stiffness: float, sign: float) -> Array:
    """(SHOWN,) Hz; sign: of g in the equation above."""
    from scipy.linalg import eigh

    mass, gyroscopic, own, springs = plane
    n = len(mass)
    largest = (max(n - SHOWN, 0), n - 1)  # of 1 / omega^2: the slowest
    k = own + stiffness * springs
    inverse = eigh(mass + sign * gyroscopic, k, eigvals_only=True, subset_by_index=largest)[::-1]
    speeds = 1.0 / (2.0 * math.pi * np.sqrt(inverse[inverse > 0.0]))
    return np.asarray(np.append(speeds, np.full(SHOWN, np.nan))[:SHOWN], dtype=np.float64)
