"""Linear response to the unbalance, or to another load: the motion of a rotor in its films about the static
equilibrium.

At each rotor speed Omega the films are the eight coefficients of stability.py, of films that keep oil those at the
frequency Omega, and the motion q = Re(Q exp(i alpha))
with the angle alpha of the rotor follows from

    (K + P^T K_f P + i Omega (D + Omega G + P^T D_f P) - Omega^2 M) Q = Omega^2 (u_sin + i u_cos),

what (2.3) is at a constant speed. Films of unlike stiffness in x and y, or cross-coupled, make ellipses of it.
Loads of the case that turn or swing once in a revolution join the unbalance, and so does a bow. The motion by a single
harmonic load has the frequency of that load, and its phase counts from there.

The motion is in proportion to the unbalance, whatever the gap: where a journal moves over more than DOUBTFUL of the gap
that its static equilibrium leaves, the coefficients are doubtful, and no journal moves beyond its clearance. """

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from operator import attrgetter

import numpy as np

from frbcli.arrays import Array, Complex, Truths, larger_semi_axis
from frbcli.case.schema import Case
from frbcli.columns import Table, Tabular, spread_table
from frbcli.equilibrium.linearised import LEAST, coefficients_of, linearised
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.errors import Fault, did_you_mean, input_error
from frbcli.linear.columns import RESPONSE_POINTS
from frbcli.linear.critical_speeds import (
    CLOSE,
    WIDTHS,
    CriticalSpeed,
    ResponsePeak,
    SpeedModel,
    amplification_factor,
    moved,
    peaks,
    separation_margin,
)
from frbcli.linear.stability import check_machine, stability_points
from frbcli.linear.stability_point import StabilityPoint
from frbcli.rotor.assembly import LinearRotor
from frbcli.rotor.loads import BOW, Harmonic
from frbcli.scene.changes import after_losses, has_lost, loss_times
from frbcli.scene.course import default_speeds
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import FILMS, RANGE
from frbcli.scene.machine.rotor import element_forces, harmonics_of
from frbcli.scene.machine.system import System, elastic_shell
from frbcli.scene.machine.turbocharger import shaft_of

UNBALANCE = "unbalance"  # as excitation
SPEEDS = 120  # of the default sweep
ROUNDS = 4  # in which machines whose coefficients change with the speed are solved at their peaks
SHARP = 1e-6  # relative error of the speed of a peak of given coefficients
TURN = 2.0 * math.pi
# Larger semi-axis over the gap that is left at rest, above which linear coefficients are doubtful. Against the
# nonlinear synchronous response (cycles/unbalance) of jeffcott and rigid with short films and unbalances of 10 to 200 g
# mm, the amplitudes of journals have errors of at most 4 % up to a tenth of that gap, 15 % up to this share, 26 % up to
# half of it, and a factor of 2 beyond, where the response jumps. tests/linear/rotors/test_response.py holds it.
DOUBTFUL = 0.3
ORBIT_PLACES = 360  # at which the eccentricity along an orbit is evaluated
SOUND, DOUBTFUL_MOTION, BEYOND_GAP = "linear", "doubtful", "beyond-gap"


