"""Natural frequencies and shapes of a turbocharger's rotor, free or on isotropic springs, over its speed.

The rotor is undamped and not reduced; bearings are springs, without any film.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import Table, named, table_of
from frbcli.errors import Fault, InputError
from frbcli.html import Tabular
from frbcli.linear.columns import NATURAL_MODES, SPEED
from frbcli.rotor.order import first_largest, ranks
from frbcli.rotor.reduction import RIGID, FreeModes, ReductionError, whirl_modes
from frbcli.scene.films import bearing_springs
from frbcli.scene.gate.gate import require
from frbcli.scene.machine.elements import element_springs, support_faults
from frbcli.scene.shafts.table import shaft_of

if TYPE_CHECKING:
    from frbcli.equilibrium.coefficients import RestingFilm

SPEEDS = 25  # of the default sweep
SHOWN = 4  # slowest modes of each direction
NO_STIFFNESS = 1e-9  # direct over largest stiffness of a film that is round-off
RIGID_SHARE = 0.5  # of the kinetic energy, from which on a motion is that of a rigid body


@dataclass(frozen=True)
class Mode:
    """direction: "forward" | "backward" whirl; kind: "conical" | "cylindrical" | "bending"; shape: (k,) deflection
    along the shaft, the largest 1."""

    frequency_Hz: float
    direction: str
    kind: str
    shape: Array


@dataclass(frozen=True)
class ModesAtSpeed:
    """The slowest modes of each direction at a rotor speed, ascending in frequency."""

    speed_Hz: float
    modes: tuple[Mode, ...]

    def directed(self, direction: str) -> tuple[Mode, ...]:
        """The "forward" or "backward" modes."""
        return tuple(mode for mode in self.modes if mode.direction == direction)


@dataclass(frozen=True, repr=False)
class Modes(Tabular):
    """Modes over speed.

    stiffness_N_m: of each bearing, those with a film first, at the highest speed; empty for the free rotor;
    positions_m: (k,) along the shaft; bearings, disks: names and positions in m; free_Hz: slowest bending frequencies
    of the free rotor at rest; kept: modes of each plane after the reduction of the case; error: what it leaves out at
    the highest speed, None for the free rotor.
    """

    case: Case
    stiffness_N_m: tuple[float, ...]
    positions_m: Array
    bearings: tuple[tuple[str, float], ...]
    disks: tuple[tuple[str, float], ...]
    mass_kg: float
    free_Hz: tuple[float, ...]
    kept: int
    points: tuple[ModesAtSpeed, ...]
    error: ReductionError | None

    def table(self) -> Table:
        """One row per mode."""
        columns = *named((SPEED,), "", itemgetter(0)), *named(NATURAL_MODES, "", itemgetter(1))
        return table_of(columns, ((point, mode) for point in self.points for mode in point.modes))


def natural_modes(
    case: Case, stiffness: float | Sequence[float] | None = None, speeds_Hz: Sequence[float] | None = None
) -> Modes:
    """Compute the undamped natural modes of the rotor of a turbocharger.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    stiffness : float or sequence of float, optional
        Stiffness in N/m of each bearing with a film, or of all alike, the same in all directions; elements without a
        film are springs of their own. None leaves the rotor free.
    speeds_Hz : sequence of float, optional
        Rotor speeds in Hz; by default from standstill to the highest speed of the case.

    Returns
    -------
    Modes
        Frequencies in Hz and shapes at each speed.

    Raises
    ------
    InputError
        If the case has another rotor or, with a stiffness, bearings on supports, if a speed is negative, if a stiffness
        is not greater than 0, or if there are not as many as bearings.

    Examples
    --------
    >>> import frbcli
    >>> modes = frbcli.natural_modes(frbcli.load_case("turbocharger-car"), 1e7)  # doctest: +SKIP
    """
    require(case)
    what = "these are the modes of a shaft on springs to the ground"
    remedy = "Leave the stiffness out, or take the damped modes, frb stability --shapes SPEED, which have supports."
    if stiffness is not None and (faults := support_faults(case, what, remedy)):
        raise InputError(case.name or "case", tuple(faults))
    free = shaft_of(case).free()
    speeds = np.linspace(0.0, max(case.speed.start, case.speed.end), SPEEDS) if speeds_Hz is None else speeds_Hz
    springs = _springs(case, stiffness)
    _check(case, springs, speeds)
    modes = free.modes
    held = np.zeros((0, len(modes.frequencies))) if stiffness is None else free.held

    def on(omega: float) -> Array:
        """(b,) N/m of all bearings."""
        return springs if stiffness is None else np.concatenate([springs, element_springs(case, omega)])

    omega = 2 * math.pi * np.asarray(speeds, dtype=np.float64)
    return Modes(
        case,
        tuple(on(float(np.max(omega)))[: len(free.journals)].tolist()),
        modes.positions,
        tuple((journal.name, journal.position) for journal in free.journals),
        tuple((wheel.name, wheel.position) for wheel in free.wheels),
        float(modes.weight[0] ** 2),
        tuple((modes.frequencies[RIGID : RIGID + SHOWN] / (2 * math.pi)).tolist()),
        free.kept,
        tuple(_at_speed(modes, held, on(float(value)), value) for value in omega),
        free.reduction_error(on(float(np.max(omega))), float(np.max(omega))) if len(held) else None,
    )


def film_springs(case: Case, films: Sequence[RestingFilm]) -> tuple[float, ...]:
    """Isotropic stiffness in N/m of each bearing of a case out of its films at rest: the mean of both directions, in
    series where a ring floats between two films. Cross stiffness is left out: it excites a whirl and carries no load.
    Empty where a bearing has none, see direct_springs, and without films."""
    found = direct_springs(case, films)
    return () if any(map(math.isnan, found)) else found


def direct_springs(case: Case, films: Sequence[RestingFilm]) -> tuple[float, ...]:
    """As film_springs; NaN for a bearing with a film without direct stiffness, such as a full film in its centre."""
    means = [0.5 * float(np.trace(film.stiffness)) for film in films]
    sizes = [float(np.abs(film.stiffness).max()) for film in films]
    some = [mean if mean > NO_STIFFNESS * size else math.nan for mean, size in zip(means, sizes, strict=True)]
    return bearing_springs(case, some)


def _springs(case: Case, stiffness: float | Sequence[float] | None) -> Array:
    """(b,) N/m, empty for a free rotor."""
    given = [] if stiffness is None else [stiffness] if isinstance(stiffness, int | float) else list(stiffness)
    if len(given) == 1:
        given *= len(case.bearings)
    if len(given) not in (0, len(case.bearings)):
        fault = Fault("stiffness", f"{len(given)} values", None, "are not as many as bearings.", "Give one for each.")
        raise InputError(case.name or "case", (fault,))
    return np.array(given, dtype=np.float64)


def _at_speed(modes: FreeModes, springs: Array, stiffness: Array, omega: float) -> ModesAtSpeed:
    found = whirl_modes(modes, springs, stiffness, omega)
    shown: list[Mode] = []
    for sign, direction in ((1, "forward"), (-1, "backward")):
        for index in np.flatnonzero(found.frequencies * sign > 0)[:SHOWN]:
            coordinates = found.coordinates[:, index]
            shape = modes.shapes @ coordinates
            frequency = abs(float(found.frequencies[index])) / (2 * math.pi)
            kind = _kind(coordinates, shape)
            shown.append(Mode(frequency, direction, kind, shape / shape[first_largest(shape)]))
    frequencies = ranks(np.array([mode.frequency_Hz for mode in shown]))  # forward before backward where both are equal
    return ModesAtSpeed(omega / (2 * math.pi), tuple(shown[i] for i in np.argsort(frequencies, kind="stable")))


def _kind(coordinates: Array, shape: Array) -> str:
    """The kind of a motion of unit length in the free modes with this shape; a conical one has a node on the shaft."""
    if coordinates[:RIGID] @ coordinates[:RIGID] < RIGID_SHARE:
        return "bending"
    return "conical" if shape.min() < 0 < shape.max() else "cylindrical"


def _check(case: Case, springs: Array, speeds: Sequence[float] | Array) -> None:
    faults = [
        Fault("stiffness", f"{spring:g} N/m", None, "must be greater than 0.", 'Write e.g. "5e6 N/m".')
        for spring in springs
        if not (math.isfinite(spring) and spring > 0)
    ]
    if not len(speeds):
        faults.append(Fault("speed", "", None, "is missing.", 'Write e.g. "350 Hz".'))
    faults += [
        Fault("speed", f"{speed:g} Hz", None, "must be at least 0.", 'Write e.g. "350 Hz".')
        for speed in speeds
        if not (math.isfinite(speed) and speed >= 0)
    ]
    if faults:
        raise InputError(case.name or "case", tuple(faults))
