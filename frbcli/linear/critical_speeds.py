"""The critical speeds of a machine: the peaks of its response over the speed, and, for runs, the speeds at which a
natural frequency equals the speed.

The response to the unbalance is a rational function of the speed as long as coefficients are constant. Its poles are
complex speeds: the real part is where a mode is in resonance, the imaginary part half of the width of the peak. They
say where the response is evaluated, so that no peak falls between two speeds, and which bump of a curve is a peak.

What runs are compared with (linear_critical_speeds) are modes of the rotor in half-Sommerfeld films, full wherever they
carry: a mass-conserving film has no eight coefficients, and the stiffness of a starved film changes with time.
Finite-volume films are on the coarsest mesh of static results, whose critical speeds differ by less than 1e-4 from the
finest mesh."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.analysis.spectrum import prominent_peaks
from frbcli.arrays import Array, Complex, larger_semi_axis
from frbcli.case.schema import Case
from frbcli.equilibrium.hopf import oscillating
from frbcli.equilibrium.linearised import coefficients_of, small_motions
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.errors import FrbError, NotConverged
from frbcli.linear.stability_point import eigenvalues
from frbcli.rotor.assembly import LinearRotor
from frbcli.rotor.loads import EQUAL
from frbcli.rotor.port import tangent
from frbcli.scene.films import full_films, rings

SPEEDS = 20  # between which natural frequencies are nearly straight
LOWEST = 0.01  # share of the highest speed
ABOVE = 1.2  # times the highest speed of a run: a mode a little above it is felt below
DAMPED = 1.0 / math.sqrt(2.0)  # damping ratio from which on unbalance causes no peak

FORWARD, BACKWARD, MIXED = "forward", "backward", "mixed"
STILL = 1e-3  # of the largest motion: a point that moves less has no sense of whirl
ALIKE = 1e-7  # relative: poles and eigenvalues that are nearer to each other are one
CLOSE = 1e-4  # relative, of the speed of a peak
SLENDER = 1e-6  # half width of a peak over its speed, below which an eigenvalue may have it from round-off alone
UNDAMPED = 1e-10  # half width of a peak over its speed, below which it has no height
SETTLINGS = 8  # steps that bring a pole to the coefficients at its own speed
PLACES = 200  # speeds at which the response is evaluated, in addition to speeds around its poles
WIDTHS = np.concatenate([-(2.0 ** np.arange(5.0, -4.0, -1.0)), [0.0], 2.0 ** np.arange(-3.0, 6.0)])  # around a pole
STEPS = np.arange(1, 400) / 16.0  # the same, in search of the width of a peak
REACH = 3.0  # half widths: a bump that is further from a pole is not its peak
PROMINENT, NOTICED = 0.01, 1e-4  # prominence of a peak over its height, and over the largest amplitude

Load = Callable[[float], tuple[float, Complex]]


def whirl_direction(motion: Complex) -> str:
    """The direction in which points with complex amplitudes (p, 2) whirl: "mixed" where they differ, or all move to and
    fro in a line."""
    forward, backward = np.abs(motion[:, 0] + 1j * motion[:, 1]), np.abs(motion[:, 0] - 1j * motion[:, 1])
    moving = forward + backward > STILL * np.max(forward + backward)
    moving &= np.abs(forward - backward) > EQUAL * (forward + backward)  # to and fro in a line: no sense
    senses = set((forward > backward)[moving].tolist())
    return MIXED if len(senses) != 1 else FORWARD if True in senses else BACKWARD


@dataclass(frozen=True)
class CriticalSpeed:
    """A peak of the response over the speed of the rotor, at the point that moves the most there.

    speed_uncertainty_Hz: by the search and by the mesh of the films, NaN where that is not known; mode: number of the
    mode that resonates among those that oscillate at this speed, from 1, by frequency; direction: its whirl, see
    whirl_direction; node: the point; amplitude: its larger semi-axis in m, None without damping, where nothing bounds
    it; amplification_factor: the speed over the width of the peak at 1 / sqrt(2) of its height, None where a side of it
    lies outside of the range or under another peak; separation_margin: distance from the operating range over the
    nearer limit of that, 0 within it, None without one; logarithmic_decrement: of the mode.
    """

    speed_Hz: float
    speed_uncertainty_Hz: float
    mode: int
    direction: str
    node: str
    amplitude: float | None
    amplification_factor: float | None
    separation_margin: float | None
    logarithmic_decrement: float


class SpeedModel:
    """The response of a machine at any speed, out of its films at some.

    At a fixed speed the response is a rational function; what films add to the matrices of the machine changes smoothly
    and is a cubic spline over the speeds at which they are solved."""

    def __init__(
        self, rotor: LinearRotor, omegas: Sequence[float], changes: Sequence[Array], load: Load, places: Array
    ) -> None:
        """rotor: the machine without its films; omegas: ascending, in rad/s, at which they are solved; changes: what
        they add to its stiffness and its damping there, (2, n, n) each, none without films; load: by the speed in rad/s
        frequency in rad/s, and (n,) complex amplitudes in N; places: (p, 2, n) x and y of the points."""
        from scipy.interpolate import make_interp_spline  # runs, which need critical speeds alone, need not wait

        self._rotor, self._load, self._places, self.omegas = rotor, load, places, np.asarray(omegas, dtype=np.float64)
        degree = min(3, len(changes) - 1)
        self._changes = make_interp_spline(self.omegas, np.array(changes), k=degree) if degree >= 0 else None

    def matrices(self, omega: float) -> tuple[Array, Array, Array]:
        """(n, n) mass, damping with the gyroscopic term, and stiffness at a speed in rad/s."""
        here = self._rotor.at(omega)
        stiffness, damping = here.stiffness, here.damping + omega * here.gyroscopic
        if self._changes is not None:
            more = self._changes(omega)
            stiffness, damping = stiffness + more[0], damping + more[1]
        return here.mass, damping, stiffness

    def dynamic(self, omega: float) -> Complex:
        """(n, n) between motion and load at a speed in rad/s."""
        frequency, (mass, damping, stiffness) = self.frequency(omega), self.matrices(omega)
        return np.asarray(stiffness + 1j * frequency * damping - frequency**2 * mass)

    def frequency(self, omega: float) -> float:
        """Of the load, rad/s."""
        return self._load(omega)[0]

    def amplitudes(self, omegas: Array) -> Array:
        """(m, p) larger semi-axes in m of the points at speeds (m,) in rad/s."""
        matrices = np.array([self.dynamic(omega) for omega in omegas.tolist()])
        forces = np.array([self._load(omega)[1] for omega in omegas.tolist()])
        motion = np.linalg.solve(matrices, forces[:, :, None])[:, :, 0]
        return larger_semi_axis(np.einsum("pcn,mn->mpc", self._places, motion))

    def mode(self, omega: float) -> tuple[int, str, float]:
        """Number, direction of whirl and logarithmic decrement of the mode that resonates at a speed in rad/s."""
        values, motions = small_motions(self.matrices(omega), self._rotor.turning)
        kept = np.flatnonzero(oscillating(values))
        kept = kept[np.argsort(values[kept].imag, kind="stable")]
        nearest = int(np.argmin(np.abs(values[kept] - 1j * self.frequency(omega))))
        value = complex(values[kept[nearest]])
        own = np.abs(values[kept] - value) < ALIKE * abs(value)
        motion = self._places @ motions[:, kept[nearest]]
        if np.count_nonzero(own) > 1:  # any sum of their motions is one: the load decides
            aside = omega * (1.0 + ALIKE)
            motion = self._places @ np.linalg.solve(self.dynamic(aside), self._load(aside)[1])
        return nearest + 1, whirl_direction(motion), 0.0 - 2.0 * math.pi * value.real / value.imag

    def poles(self) -> Complex:
        """(k,) complex speeds in rad/s at which the response has a pole: the real part within those that were solved,
        the imaginary part half of the width of a peak."""
        low, high = float(self.omegas[0]), float(self.omegas[-1])
        if self.frequency(low) == self.frequency(high):
            return np.zeros(0, dtype=complex)  # a load of a frequency of its own: no mode crosses it but by its change
        if self._changes is None and self._rotor.over_speed is None:
            roots = self._poles_near(0.5 * (low + high), 0.5 * (high - low))
        else:
            edges = self.omegas if len(self.omegas) < 4 else self.omegas[::2]
            edges = np.unique(np.append(edges, high))
            middles, halves = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
            spans = zip(middles.tolist(), halves.tolist(), strict=True)
            roots = np.array([self._settled(pole) for span in spans for pole in self._poles_near(*span)])
        roots = roots[np.argsort(roots.real, kind="stable")]
        apart = np.append(True, np.abs(np.diff(roots)) > ALIKE * np.abs(roots[1:])) if len(roots) else roots == 0.0
        return np.asarray(roots[apart], dtype=complex)

    def _poles_near(self, middle: float, half: float, reach: float = 1.0 + ALIKE) -> Complex:
        """The poles within `half` of a speed, both in rad/s, of the quadratic through the matrices there: they are
        quadratic where coefficients are constant. reach: distance over `half` up to which they are taken."""
        below, here, above = (self.dynamic(middle + share * half) for share in (-1.0, 0.0, 1.0))
        n, linear, square = len(here), 0.5 * (above - below), 0.5 * (above + below) - here
        companion = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(square, np.hstack([here, linear]))]])
        roots = np.linalg.eigvals(companion)
        roots = middle + half * roots[np.abs(roots.real) <= reach]
        return np.asarray(roots[(np.abs(roots.imag) < DAMPED * np.abs(roots)) & (roots.real > 0.0)])

    def half_width(self, pole: complex) -> float:
        """Half of the width of a peak in rad/s, of a slender one by the work of the damping on the undamped motion:
        eigenvalues of a stiff machine have the round-off of its largest one."""
        omega = pole.real
        if abs(pole.imag) > SLENDER * omega:
            return abs(pole.imag)
        here, below, above = (self.dynamic(omega * (1.0 + share * CLOSE)) for share in (0.0, -1.0, 1.0))
        motion = np.linalg.svd(here)[2][-1].conj()
        work = 0.5 * abs(motion.conj() @ (here - here.conj().T) @ motion)
        return float(work * 2.0 * CLOSE * omega / abs(motion.conj() @ (above - below) @ motion))

    def _settled(self, pole: complex) -> complex:
        """A pole with the coefficients at its own speed."""
        low, high = float(self.omegas[0]), float(self.omegas[-1])
        for _ in range(SETTLINGS):
            near = self._poles_near(min(max(pole.real, low), high), max(abs(pole.imag), CLOSE * pole.real), 1e3)
            last, pole = pole, complex(near[np.argmin(np.abs(near - pole))]) if len(near) else pole
            if abs(pole - last) <= ALIKE * abs(pole):
                break
        return pole


@dataclass(frozen=True)
class ResponsePeak:
    """Of a point, by its number; omega: rad/s; amplitude: m, infinite without damping; pole: see SpeedModel."""

    point: int
    omega: float
    amplitude: float
    pole: complex


def peaks(model: SpeedModel) -> list[ResponsePeak]:
    """The peaks of the response between the speeds of a model, ascending, each at the point that moves the most: they
    belong to a pole, and stand out by PROMINENT of their height, and by NOTICED of the largest amplitude."""
    low, high = float(model.omegas[0]), float(model.omegas[-1])
    poles = model.poles() if high > low else np.zeros(0, dtype=complex)
    undamped = np.array([model.half_width(pole) <= UNDAMPED * pole.real for pole in poles.tolist()], dtype=bool)
    near_axis = [peak for pole in poles[undamped] if low <= pole.real <= high and (peak := _unbounded(model, pole))]
    around = poles[~undamped, None].real + np.abs(poles[~undamped, None].imag) * WIDTHS
    close = poles[undamped, None].real * (1.0 + CLOSE * np.array([-1.0, 1.0]))
    grid = np.unique(np.concatenate([np.linspace(low, high, PLACES), model.omegas, around.ravel(), close.ravel()]))
    grid = grid[(grid >= low) & (grid <= high)]
    sizes = model.amplitudes(grid)
    clear = (np.abs(grid[:, None] - poles[undamped].real) > 10.0 * CLOSE * grid[:, None]).all(axis=1)
    largest = float(sizes[clear].max(initial=0.0))
    bounded: dict[int, ResponsePeak] = {}
    for point, size in enumerate(sizes.T):
        for summit in prominent_peaks(size, max(NOTICED * largest, np.finfo(float).tiny)):
            i = summit.place
            distance = np.abs(grid[i] - poles)
            pole = int(np.argmin(distance)) if len(poles) else -1
            if summit.prominence < PROMINENT * size[i] or pole < 0 or undamped[pole]:
                continue
            known = bounded[pole].amplitude if pole in bounded else 0.0
            if distance[pole] <= REACH * abs(poles[pole].imag) and size[i] > known:
                bounded[pole] = _refined(model, point, complex(poles[pole]), grid[i - 1 : i + 2].tolist())
    return sorted([*near_axis, *bounded.values()], key=lambda peak: peak.omega)


def _unbounded(model: SpeedModel, pole: complex) -> ResponsePeak | None:
    """The peak of an undamped motion, None if the load does not excite it."""
    near, far = model.amplitudes(pole.real * (1.0 + np.array([1e-2, 1.0]) * CLOSE))
    excited = near > 2.0 * far
    if not excited.any():
        return None
    point = int(np.argmax(np.where(excited, near, 0.0)))
    return ResponsePeak(point, float(pole.real), math.inf, complex(pole))


def _refined(model: SpeedModel, point: int, pole: complex, bracket: Sequence[float]) -> ResponsePeak:
    """The peak of a point between the first and the last of three speeds in rad/s."""
    from scipy.optimize import minimize_scalar

    def off(omega: float) -> float:
        return -float(model.amplitudes(np.array([omega]))[0, point])

    low, _, high = bracket
    minimum = minimize_scalar(off, bounds=(low, high), method="bounded", options={"xatol": 1e-6 * (high - low)})
    return ResponsePeak(point, float(minimum.x), -float(minimum.fun), pole)


def moved(model: SpeedModel, peak: ResponsePeak) -> float:
    """Speed in rad/s of a peak in the response of another machine, NaN where there is none near it."""
    if not math.isfinite(peak.amplitude):
        return math.nan
    aside = max(REACH * abs(peak.pole.imag), 1e2 * CLOSE * peak.omega)
    low, high = max(peak.omega - aside, model.omegas[0]), min(peak.omega + aside, model.omegas[-1])
    omega = _refined(model, peak.point, peak.pole, (low, peak.omega, high)).omega
    return math.nan if min(omega - low, high - omega) < 1e-3 * (high - low) else omega


def amplification_factor(model: SpeedModel, peak: ResponsePeak) -> float | None:
    """See CriticalSpeed."""
    from scipy.optimize import brentq

    if not math.isfinite(peak.amplitude):
        return None
    level, width = peak.amplitude / math.sqrt(2.0), abs(peak.pole.imag)
    ends = []

    def over(omega: float) -> float:
        return float(model.amplitudes(np.array([omega]))[0, peak.point]) - level

    for end in (float(model.omegas[0]), float(model.omegas[-1])):
        steps = peak.omega + np.sign(end - peak.omega) * width * STEPS
        steps = steps[np.abs(steps - peak.omega) < abs(end - peak.omega)]
        sizes = model.amplitudes(np.append(steps, end))[:, peak.point]
        below = np.flatnonzero(sizes < level)
        if not len(below) or (sizes[: below[0]] > peak.amplitude * (1.0 + ALIKE)).any():
            return None
        places = np.concatenate([[peak.omega], steps, [end]])
        ends.append(brentq(over, places[below[0]], places[below[0] + 1]))
    return float(peak.omega / abs(ends[1] - ends[0]))


def separation_margin(speed: float, operating: tuple[float, float] | None) -> float | None:
    """See CriticalSpeed; operating: the lowest and the highest speed of operation, in the unit of the speed."""
    if operating is None:
        return None
    low, high = operating
    return (low - speed) / low if speed < low else max(speed - high, 0.0) / high


def linear_critical_speeds(case: Case) -> tuple[float, ...] | None:
    """Critical speeds of a case in Hz, ascending, up to its highest speed and a little above; None where they are not
    known: for floating rings, whose films whirl from low speeds on, and where no static equilibrium is found."""
    if rings(case):
        return None
    top = ABOVE * case.speed.top
    try:
        machines = StaticMachines(full_films(case), coarse=True)
    except FrbError:  # an opening that this film does not know
        return None
    sweep = np.geomspace(top, LOWEST * top, SPEEDS).tolist() if top > 0.0 else []
    points = list(_modes(machines, sweep))
    crossings = (_crossings(below, above) for above, below in itertools.pairwise(points))
    return tuple(sorted(itertools.chain(*crossings))) if len(points) > 1 else None


def _modes(machines: StaticMachines, speeds_Hz: Sequence[float]) -> Iterator[tuple[float, Array]]:
    """Speed and natural frequencies (k,) in Hz of the modes that unbalance can excite, where the rotor can rest; from a
    fast journal near the middle outwards."""
    machine = None
    for speed in speeds_Hz:
        omega = 2.0 * math.pi * speed
        try:
            machine = machines.at(omega, machine, with_error=False)
        except NotConverged:
            continue
        stiffness, damping = coefficients_of(machine.films)
        rotor = tangent(machine.system.rotor, omega, machine.at_rest.position.displacements)
        values = eigenvalues(rotor, omega, stiffness, damping)
        excited = values[(values.imag > 0.0) & (-values.real < DAMPED * np.abs(values))]
        yield speed, np.abs(excited) / (2.0 * math.pi)


def _crossings(below: tuple[float, Array], above: tuple[float, Array]) -> Iterator[float]:
    """Where natural frequencies equal the speed between two speeds: of each mode and the nearest one at the other."""
    (low, lower), (high, upper) = below, above
    for frequency in lower if len(upper) else ():
        off, then = frequency - low, upper[np.argmin(np.abs(upper - frequency))] - high
        if off >= 0.0 > then:
            yield float(low + (high - low) * off / (off - then))