@dataclass(frozen=True, repr=False)
class Response(Tabular):
    """The motion at n speeds.

    speeds_Hz: (n,), ascending, with a static equilibrium; points: the p points of a run; motion: (n, p, 2) complex
    amplitudes of x and y in m; films: the names of the f films; elements: the names of the e elements; forces: (n, f +
    e, 2) complex amplitudes of the forces of both on the shaft in N, of one bearing; growth: (n,) in 1/s of the least
    damped whirl: where it is positive, the motion is not seen; critical_speeds: the peaks; resting: the static
    equilibria; in_films: (n, f, 2) complex amplitudes of the journals in their films, over the clearance; clearances:
    (n, f) m, warm with heat; amplitude_error: (n, p) m, expected one of the amplitude by the mesh of the films, NaN
    where it is not known. excitation: UNBALANCE, with all loads of order 1, or the name of the one load that excites.
    """

    case: Case
    speeds_Hz: Array
    points: tuple[str, ...]
    motion: Complex
    films: tuple[str, ...]
    elements: tuple[str, ...]
    forces: Complex
    growth: Array
    critical_speeds: tuple[CriticalSpeed, ...]
    resting: tuple[StabilityPoint, ...]
    in_films: Complex
    clearances: Array
    amplitude_error: Array
    excitation: str = UNBALANCE

    @property
    def critical_speeds_Hz(self) -> tuple[float, ...]:
        """Speeds of the peaks, ascending."""
        return tuple(peak.speed_Hz for peak in self.critical_speeds)

    @property
    def what(self) -> str:
        """What it is, in words."""
        if self.excitation != UNBALANCE:
            return f"response to {self.excitation}"
        return "unbalance response after the loss" if has_lost(self.case) else "unbalance response"

    @property
    def angle(self) -> str:
        """What phases count from, in words."""
        return f"angle of {'the rotor' if self.excitation in (UNBALANCE, BOW) else self.excitation}"

    @property
    def bearings(self) -> tuple[str, ...]:
        """(f + e,) names of the films and of the elements."""
        return self.films + self.elements

    @property
    def gap_share(self) -> Array:
        """(n, f) larger semi-axis of the orbit of each journal in its film over the gap that its static equilibrium
        leaves, 1 - eccentricity; of one that rests on an elastic shell, over the depth by which it presses it in."""
        left = np.where(self._pressed, self._eccentricity - self.case.contact.eccentricity, 1.0 - self._eccentricity)
        return np.asarray(larger_semi_axis(self.in_films) / left)

    @property
    def _eccentricity(self) -> Array:
        """(n, f) at rest."""
        ratios = np.array([[film.eccentricity for film in point.films] for point in self.resting])
        return ratios.reshape(self.clearances.shape)

    @property
    def _pressed(self) -> Truths:
        """(n, f) which journals rest on their elastic shells."""
        shell = elastic_shell(self.case)
        return np.zeros(self.clearances.shape, dtype=bool) if shell is None else self._eccentricity > shell.begins

    @property
    def eccentricity_max(self) -> Array:
        """(n, f) largest eccentricity of each journal on its orbit about its static equilibrium; from 1 on, which no
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
    operating_Hz: tuple[float, float] | None = None,
    after_loss: bool = False,
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
        Load that excites alone, such as "force 2" for the second force of the case, or "bow"; by default the
        unbalance with all loads of order 1.
    operating_Hz : tuple of float, optional
        Lowest and highest speed of operation in Hz, from which critical speeds have a separation margin. Both are
        among the default speeds where these reach so far.
    after_loss : bool
        Take the unbalance after all losses of the case, instead of that before.

    Returns
    -------
    Response
        Amplitudes in m and phases of all points, critical speeds.

    Raises
    ------
    InputError
        If the case cannot be modelled, has films that eight coefficients do not describe, or rests nowhere, if there
        is no such load or a constant one, or if the range of operation is none.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.response(case, [50.0, 100.0])
    >>> len(found.points)
    2
    """
    faults = [*_excitation_faults(case, excitation), *_operating_faults(operating_Hz)]
    if after_loss:
        faults += _loss_faults(case)
        case = after_losses(case)
    require(case, RANGE if speeds_Hz is None else FILMS, faults)
    asked = _default_speeds(case, operating_Hz) if speeds_Hz is None else tuple(sorted(set(speeds_Hz)))
    check_machine(case, asked)
    machines, frequency = StaticMachines(case, memory=True), partial(_frequency, case, excitation)
    system, points = stability_points(case, asked, observe, frequency, machines)
    resting = [point for point in points if point.rests]
    if not resting:
        problem = f"has no static equilibrium at any of {len(asked)} speeds; at the first: {points[0].problem}"
        raise input_error(case.name or "case", "speed", "", problem, "Choose other speeds.")

    def solved(speeds: Sequence[float]) -> list[StabilityPoint]:
        return [each for each in stability_points(case, speeds, None, frequency, machines)[1] if each.rests]

    critical, known, maxima = critical_speeds_of(resting, excitation, operating_Hz, solved)
    if speeds_Hz is None:
        resting = known if known[0].films else _with_curves(known, maxima, solved)
    return _response(case, system, resting, critical, excitation)


