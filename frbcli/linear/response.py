"""Linear response to the unbalance, or to another load: the motion of a rotor in its films about the resting position.

At each rotor speed Omega the films are the eight coefficients of stability.py, of films that keep oil those at the
frequency Omega, and the motion q = Re(Q exp(i alpha))
with the angle alpha of the rotor follows from

    (K + P^T K_f P + i Omega (D + Omega G + P^T D_f P) - Omega^2 M) Q = Omega^2 (u_sin + i u_cos),

what (2.3) is at a constant speed. Films of unlike stiffness in x and y, or cross-coupled, make ellipses of it.
Loads of the case that turn or swing once in a revolution join the unbalance. The motion by a single harmonic load has
the frequency of that load, and its phase counts from there.

The motion is in proportion to the unbalance, whatever the gap: where a journal moves over more than DOUBTFUL of the gap
that its resting position leaves, the coefficients are doubtful, and no journal moves beyond its clearance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from frbcli.arrays import Array, Complex, Truths
from frbcli.case.schema import Case
from frbcli.columns import Table, spread_table
from frbcli.equilibrium.coefficients import LEAST, coefficients_of
from frbcli.equilibrium.linearised import linearised
from frbcli.errors import Fault, input_error
from frbcli.film.parabola import summit
from frbcli.html import Tabular
from frbcli.linear.columns import RESPONSE_POINTS
from frbcli.linear.stability import stability_points
from frbcli.linear.stability_point import StabilityPoint
from frbcli.nearest import did_you_mean
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.loads import Harmonic
from frbcli.scene.gate.analysis import FILMS, RANGE
from frbcli.scene.gate.gate import require
from frbcli.scene.machine.elements import element_forces, harmonics_of
from frbcli.scene.machine.system import elastic_shell
from frbcli.scene.speeds import default_speeds

UNBALANCE = "unbalance"  # as excitation
SPEEDS = 120  # of the default sweep
ROUND_OFF = 1e-9  # relative: what stands out by less, as where a stiff rotor turns about its centre of mass, is no peak
# Larger semi-axis over the gap that is left at rest, above which linear coefficients are doubtful. Against the
# nonlinear synchronous response (cycles/unbalance) of jeffcott and rigid with short films and unbalances of 10 to 200 g
# mm, the amplitudes of journals have errors of at most 4 % up to a tenth of that gap, 15 % up to this share, 26 % up to
# half of it, and a factor of 2 beyond, where the response jumps. tests/linear/test_response.py holds it.
DOUBTFUL = 0.3
ORBIT_PLACES = 360  # at which the eccentricity along an orbit is evaluated
SOUND, DOUBTFUL_MOTION, BEYOND_GAP = "linear", "doubtful", "beyond-gap"


@dataclass(frozen=True, repr=False)
class Response(Tabular):
    """The motion at n speeds.

    speeds_Hz: (n,), ascending, those at which the rotor rests; points: the p points of a run; motion: (n, p, 2) complex
    amplitudes of x and y in m; films: the names of the f films; elements: those of the e elements; forces: (n, f + e,
    2) those of the forces of both on the shaft in N, of one bearing; growth: (n,) in 1/s of the least damped whirl:
    where it is positive, the motion is not seen; critical_speeds_Hz: where the largest motion of any point has a peak;
    resting: the resting positions; in_films: (n, f, 2) complex amplitudes of the journals in their films, over the
    clearance; clearances: (n, f) m, warm with heat; amplitude_error: (n, p) m, expected one of the amplitude by the
    mesh of the films, and critical_speed_errors_Hz: those of the critical speeds; NaN where they are not known.
    excitation: UNBALANCE, with all loads of order 1, or the name of the one load that excites.
    """

    case: Case
    speeds_Hz: Array
    points: tuple[str, ...]
    motion: Complex
    films: tuple[str, ...]
    elements: tuple[str, ...]
    forces: Complex
    growth: Array
    critical_speeds_Hz: tuple[float, ...]
    resting: tuple[StabilityPoint, ...]
    in_films: Complex
    clearances: Array
    amplitude_error: Array
    critical_speed_errors_Hz: tuple[float, ...]
    excitation: str = UNBALANCE

    @property
    def what(self) -> str:
        """What it is, in words."""
        return "unbalance response" if self.excitation == UNBALANCE else f"response to {self.excitation}"

    @property
    def angle(self) -> str:
        """What phases count from, in words."""
        return f"angle of {'the rotor' if self.excitation == UNBALANCE else self.excitation}"

    @property
    def bearings(self) -> tuple[str, ...]:
        """(f + e,) names of the films and of the elements."""
        return self.films + self.elements

    @property
    def gap_share(self) -> Array:
        """(n, f) larger semi-axis of the orbit of each journal in its film over the gap that its resting position
        leaves, 1 - eccentricity; of one that rests on an elastic shell, over the depth by which it presses it in."""
        left = np.where(self._pressed, self._eccentricity - self.case.contact.eccentricity, 1.0 - self._eccentricity)
        return np.asarray(larger_semi_axis(self.in_films) / left)

    @property
    def _eccentricity(self) -> Array:
        """(n, f) at rest."""
        found = np.array([[film.eccentricity for film in point.films] for point in self.resting])
        return found.reshape(self.clearances.shape)

    @property
    def _pressed(self) -> Truths:
        """(n, f) which journals rest on their elastic shells."""
        shell = elastic_shell(self.case)
        return np.zeros(self.clearances.shape, dtype=bool) if shell is None else self._eccentricity > shell.begins

    @property
    def eccentricity_max(self) -> Array:
        """(n, f) largest eccentricity of each journal on its orbit about its resting position; from 1 on, which no
        journal can have, the orbit leaves the gap."""
        turn = np.exp(2j * np.pi * np.arange(ORBIT_PLACES) / ORBIT_PLACES)
        rest = np.array([[film.displacement for film in point.films] for point in self.resting])
        rest = rest.reshape(*self.clearances.shape, 2)
        places = rest[..., None] + (self.in_films[..., None] * turn).real
        return np.asarray(np.hypot(places[:, :, 0], places[:, :, 1]).max(axis=-1))

    @property
    def validity(self) -> tuple[str, ...]:
        """At each speed "linear"; "doubtful" where a journal moves over more than DOUBTFUL of the gap left at rest; or
        "beyond-gap" where its orbit leaves the gap, or the elastic shell that it rests on."""
        ends = np.where(self._pressed, self.gap_share, self.eccentricity_max)
        pairs = zip(*(each.max(axis=1, initial=0.0) for each in (ends, self.gap_share)), strict=True)
        return tuple(
            BEYOND_GAP if eccentricity >= 1.0 else DOUBTFUL_MOTION if share > DOUBTFUL else SOUND
            for eccentricity, share in pairs
        )

    @property
    def forward(self) -> Complex:
        """(n, p) complex amplitudes in m of what turns with the rotor."""
        return np.asarray(0.5 * (self.motion[:, :, 0] + 1j * self.motion[:, :, 1]))

    @property
    def backward(self) -> Complex:
        """(n, p) complex amplitudes in m of what turns against it, as in order_track."""
        return np.asarray(np.conj(0.5 * (self.motion[:, :, 0] - 1j * self.motion[:, :, 1])))

    @property
    def amplitude(self) -> Array:
        """(n, p) larger semi-axis of the orbits in m."""
        return larger_semi_axis(self.motion)

    @property
    def phase_deg(self) -> Array:
        """(n, p) phase of the forward motion to the angle of the rotor, continuous over the speed."""
        return np.asarray(np.degrees(np.unwrap(np.angle(self.forward), axis=0)))

    def orbit(self, speed: int, point: int, count: int = 180) -> Array:
        """(count, 2) places in m along the orbit of a point, by their numbers."""
        turn = np.exp(2j * np.pi * np.arange(count) / count)
        return np.asarray((turn[:, None] * self.motion[speed, point]).real)

    def table(self) -> Table:
        """One row per speed and point."""
        return spread_table(RESPONSE_POINTS, self)


def response(
    case: Case,
    speeds_Hz: Sequence[float] | None = None,
    observe: Callable[[int, int], None] | None = None,
    excitation: str = UNBALANCE,
) -> Response:
    """Compute the linear response of a case to its unbalance, or to another of its loads.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    speeds_Hz : sequence of float, optional
        Rotor speeds in Hz, above 0; by default a range up to the highest of the case.
    observe : callable, optional
        Called with each speed's number and their number.
    excitation : str, optional
        Load that excites alone, such as "force 2" for the second force of the case; by default the unbalance with all
        loads of order 1.

    Returns
    -------
    Response
        Amplitudes in m and phases of all points, critical speeds in Hz.

    Raises
    ------
    InputError
        If the case cannot be modelled, has films that eight coefficients do not describe, or rests nowhere, or if there
        is no such load or a constant one.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.response(case, [50.0, 100.0])
    >>> len(found.points)
    2
    """
    require(case, RANGE if speeds_Hz is None else FILMS, _excitation_faults(case, excitation))
    asked = default_speeds(case, SPEEDS) if speeds_Hz is None else tuple(sorted(set(speeds_Hz)))
    system, points = stability_points(case, asked, observe, partial(_frequency, case, excitation))
    resting = [point for point in points if point.rests]
    if not resting:
        problem = f"has no resting position at any of {len(asked)} speeds; at the first: {points[0].problem}"
        raise input_error(case.name or "case", "speed", "", problem, "Choose other speeds.")
    rotors = [point.rotor for point in resting if point.rotor is not None]
    found = (_at(case, rotor, point, excitation) for rotor, point in zip(rotors, resting, strict=True))
    motions, forces, journals = zip(*found, strict=True)
    clearances = np.array([(point.warm.system if point.warm else system).clearances for point in resting])
    motion = np.array(motions)
    speeds = np.array([point.speed_Hz for point in resting])
    peaks, others = peak_speeds(speeds, motion), _on_others(rotors, resting, excitation)
    return Response(
        case=case,
        speeds_Hz=speeds,
        points=tuple(name for name, _ in system.rotor.points),
        motion=motion,
        films=system.names,
        elements=tuple(element.name for element in case.elements),
        forces=np.array(forces),
        growth=np.array([point.growth for point in resting]),
        critical_speeds_Hz=peaks,
        resting=tuple(resting),
        in_films=np.array(journals) / clearances[:, :, None],
        clearances=clearances,
        amplitude_error=_amplitude_error(motion, others),
        critical_speed_errors_Hz=_peak_errors(speeds, peaks, others),
        excitation=excitation,
    )


def _excitation_faults(case: Case, excitation: str) -> Iterator[Fault]:
    if excitation == UNBALANCE:
        return
    known = (UNBALANCE, *(load.name for load in harmonics_of(case)))
    if excitation not in known:
        problem = "is no load of the case that changes with angle or time."
        yield Fault("excitation", excitation, None, problem, did_you_mean(excitation, known))


def _frequency(case: Case, excitation: str, omega: float) -> float:
    """Frequency of the motion in rad/s of a rotor that turns with omega rad/s."""
    named = {load.name: load for load in harmonics_of(case)}
    return named[excitation].excitation(omega)[0] if excitation in named else omega


def excited(rotor: LinearRotor, omega: float, excitation: str = UNBALANCE) -> tuple[float, Complex]:
    """Frequency in rad/s, not below 0, and (n,) complex amplitudes in N of what excites a rotor that turns with omega
    rad/s, see Response."""
    harmonics = {load.name: load for load in rotor.loads if isinstance(load, Harmonic)}
    if excitation != UNBALANCE:
        return harmonics[excitation].excitation(omega)
    synchronous = (load.excitation(omega)[1] for load in harmonics.values() if load.synchronous)
    return omega, sum(synchronous, omega**2 * rotor.unbalance)


def forced_motion(
    rotor: LinearRotor, omega: float, load: tuple[float, Complex], stiffness: Array, damping: Array
) -> Complex:
    """(n,) complex amplitudes of all degrees of freedom at omega rad/s, under a load of a frequency and amplitudes, on
    bearings of stiffness and damping (films, 2, 2) in N/m and N s/m."""
    (frequency, force), (mass, d, k) = load, linearised(rotor, omega, stiffness, damping)
    return np.asarray(np.linalg.solve(k + 1j * frequency * d - frequency**2 * mass, force))


def larger_semi_axis(motion: Complex) -> Array:
    """(...) of the ellipse that x and y with the complex amplitudes (..., 2) draw: its forward and its backward part
    added up."""
    x, y = motion[..., 0], motion[..., 1]
    return np.asarray(0.5 * (np.abs(x + 1j * y) + np.abs(x - 1j * y)))


def _at(
    case: Case, rotor: LinearRotor, point: StabilityPoint, excitation: str
) -> tuple[Complex, Complex, Complex]:
    """Motion (p, 2) of the points, forces (films + elements, 2), and motion (films, 2) of the journals in their films
    at one speed."""
    omega = 2.0 * math.pi * point.speed_Hz
    stiffness, damping = coefficients_of(point.films)
    frequency, load = excited(rotor, omega, excitation)
    q = forced_motion(rotor, omega, (frequency, load), stiffness, damping)
    journals = rotor.journals @ q
    forces = -np.einsum("fij,fj->fi", stiffness + 1j * frequency * damping, journals)[:, :2]
    forces = np.concatenate([forces, element_forces(case, rotor, omega, frequency, q)])
    return np.array([place @ q for _, place in rotor.points]), forces, journals[:, :2]


def _on_others(
    rotors: Sequence[LinearRotor], points: Sequence[StabilityPoint], excitation: str
) -> list[tuple[Complex, float]]:
    """The motion (n, p, 2) of the points of a rotor, as it is at each speed, on each other mesh of its films, with the
    share of the difference that is the error; none where a mesh is missing at a speed."""
    if len({len(point.others) for point in points}) > 1:
        return []
    found = []
    for number in range(len(points[0].others)):
        motion = []
        for rotor, point in zip(rotors, points, strict=True):
            omega = 2.0 * math.pi * point.speed_Hz
            q = forced_motion(rotor, omega, excited(rotor, omega, excitation), *point.others[number][:2])
            motion.append([place @ q for _, place in rotor.points])
        found.append((np.array(motion), points[0].others[number][2]))
    return found


def _amplitude_error(motion: Complex, others: Sequence[tuple[Complex, float]]) -> Array:
    """(n, p) in m: the largest difference of the amplitudes on other meshes times their shares, at least LEAST."""
    own = larger_semi_axis(motion)
    if not others:
        return np.full(own.shape, math.nan)
    apart = [share * np.abs(larger_semi_axis(other) - own) for other, share in others]
    return np.asarray(np.maximum(LEAST * own, np.max(apart, axis=0)))


def _peak_errors(
    speeds: Array, peaks: Sequence[float], others: Sequence[tuple[Complex, float]]
) -> tuple[float, ...]:
    """Errors of the peaks in Hz: the distance of each peak to the nearest one on the other meshes, times their shares;
    NaN where another mesh has no peak within two steps of the speed."""
    elsewhere = [(np.array(peak_speeds(speeds, motion)), share) for motion, share in others]
    near = 2.0 * float(np.max(np.diff(speeds), initial=0.0))
    errors = []
    for peak in peaks:
        apart = [(float(np.min(np.abs(found - peak), initial=np.inf)), share) for found, share in elsewhere]
        known = bool(apart) and max(distance for distance, _ in apart) <= near
        errors.append(max(LEAST * peak, *(share * distance for distance, share in apart)) if known else math.nan)
    return tuple(errors)


def peak_speeds(speeds: Array, motion: Complex) -> tuple[float, ...]:
    """Speeds at which the larger semi-axis of a point has a peak, each by a parabola through three speeds; peaks of
    several points within a step of the speed are one."""
    found: list[float] = []
    for own in larger_semi_axis(motion).T:
        for i in range(1, len(speeds) - 1):
            low, here, high = own[i - 1 : i + 2].tolist()
            if here > low and here >= high and here - min(low, high) > ROUND_OFF * here:
                before, behind = np.diff(speeds[i - 1 : i + 2]).tolist()
                found.append(float(speeds[i]) + summit(low, here, high, before, behind)[0])
    step = float(np.max(np.diff(speeds), initial=0.0))
    kept: list[float] = []
    for peak in sorted(found):
        if not kept or peak - kept[-1] > step:
            kept.append(peak)
    return tuple(kept)
