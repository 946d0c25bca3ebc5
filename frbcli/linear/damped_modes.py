"""Damped modes of a rotor in its films at one speed: frequency, growth, sense of whirl, and shape.

Limits of shaft vibration, peak to peak, and margins of critical speeds, at the speeds of operation.

With the rotor speed n in revolutions per minute, in micrometres peak to peak:

    API 617           min(25.4, 25.4 sqrt(12000 / n))
    ISO 20816-3       zones A/B 4800 / sqrt(n), B/C 9000 / sqrt(n), C/D 13200 / sqrt(n)

A critical speed with an amplification factor AF from 2.5 on keeps off the range of operation (API 617) by

    min(16, 17 (1 - 1 / (AF - 1.5))) percent below it,    10 percent more above it,

of the nearer limit of the range. Editions differ: the one in the contract decides.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from frbcli.arrays import Array, Complex, larger_semi_axis
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, spaced, speed_shown, table_of
from frbcli.equilibrium.hopf import oscillating
from frbcli.equilibrium.linearised import coefficients_of, eigenpairs
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines
from frbcli.errors import NotConverged, input_error
from frbcli.linear.columns import DAMPED_MODES
from frbcli.linear.critical_speeds import CriticalSpeed, whirl_direction
from frbcli.linear.response import Response
from frbcli.linear.stability import check_machine
from frbcli.linear.stability_point import machine_rotor, point_at_rest, with_errors
from frbcli.rotor.assembly import LinearRotor
from frbcli.rotor.loads import first_largest, ranks
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.supply import advised
from frbcli.units import PER_MINUTE

UNMOVED = 1e-12  # of a ring that turns on its pin, in m over rad, below which nothing else moves


@dataclass(frozen=True)
class DampedMode:
    """One oscillating mode.

    eigenvalue: 1/s, imaginary part positive; direction: "forward" | "backward", or "mixed" where some points whirl
    forward and others backward, or all move to and fro in a line; motion: (p, 2) complex amplitudes of x and y of the
    points of a run, the largest semi-axis of all being 1; shape: (s, 2) the same along the shaft, its largest
    displacement being real; error: 1/s, expected distance of the eigenvalue from the true one.
    """

    eigenvalue: complex
    direction: str
    motion: Complex
    shape: Complex
    error: float = math.nan

    @property
    def frequency_Hz(self) -> float:
        """Damped frequency."""
        return self.eigenvalue.imag / (2.0 * math.pi)

    @property
    def damping_ratio(self) -> float:
        """-Re / |.|, negative where the mode grows."""
        return 0.0 - self.eigenvalue.real / abs(self.eigenvalue)

    @property
    def logarithmic_decrement(self) -> float:
        """Logarithm of the ratio of two amplitudes a period apart."""
        return 0.0 - 2.0 * math.pi * self.eigenvalue.real / self.eigenvalue.imag


@dataclass(frozen=True, repr=False)
class DampedModes(Tabular):
    """The oscillating modes at a rotor speed, those that grow first, then the least damped ones.

    points: the names of the p points; positions: (s,) along the shaft in m, or over its length where a case has no
    length (`to_scale` is False); marks: names and positions of bearings and disks; coefficient_error: expected one of
    the films' stiffness and damping, over the largest entry.
    """

    case: Case
    speed_Hz: float
    points: tuple[str, ...]
    positions: Array
    to_scale: bool
    marks: tuple[tuple[str, float], ...]
    modes: tuple[DampedMode, ...]
    coefficient_error: float = math.nan

    def table(self) -> Table:
        """One row per mode."""
        return table_of(DAMPED_MODES, self.modes)


def damped_modes(case: Case, speed_Hz: float) -> DampedModes:
    """Compute the damped modes of a case about its static equilibrium at a rotor speed.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    speed_Hz : float
        Rotor speed in Hz, above 0.

    Returns
    -------
    DampedModes
        Eigenvalues in 1/s and shapes.

    Raises
    ------
    InputError
        As `stability` does.
    NotConverged
        Where there is no static equilibrium.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.damped_modes(case, 100.0)  # doctest: +SKIP
    """
    check_machine(case, [speed_Hz])
    try:
        with advised(case):
            machine = StaticMachines(case, memory=True).at(2.0 * math.pi * speed_Hz)
    except NotConverged as none:
        raise input_error(case.name or "case", "speed", f"{speed_Hz:g} Hz", str(none), "") from none
    rotor = machine_rotor(machine)
    stations = shaft_of(case).stations(rotor)
    point = with_errors(point_at_rest(machine, speed_Hz), machine)
    shapes = []
    for value, vector in _eigenvectors(rotor, machine):
        motion: Complex = np.array([place @ vector for _, place in rotor.points], dtype=np.complex128)
        shape = np.einsum("sij,j->si", stations.maps, vector)
        size = float(np.max(larger_semi_axis(np.concatenate([motion, shape]))))
        if size > UNMOVED * float(np.abs(vector).max()):
            there = shape.ravel()[first_largest(shape.ravel())]
            unit = size * there / abs(there)  # its displacement is real: eigenvectors have any phase
            own = motion / unit
            shapes.append(DampedMode(value, whirl_direction(own), own, shape / unit, point.error_of(value)))
    keys = [ranks(np.array(each)) for each in zip(*((m.frequency_Hz, m.damping_ratio) for m in shapes), strict=True)]
    shapes = [shapes[i] for i in np.lexsort(keys)] if shapes else []
    names = tuple(name for name, _ in rotor.points)
    error = max((film.error for film in point.films), default=math.nan)
    return DampedModes(
        case, speed_Hz, names, stations.positions, stations.to_scale, stations.marks, tuple(shapes), error
    )


def _eigenvectors(rotor: LinearRotor, machine: MachineAtRest) -> list[tuple[complex, Complex]]:
    """Eigenvalues with positive imaginary part in 1/s, and displacements (n,), as eigenvalues of stability.py."""
    if machine.dynamic:
        return [(value, vector) for value, vector in machine.modes if oscillating(np.array([value]))[0]]
    values, motions = eigenpairs(rotor, machine.omega, *coefficients_of(machine.films))
    return [(complex(values[i]), motions[:, i]) for i in np.flatnonzero(oscillating(values))]


MICRO = 1e-6
API, ISO = "API 617", "ISO 20816-3"
API_FORMULA = "min(25.4, 25.4 sqrt(12000 / n)) um"
BOUNDARIES = {"A/B": 4800.0, "B/C": 9000.0, "C/D": 13200.0}  # um over the root of the speed in rpm
ISO_FORMULA = "4800 / sqrt(n), 9000 / sqrt(n), 13200 / sqrt(n) um"
ZONES = "ABCD"
ISO_RANGE_rpm = (1000.0, 30000.0)  # of machines that the standard is for
OF_SHAFT = ("journal", "disk")  # kinds of points
WELL_DAMPED = 2.5  # amplification factor below which no margin is asked for
ENOUGH, ABOVE = 0.16, 0.10  # the largest margin below a range of operation; by how much it is more above one
MARGIN_FORMULA = "min(16, 17 (1 - 1 / (AF - 1.5))) %, above the range of operation 10 % more, 0 for AF below 2.5"
MARKS = {"linear": "", "doubtful": "?", "beyond-gap": "!"}  # validity of an amplitude


def api_limit(speed_Hz: Array | float) -> Array:
    """Peak to peak in m."""
    return np.asarray(25.4 * MICRO * np.minimum(1.0, np.sqrt(12000.0 / (PER_MINUTE * np.asarray(speed_Hz)))))


def zone_limits(speed_Hz: Array | float) -> Array:
    """(3, ...) boundaries of the zones of ISO 20816-3, peak to peak in m."""
    root = np.sqrt(PER_MINUTE * np.asarray(speed_Hz))
    return np.array([MICRO * boundary / root for boundary in BOUNDARIES.values()])


def required_margin(speed_Hz: float, factor: float | None, operating_Hz: tuple[float, float]) -> float | None:
    """Share of the nearer limit of the range of operation by which a critical speed has to keep off it; within the
    range as for a speed below it. None where its amplification factor is not known."""
    if factor is None:
        return None
    if factor < WELL_DAMPED:
        return 0.0
    asked = min(ENOUGH, 0.17 * (1.0 - 1.0 / (factor - 1.5)))
    return asked + ABOVE if speed_Hz > operating_Hz[1] else asked


@dataclass(frozen=True)
class PointVibration:
    """The vibration of a point of the shaft at the speed of operation where it is largest over its limit.

    peak_to_peak: twice the larger semi-axis of the orbit, m; limits: in m, ascending; validity: of the amplitude.
    """

    standard: str
    node: str
    speed_Hz: float
    peak_to_peak: float
    limits: tuple[float, ...]
    validity: str

    @property
    def ratio(self) -> float:
        """Over the lowest limit."""
        return self.peak_to_peak / self.limits[0]

    @property
    def within(self) -> bool:
        """Whether it is at most the lowest limit."""
        return self.ratio <= 1.0

    @property
    def zone(self) -> str:
        """The zone between limits that it lies in, A below the lowest."""
        return ZONES[sum(self.peak_to_peak > limit for limit in self.limits)]


@dataclass(frozen=True)
class SpeedMargin:
    """A critical speed and its distance to the range of operation. required: see required_margin."""

    peak: CriticalSpeed
    required: float | None

    @property
    def within(self) -> bool | None:
        """Whether it keeps off as far as required, None where that is not known."""
        margin = self.peak.separation_margin
        return None if self.required is None or margin is None else margin >= self.required


def _verdict(within: bool | None) -> str:
    return "-" if within is None else "within" if within else "too near"


_POINT = (
    Column("node", "", "point of the shaft", shown=(Shown("point", spaced),)),
    Column("speed", "Hz", "speed of the largest ratio to its limit", attrgetter("speed_Hz"),
           shown=(speed_shown(),)),
    Column("peak_to_peak", "m", "vibration, peak to peak",
           shown=(Shown("um p-p", ".3g", "um"),)),
)  # fmt: skip
_MARK = Column("validity", "", "`linear`, `doubtful` or `beyond-gap`", shown=(Shown("", MARKS.__getitem__),))


def _boundary(place: int, name: str) -> Column:
    return Column(f"zone_{name[0]}_{name[-1]}".lower(), "m", f"boundary {name} of ISO 20816-3",
                  lambda point: point.limits[place], shown=(Shown(f"{name} um", ".3g", "um"),))  # fmt: skip


# Of a PointVibration
API_POINTS = (
    *_POINT,
    Column("limit", "m", "limit of API 617", lambda point: point.limits[0], shown=(Shown("limit um", ".3g", "um"),)),
    Column("ratio", "", "vibration over its limit", shown=(Shown("ratio", ".3g"),)),
    Column("within", "", "whether it is at most 1", shown=(Shown("", lambda it: "within" if it else "too large"),)),
    _MARK,
)  # fmt: skip
ISO_POINTS = (
    *_POINT,
    *(_boundary(place, name) for place, name in enumerate(BOUNDARIES)),
    Column("zone", "", "`A`, `B`, `C` or `D`", shown=(Shown("zone"),)),
    _MARK,
)  # fmt: skip
# Of a SpeedMargin
MARGINS = (
    Column("speed", "Hz", "critical speed", attrgetter("peak.speed_Hz"), shown=(speed_shown(".6g"),)),
    Column("amplification_factor", "", "its amplification factor", attrgetter("peak.amplification_factor"),
           shown=(Shown("factor", ".3g"),)),
    Column("separation_margin", "", "distance from the operating range, over its nearer limit",
           attrgetter("peak.separation_margin"), shown=(Shown("margin", ".1%"),)),
    Column("required_margin", "", "what API 617 asks for", attrgetter("required"),
           more="none without the factor", shown=(Shown("required", ".1%"),)),
    Column("within", "", "whether the margin is at least that", shown=(Shown("", _verdict),)),
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class VibrationLimits(Tabular):
    """The vibration of a response and its limits.

    operating_Hz: lowest and highest speed of operation; covered_Hz: the part of it that the response covers, None
    without any; api, iso: by points of the shaft; margins: of the critical speeds; whirling_Hz: speeds of operation at
    which a whirl grows, so that the vibration is more than the response to unbalance. """

    case: Case
    operating_Hz: tuple[float, float]
    covered_Hz: tuple[float, float] | None
    api: tuple[PointVibration, ...]
    iso: tuple[PointVibration, ...]
    margins: tuple[SpeedMargin, ...]
    whirling_Hz: tuple[float, ...] = ()

    @property
    def covered(self) -> bool:
        """Whether the response has the whole range of operation."""
        return self.covered_Hz is not None and bool(np.allclose(self.covered_Hz, self.operating_Hz, rtol=1e-9))

    def table(self) -> Table:
        """A row for each point: vibration and limit of API 617, zone of ISO 20816-3 at the speed of its own."""
        zones = dict(zip(self.api, self.iso, strict=True))
        return table_of((*API_POINTS, Column("zone", "", "zone of ISO 20816-3", lambda it: zones[it].zone)), self.api)


def vibration_limits(response: Response, operating_Hz: tuple[float, float]) -> VibrationLimits:
    """Compare a response with the limits of API 617 and ISO 20816-3.

    Parameters
    ----------
    response : Response
        Response over the same range of operation, including its ends.
    operating_Hz : tuple of float
        Lowest and highest speed of operation in Hz.

    Returns
    -------
    VibrationLimits
        Each point of the shaft where it comes nearest to its limit, and the margins of the critical speeds.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> response = frbcli.response(case, [60.0, 80.0], operating_Hz=(50.0, 100.0))
    >>> [point.zone for point in frbcli.vibration_limits(response, (50.0, 100.0)).iso]
    ['A', 'A']
    """
    low, high = operating_Hz
    inside = (response.speeds_Hz >= low * (1.0 - 1e-9)) & (response.speeds_Hz <= high * (1.0 + 1e-9))
    speeds = response.speeds_Hz[inside]
    points = [number for number, name in enumerate(response.points) if name.partition("_")[0] in OF_SHAFT]
    places = list(itertools.compress(range(len(inside)), inside))

    def worst(standard: str, limits: Array) -> Iterable[PointVibration]:
        """limits: (bounds, speeds)."""
        for point in points if len(speeds) else ():
            size = 2.0 * response.amplitude[inside, point]
            at = int(np.argmax(size / limits[0]))
            bounds: Sequence[float] = limits[:, at].tolist()
            yield PointVibration(standard, response.points[point], float(speeds[at]), float(size[at]), tuple(bounds),
                                 response.validity[places[at]])  # fmt: skip

    covered = (float(speeds[0]), float(speeds[-1])) if len(speeds) else None
    margins = (SpeedMargin(peak, required_margin(peak.speed_Hz, peak.amplification_factor, operating_Hz))
               for peak in response.critical_speeds)  # fmt: skip
    api, iso = worst(API, api_limit(speeds)[None]), worst(ISO, zone_limits(speeds))
    whirling = tuple(speeds[response.growth[inside] > 0.0].tolist())
    return VibrationLimits(response.case, (low, high), covered, tuple(api), tuple(iso), tuple(margins), whirling)


def beyond_iso(operating_Hz: tuple[float, float]) -> bool:
    """Whether speeds of operation are none that ISO 20816-3 is for."""
    low, high = (PER_MINUTE * speed for speed in operating_Hz)
    return low < ISO_RANGE_rpm[0] or high > ISO_RANGE_rpm[1] or not math.isfinite(high)