def _default_speeds(case: Case, operating_Hz: tuple[float, float] | None) -> tuple[float, ...]:
    """Speeds over the range of the case, including the ends of the range of operation that lie in it."""
    swept = default_speeds(case, SPEEDS)
    if not swept or operating_Hz is None:
        return swept
    return tuple(sorted({*swept, *(end for end in operating_Hz if swept[0] < end < swept[-1])}))


def _response(
    case: Case,
    system: System,
    resting: Sequence[StabilityPoint],
    critical: tuple[CriticalSpeed, ...],
    excitation: str,
) -> Response:
    """The motion at the points of a machine that rest."""
    rotors = [point.rotor for point in resting if point.rotor is not None]
    solved = (_at(case, rotor, point, excitation) for rotor, point in zip(rotors, resting, strict=True))
    motions, forces, journals = zip(*solved, strict=True)
    clearances = np.array([(point.warm.system if point.warm else system).clearances for point in resting])
    motion = np.array(motions)
    return Response(
        case=case,
        speeds_Hz=np.array([point.speed_Hz for point in resting]),
        points=tuple(name for name, _ in system.rotor.points),
        motion=motion,
        films=system.names,
        elements=tuple(element.name for element in case.elements),
        forces=np.array(forces),
        growth=np.array([point.growth for point in resting]),
        critical_speeds=critical,
        resting=tuple(resting),
        in_films=np.array(journals) / clearances[:, :, None],
        clearances=clearances,
        amplitude_error=_amplitude_error(motion, rotors, resting, excitation),
        excitation=excitation,
    )


def _operating_faults(operating_Hz: tuple[float, float] | None) -> Iterator[Fault]:
    if operating_Hz is not None and not 0.0 < operating_Hz[0] <= operating_Hz[1] < math.inf:
        named = "{:g}..{:g} Hz".format(*operating_Hz)
        problem = "is no range of speeds above 0 from the lowest to the highest."
        yield Fault("operating", named, None, problem, 'Write e.g. "8000..12000 rpm".')


def _excitation_faults(case: Case, excitation: str) -> Iterator[Fault]:
    if excitation == UNBALANCE:
        return
    known = (UNBALANCE, *([BOW] if shaft_of(case).bow else []), *(load.name for load in harmonics_of(case)))
    if excitation not in known:
        problem = "is no load of the case that changes with angle or time."
        yield Fault("excitation", excitation, None, problem, did_you_mean(excitation, known))


def _loss_faults(case: Case) -> Iterator[Fault]:
    if not loss_times(case):
        remedy = 'Write e.g. loss = { time = "0.5 s", unbalance = "10 g*mm" } in [[disk]] or [rotor].'
        yield Fault("loss", "", None, "is missing: no unbalance is lost during a run.", remedy)


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


def critical_speeds_of(
    points: Sequence[StabilityPoint],
    excitation: str,
    operating_Hz: tuple[float, float] | None,
    solved: Callable[[Sequence[float]], list[StabilityPoint]],
) -> tuple[tuple[CriticalSpeed, ...], list[StabilityPoint], list[ResponsePeak]]:
    """The critical speeds between points at ascending speeds, the points including additional solved ones, and the
    peaks of the response.

    solved: the points that rest at speeds in Hz. Where coefficients change with the speed, they are solved at the peaks
    until these stay where they are."""
    known, rounds = list(points), ROUNDS if _changes(points[0]) else 0
    model = _model(known, excitation)
    maxima = peaks(model)
    for _ in range(rounds):
        far = [peak.omega for peak in maxima if np.min(np.abs(model.omegas - peak.omega)) > CLOSE * peak.omega]
        more = solved([omega / TURN for omega in far]) if far else []
        if not more:
            break
        known = sorted([*known, *more], key=attrgetter("speed_Hz"))
        model = _model(known, excitation)
        maxima = peaks(model)
    others = [(_model(known, excitation, number), share) for number, share in _shares(known)]
    critical = tuple(_critical(model, others, peak, known[0], operating_Hz) for peak in maxima)
    return critical, known, maxima


def _with_curves(
    points: Sequence[StabilityPoint],
    maxima: Sequence[ResponsePeak],
    solved: Callable[[Sequence[float]], list[StabilityPoint]],
) -> list[StabilityPoint]:
    """The points of a machine without films, with a curve around each bounded peak."""
    bounded = [peak for peak in maxima if math.isfinite(peak.amplitude)]
    curve = np.unique([peak.omega + abs(peak.pole.imag) * WIDTHS for peak in bounded]) / TURN
    inside = curve[(curve > points[0].speed_Hz) & (curve < points[-1].speed_Hz)]
    return sorted([*points, *(solved(inside.tolist()) if len(inside) else [])], key=attrgetter("speed_Hz"))


def _changes(point: StabilityPoint) -> bool:
    """Whether a machine has other coefficients at each speed, of films or of forces at ports such as ball bearings."""
    return bool(point.films) or (point.rotor is not None and bool(point.rotor.slopes))


def _model(points: Sequence[StabilityPoint], excitation: str, other: int | None = None) -> SpeedModel:
    """The response between points, on their own films or on another mesh, by its number."""
    rotors = [point.rotor for point in points if point.rotor is not None]
    base, changes = rotors[0], []
    for point, rotor in zip(points, rotors, strict=True) if _changes(points[0]) else ():
        omega = TURN * point.speed_Hz
        coefficients = coefficients_of(point.films) if other is None else point.others[other][:2]
        _, damping, stiffness = linearised(rotor, omega, *coefficients)
        here = base.at(omega)
        changes.append(np.array([stiffness - here.stiffness, damping - here.damping - omega * here.gyroscopic]))
    omegas = [TURN * point.speed_Hz for point in points]
    places = np.array([place for _, place in base.points])
    return SpeedModel(base, omegas, changes, lambda omega: excited(base, omega, excitation), places)


def _shares(points: Sequence[StabilityPoint]) -> list[tuple[int, float]]:
    """Numbers of the other meshes that all points have, with the shares of the difference that are errors."""
    if len({len(point.others) for point in points}) > 1:
        return []
    return [(number, share) for number, (*_, share) in enumerate(points[0].others)]


def _critical(
    model: SpeedModel,
    others: Sequence[tuple[SpeedModel, float]],
    peak: ResponsePeak,
    point: StabilityPoint,
    operating_Hz: tuple[float, float] | None,
) -> CriticalSpeed:
    """A peak with what is known of it; others: the response on other meshes, with the shares of the difference that are
    errors."""
    speed, bounded = peak.omega / TURN, math.isfinite(peak.amplitude)
    error = SHARP * speed
    if _changes(point):
        apart = [share * abs(moved(other, peak) - peak.omega) / TURN for other, share in others]
        left = float(np.min(np.abs(model.omegas - peak.omega))) / TURN
        error = math.nan if point.films and not apart else max(LEAST * speed if apart else error, left, *apart)
    mode, direction, decrement = model.mode(peak.omega)
    rotor = point.rotor
    return CriticalSpeed(
        speed_Hz=speed,
        speed_uncertainty_Hz=error,
        mode=mode,
        direction=direction,
        node="" if rotor is None else rotor.points[peak.point][0],
        amplitude=peak.amplitude if bounded else None,
        amplification_factor=amplification_factor(model, peak),
        separation_margin=separation_margin(speed, operating_Hz),
        logarithmic_decrement=decrement,
    )


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


def _amplitude_error(
    motion: Complex, rotors: Sequence[LinearRotor], points: Sequence[StabilityPoint], excitation: str
) -> Array:
    """(n, p) in m: the largest difference of the amplitudes (n, p, 2) from those on the other meshes of the films times
    their shares, at least LEAST; rotors: as they are at each speed; NaN where a mesh is missing at a speed."""
    own, apart = larger_semi_axis(motion), []
    for number, share in _shares(points):
        other = []
        for rotor, point in zip(rotors, points, strict=True):
            omega = 2.0 * math.pi * point.speed_Hz
            q = forced_motion(rotor, omega, excited(rotor, omega, excitation), *point.others[number][:2])
            other.append([place @ q for _, place in rotor.points])
        apart.append(share * np.abs(larger_semi_axis(np.array(other)) - own))
    return np.maximum(LEAST * own, np.max(apart, axis=0)) if apart else np.full(own.shape, math.nan)
