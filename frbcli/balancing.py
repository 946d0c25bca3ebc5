"""Synchronous vectors of a run: what its points move with the rotor, with the phase to the rotor's angle.

A point moves with x = Re(A exp(i alpha)), and y likewise, alpha the angle of the rotor. In a computed run it is 0 at
the beginning, in a measurement 0 at each pulse of the tacho.

Balancing by influence coefficients, over several planes, speeds and probes.

With the synchronous vectors V of the points, and what they move by a unit of unbalance in each plane, H, the unbalance
u minimises the weighted sum of |V - H u|^2. The correction, which is added, is -u. H is computed for the case of a run,
or follows from trial runs: H_j = (V_j - V) / u_j with the trial unbalance u_j in the plane j alone.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from frbcli.analysis.measured import MEASURED
from frbcli.analysis.order_tracking import FEWEST as LEAST_REVOLUTIONS
from frbcli.analysis.order_tracking import REVOLUTIONS, STEPS, OrderTrack, order_track
from frbcli.analysis.signals import RunLike, course, joined, last_change, points, signal_of
from frbcli.analysis.tacho import MARK
from frbcli.arrays import Array, Complex, Truths, larger_semi_axis
from frbcli.case.reading.load import load_case_text
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, spaced, speed_shown, table_of
from frbcli.equilibrium.linearised import coefficients_of
from frbcli.errors import NotConverged, did_you_mean, input_error
from frbcli.linear.response import SOUND, Response, forced_motion, response
from frbcli.results.records import TIME
from frbcli.results.store import Run
from frbcli.scene.changes import case_at
from frbcli.scene.machine.shaft import BalancingPlane
from frbcli.scene.machine.turbocharger import shaft_of

OF_SHAFT = ("journal", "disk")  # kinds of points
SAME, NEAR = 2e-3, 1e-2  # relative: speeds that are equal, and speeds that are close enough to replace each other
HELD = 2.0  # windows: a speed that is held longer has settled in the second half of that time
DWELLS = 0.25  # share of a run that holds one speed
WINDOWS = 0.5  # share of a short run that a window has
FEWEST = 4  # windows of which a scatter is known
SPEEDS, FROM, TO = 8, 0.4, 0.95  # of a ramp: number, and share of its highest speed


@dataclass(frozen=True)
class SynchronousVectors:
    """Vectors of p points at s speeds. values: (s, p, 2) complex amplitudes of x and y in m; scatter: (s, p, 2) of the
    windows in m, 0 where it is not known."""

    speeds_Hz: Array
    points: tuple[str, ...]
    values: Complex
    scatter: Array


def shaft_points(run: RunLike) -> tuple[str, ...]:
    """The points of the shaft whose motion a run has."""
    return tuple(joined(kind, name) for kind in OF_SHAFT for name in points(run.signals, kind))


def synchronous_vectors(
    run: RunLike, names: Sequence[str], speeds_Hz: Sequence[float] | None = None
) -> SynchronousVectors:
    """The vectors of points at speeds in Hz: by default at the one that the run holds, else at SPEEDS of its ramp. In a
    run whose unbalance or clearances change they are those after the last change: no unbalance explains all of them.

    Raises InputError for a point that the run does not have, a speed that it does not reach, a change that it ends too
    soon after, and a rotor that turns the other way round."""
    changed_s = last_change(run)
    revolutions = _window(run, changed_s)
    tracks = [order_track(run, 1.0, name, revolutions).after(changed_s) for name in names]
    if not len(tracks[0].time_s):
        problem = f"ends too soon after the loss or the new clearance at {changed_s:.4g} s."
        raise input_error("balance", "run", "", problem, "Let it go on, or balance a run without it.")
    if not float(tracks[0].speed_Hz.max()) > 0.0:
        raise input_error("balance", "speed", "", "is not above 0: the rotor turns the other way round.", "")
    speeds = _usual_speeds(tracks[0]) if speeds_Hz is None else sorted(set(speeds_Hz))
    turned = np.exp(2j * np.pi * run.references.get(MARK, 0.0))
    rows = [[_at(track, speed, changed_s) for track in tracks] for speed in speeds]
    values = np.array([[value for value, _ in row] for row in rows])
    scatter = np.array([[scatter for _, scatter in row] for row in rows])
    return SynchronousVectors(np.array(speeds), tuple(names), turned * values, scatter)


def _window(run: RunLike, changed_s: float) -> int:
    """Revolutions of the windows: fewer than usual in a run that makes few after its last change."""
    time, speed = course(signal_of(run, TIME), signal_of(run, "speed_Hz"))
    late = time >= changed_s
    time, speed = time[late], speed[late]
    turned = float(np.sum(0.5 * np.abs(speed[1:] + speed[:-1]) * np.diff(time)))
    return max(LEAST_REVOLUTIONS, min(REVOLUTIONS, int(WINDOWS * turned)))


def _usual_speeds(track: OrderTrack) -> list[float]:
    speeds = track.speed_Hz
    for centre in (float(np.median(speeds)), float(speeds.max())):
        near = np.abs(speeds - centre) <= SAME * centre
        if np.count_nonzero(near) > DWELLS * len(speeds):
            return [float(speeds[near].mean())]
    top = float(speeds.max())
    return [float(speed) for speed in np.linspace(max(FROM * top, float(speeds.min())), TO * top, SPEEDS)]


def _at(track: OrderTrack, speed: float, changed_s: float) -> tuple[Complex, Array]:
    """Vector (2,) and scatter (2,) in m at a speed in Hz, of a track since its last change."""
    speeds = track.speed_Hz
    nearest = int(np.argmin(np.abs(speeds - speed)))
    if abs(speeds[nearest] - speed) > NEAR * speed:
        since = "" if changed_s < 0.0 else f" after the loss or the new clearance at {changed_s:.4g} s"
        problem = f"is not reached{since}; the run goes from {speeds.min():.4g} to {speeds.max():.4g} Hz."
        raise input_error("balance", "speed", f"{speed:.6g} Hz", problem, "Choose another speed, by --speed.")
    values = np.stack([track.along("x"), track.along("y")], axis=-1)
    near = np.flatnonzero(np.abs(speeds - speeds[nearest]) <= SAME * speed)
    if len(near) > HELD * track.revolutions * STEPS:
        near = near[len(near) // 2 :]
    if len(near) < FEWEST:
        return _between(speeds, values, nearest, speed), np.zeros(2)
    here = values[near]
    line = np.polynomial.polynomial.polyfit(near - near.mean(), here.view(float).reshape(len(near), -1), 1)
    off = here - (line[0] + np.outer(near - near.mean(), line[1])).view(complex).reshape(here.shape)
    return here.mean(axis=0), np.sqrt(np.mean(np.abs(off) ** 2, axis=0))


def _between(speeds: Array, values: Complex, nearest: int, speed: float) -> Complex:
    """The vector (2,) on the line through two windows, the nearest one and its neighbour on the other side."""
    for other in (nearest - 1, nearest + 1):
        if 0 <= other < len(speeds) and (speeds[other] - speed) * (speeds[nearest] - speed) < 0.0:
            share = (speed - speeds[nearest]) / (speeds[other] - speeds[nearest])
            return np.asarray(values[nearest] + share * (values[other] - values[nearest]))
    return np.asarray(values[nearest])


def marked(run: RunLike) -> bool:
    """Whether a run holds the angle of the rotor."""
    return math.isfinite(run.references.get(MARK, math.nan))


ERROR = 0.01  # error of vectors and of influence coefficients over the vectors of the same point, at least
QUIET = 0.05  # of the largest amplitude, by which a point counts at least
NOTHING = 1e-9  # of the largest vector: what was not measured has round-off
ALIKE, INSEPARABLE = 10.0, 1e6  # condition numbers
DOUBTFUL_RESIDUAL = 0.10
DOUBTFUL_UNCERTAINTY = 0.20  # over the largest unbalance
FEEBLE = 0.10  # change of the vectors by a trial, over themselves


def planes_named(case: Case, names: Sequence[str]) -> tuple[BalancingPlane, ...]:
    """The planes of a case with these names. Raises InputError for one that it does not have."""
    known = {plane.name: plane for plane in shaft_of(case).planes}
    for name in names:
        if name not in known:
            problem = f"is no disk of {case.name or 'the case'}."
            raise input_error("balance", "planes", name, problem, did_you_mean(name, known))
    return tuple(known[name] for name in names)


def computed_influence(
    case: Case, planes: Sequence[BalancingPlane], speeds_Hz: Sequence[float], points: Sequence[str]
) -> tuple[Response, Complex]:
    """The response of a case at s speeds, and (s, p, 2, k) in m/(kg m) what p points move along x and y by a unit of
    unbalance in each of k planes, at the angle 0 of the rotor, linearised about the static equilibria.

    Raises InputError as response does, NotConverged if the rotor does not rest at a speed."""
    linear = response(case, speeds_Hz)
    if len(linear.speeds_Hz) < len(set(speeds_Hz)):
        raise NotConverged("The rotor has no static equilibrium at some of the speeds. Choose others, by --speed.")
    influence = []
    for point in linear.resting:
        rotor, omega = point.rotor, 2.0 * np.pi * point.speed_Hz
        if rotor is None:
            continue
        nodes = dict(rotor.points)
        pull = np.stack([omega**2 * (nodes[plane.node][1] + 1j * nodes[plane.node][0]) for plane in planes], axis=-1)
        motion = forced_motion(rotor, omega, (omega, pull), *coefficients_of(point.films))
        influence.append([nodes[name] @ motion for name in points])
    return linear, np.array(influence)


@dataclass(frozen=True)
class TrialRun:
    """A run with a trial unbalance in one plane, in addition to the state of the run that is balanced.

    Parameters
    ----------
    plane : str
        Name of the plane.
    run : Run
        The run with it.
    unbalance_kg_m : float
        Trial mass times its radius.
    angle_deg : float
        Its angle on the rotor, in the sense of rotation, from the same zero as the corrections.
    """

    plane: str
    run: Run
    unbalance_kg_m: float
    angle_deg: float

    @property
    def unbalance(self) -> complex:
        """In kg m, with its angle."""
        return cmath.rect(self.unbalance_kg_m, math.radians(self.angle_deg))


@dataclass(frozen=True)
class PlaneCorrection:
    """unbalance: found in a plane, kg m with its angle on the rotor; uncertainty: standard one of its size, kg m."""

    plane: str
    unbalance: complex
    uncertainty: float

    @property
    def correction(self) -> complex:
        """Unbalance to be added, kg m with its angle."""
        return -self.unbalance


@dataclass(frozen=True)
class BalancedPoint:
    """The synchronous amplitude of a point at a speed in m, before and, as expected, after the correction."""

    speed_Hz: float
    point: str
    amplitude: float
    remaining: float


def _degrees(vector: complex) -> float:
    return math.degrees(cmath.phase(vector))


def _gram_millimetres(size: float) -> str:
    return f"{1e6 * size:.4g}"


# Of a PlaneCorrection
PLANES = (
    Column("plane", "", "plane", shown=(Shown("plane"),)),
    Column("correction", "kg m", "unbalance to be added", lambda plane: abs(plane.correction),
           shown=(Shown("add g mm", _gram_millimetres),)),
    Column("angle", "deg", "its angle on the rotor, in the sense of rotation",
           lambda plane: _degrees(plane.correction), shown=(Shown("at deg", ".1f"),)),
    Column("correction_uncertainty", "kg m", "its standard uncertainty", attrgetter("uncertainty"),
           shown=(Shown("+- g mm", lambda size: f"{1e6 * size:.2g}"),)),
    Column("unbalance", "kg m", "unbalance that was found", lambda plane: abs(plane.unbalance),
           shown=(Shown("unbalance g mm", _gram_millimetres),)),
    Column("unbalance_angle", "deg", "its angle on the rotor", lambda plane: _degrees(plane.unbalance),
           shown=(Shown("at deg", ".1f"),)),
)  # fmt: skip
# Of a BalancedPoint
POINTS = (
    Column("speed", "Hz", "rotor speed", attrgetter("speed_Hz"), shown=(speed_shown(),)),
    Column("point", "", "point", key="node", shown=(Shown("point", spaced),)),
    Column("amplitude", "m", "synchronous amplitude, larger semi-axis", shown=(Shown("um", ".3g", "um"),)),
    Column("remaining", "m", "expected with the correction", shown=(Shown("corrected um", ".3g", "um"),)),
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class Balancing(Tabular):
    """Corrections of k planes from p points at s speeds.

    vectors: that were balanced; expected: (s, p, 2) m with the unbalances found; residual: weighted norm of the
    difference over the norm of the vectors; condition: of the influence coefficients with columns of unit length, large
    where planes cannot be separated; doubts: sentences, none of a good result; trials: whether coefficients come from
    trial runs.
    """

    run: Run
    planes: tuple[PlaneCorrection, ...]
    vectors: SynchronousVectors
    expected: Complex
    residual: float
    condition: float
    doubts: tuple[str, ...]
    trials: bool

    @property
    def speeds_Hz(self) -> Array:
        """(s,) ascending."""
        return self.vectors.speeds_Hz

    @property
    def status(self) -> str:
        """ "good" | "doubtful"."""
        return "doubtful" if self.doubts else "good"

    @property
    def points(self) -> tuple[BalancedPoint, ...]:
        """At each speed each point."""
        before, after = (larger_semi_axis(each) for each in (self.vectors.values, self.vectors.values - self.expected))
        return tuple(
            BalancedPoint(speed, name, float(before[i, k]), float(after[i, k]))
            for i, speed in enumerate(self.speeds_Hz.tolist()) for k, name in enumerate(self.vectors.points)
        )  # fmt: skip

    def table(self) -> Table:
        """A row for each plane."""
        return table_of(PLANES, self.planes)


def balance(
    run: Run,
    planes: Sequence[str] = (),
    speeds_Hz: Sequence[float] | None = None,
    points: Sequence[str] | None = None,
    trials: Sequence[TrialRun] = (),
    triggered: bool = False,
) -> Balancing:
    """Find the correction masses that balance the rotor of a run.

    Parameters
    ----------
    run : Run
        A computed run, which carries its case, or a measured one with trial runs.
    planes : sequence of str
        Names of disks, where masses can be added; "disk" of a Jeffcott rotor, "journal" of a rigid one. By default
        the planes of the trials.
    speeds_Hz : sequence of float, optional
        Rotor speeds in Hz; by default the one that the run holds, or eight of its ramp.
    points : sequence of str, optional
        Points of the run that take part, such as "journal_left"; by default all of the shaft.
    trials : sequence of TrialRun
        Without them influence coefficients are computed, linearised, for the case of the run.
    triggered : bool
        Measurements without a tacho of one pulse per revolution began at the same angle of the rotor.

    Returns
    -------
    Balancing
        For each plane the unbalance that has to be added, opposite to that which is there.

    Raises
    ------
    InputError
        For planes, points, speeds or trials that are not there, a measurement without trials or without the angle of
        the rotor, or fewer vectors than planes.
    NotConverged
        If the planes cannot be separated.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> frbcli.balance(run, ["disk"]).planes  # doctest: +SKIP
    """
    _check_angles([run, *(trial.run for trial in trials)], triggered)
    named = tuple(planes or dict.fromkeys(trial.plane for trial in trials))
    if not named:
        raise input_error("balance", "planes", "", "are missing.", "Name disks of the case, as in --planes a,b.")
    if len(set(named)) < len(named):
        raise input_error("balance", "planes", ", ".join(named), "names a plane twice.", "Name each plane once.")
    vectors = synchronous_vectors(run, tuple(points or shaft_points(run)), speeds_Hz)
    doubts: list[str] = []
    influence = _by_trials(vectors, named, trials, doubts) if trials else _computed(run, vectors, named, doubts)
    return _solved(run, named, vectors, influence, doubts, bool(trials))


def _check_angles(runs: Sequence[Run], triggered: bool) -> None:
    """Raises InputError for measurements without the angle of the rotor."""
    for run in runs:
        if run.command == MEASURED and not triggered and not marked(run):
            problem = "holds no angle of the rotor, to which phases refer: no tacho shows one pulse a revolution."
            remedy = "Give --tacho with one pulse per revolution, or --triggered if all files begin at the same angle."
            raise input_error("balance", "run", str(run.path), problem, remedy)


def _computed(run: Run, vectors: SynchronousVectors, named: tuple[str, ...], doubts: list[str]) -> Complex:
    """Influence coefficients of the case of a run; what makes linear ones doubtful joins the doubts."""
    if not run.case_text:
        remedy = 'Give trial runs, as --trial a=trial.csv:"5 g*mm@30deg".'
        raise input_error("balance", "run", str(run.path), "is a measurement, which carries no case.", remedy)
    case = case_at(load_case_text(run.case_text, name=run.case_name), last_change(run))
    motion, influence = computed_influence(case, planes_named(case, named), vectors.speeds_Hz.tolist(), vectors.points)
    doubts += _nonlinear(motion)
    return influence


def _nonlinear(motion: Response) -> list[str]:
    beyond = [speed for speed, kind in zip(motion.speeds_Hz, motion.validity, strict=True) if kind != SOUND]
    whirls = motion.speeds_Hz[motion.growth > 0.0].tolist()
    unit, doubts = motion.case.speed_unit, []
    if beyond:
        doubts.append(
            f"At {unit.listed(beyond)} a journal moves so far in its gap that linear influence coefficients are wrong "
            "by more than 15 %."
        )
    if whirls:
        doubts.append(
            f"At {unit.listed(whirls)} a whirl grows: the journals do not move about the positions for which the "
            "influence coefficients are computed."
        )
    return doubts


def _by_trials(
    vectors: SynchronousVectors, named: tuple[str, ...], trials: Sequence[TrialRun], doubts: list[str]
) -> Complex:
    """Influence coefficients of trial runs, by least squares where a plane has several of them."""
    known = tuple(trial.plane for trial in trials)
    for name in named:
        if name not in known:
            raise input_error("balance", "planes", name, "has no trial run.", did_you_mean(name, known))
    columns = []
    for name in named:
        changes, sizes = [], []
        for trial in (each for each in trials if each.plane == name):
            if not trial.unbalance_kg_m > 0.0:
                raise input_error("balance", "trial", name, "has no unbalance above 0.", 'Write e.g. "5 g*mm@30deg".')
            change = synchronous_vectors(trial.run, vectors.points, vectors.speeds_Hz.tolist()).values - vectors.values
            if np.linalg.norm(change) < FEEBLE * np.linalg.norm(vectors.values):
                share = 100.0 * np.linalg.norm(change) / np.linalg.norm(vectors.values)
                doubts.append(f"The trial unbalance in {name} changes the vectors by {share:.2g} % only: take more.")
            changes.append(change)
            sizes.append(trial.unbalance)
        given = np.array(sizes)
        columns.append(np.tensordot(given.conj(), np.array(changes), 1) / np.sum(np.abs(given) ** 2))
    return np.stack(columns, axis=-1)


def _errors(values: Complex, seen: Truths) -> Array:
    """(p,) ERROR of the vectors (s, p, 2) of each point."""
    level = np.sqrt(np.mean(np.abs(values) ** 2, axis=(0, 2), where=seen))
    return np.asarray(ERROR * np.maximum(level, QUIET * level.max()))


def _spread(errors: Array, influence: Complex, unbalance: Complex, seen: Truths) -> float:
    """Factor by which errors of the influence coefficients enlarge the errors of the vectors (m,) that were seen."""
    more = sum(abs(size) ** 2 * _errors(influence[..., k], seen) ** 2 for k, size in enumerate(unbalance.tolist()))
    added = np.broadcast_to(np.asarray(more)[:, None], seen.shape)[seen]
    return float(np.sqrt(np.mean(1.0 + added / errors**2)))


def _solved(
    run: Run,
    named: tuple[str, ...],
    vectors: SynchronousVectors,
    influence: Complex,
    doubts: list[str],
    trials: bool,
) -> Balancing:
    size = np.abs(vectors.values)
    seen = np.broadcast_to((size > NOTHING * size.max()).any(axis=0), size.shape)  # y may not be measured
    count = int(np.count_nonzero(seen))
    if count < len(named):
        problem = f"are {len(named)}, more than the {count} vectors that the run has."
        raise input_error("balance", "planes", ", ".join(named), problem, "Give more probes, or more speeds.")
    errors = np.hypot(vectors.scatter, _errors(vectors.values, seen)[:, None])[seen]
    weight = 1.0 / errors
    rows, given = influence[seen] * weight[:, None], vectors.values[seen] * weight
    condition = _condition(rows)
    if not condition < INSEPARABLE:
        raise NotConverged(
            f"The planes {', '.join(named)} cannot be separated: their influence coefficients are alike (condition "
            f"number {condition:.1g}). Choose other planes, more points, or more speeds."
        )
    unbalance = np.linalg.lstsq(rows, given, rcond=None)[0]
    off = float(np.linalg.norm(rows @ unbalance - given))
    scale = max(_spread(errors, influence, unbalance, seen), off / math.sqrt(max(count - len(named), 1)))
    uncertainty = scale * np.sqrt(np.diag(np.linalg.inv(rows.conj().T @ rows)).real)
    planes = tuple(map(PlaneCorrection, named, unbalance.tolist(), uncertainty.tolist()))
    residual = off / float(np.linalg.norm(given))
    doubts = [*doubts, *_uncertain(planes, residual, condition)]
    expected = influence @ unbalance
    return Balancing(run, planes, vectors, expected, residual, condition, tuple(doubts), trials)


def _condition(rows: Complex) -> float:
    """Condition number of the columns at unit length; infinite where a column is 0."""
    lengths = np.linalg.norm(rows, axis=0)
    return math.inf if not lengths.all() else float(np.linalg.cond(rows / lengths))


def _uncertain(planes: Sequence[PlaneCorrection], residual: float, condition: float) -> list[str]:
    doubts, largest = [], max(abs(plane.unbalance) for plane in planes)
    if residual > DOUBTFUL_RESIDUAL:
        doubts.append(f"Unbalances in these planes leave {100.0 * residual:.3g} % of the vectors unexplained.")
    unsure = [plane.plane for plane in planes if plane.uncertainty > DOUBTFUL_UNCERTAINTY * largest]
    if unsure:
        why = f": the planes are hard to separate (condition number {condition:.3g})" if condition > ALIKE else ""
        doubts.append(
            f"The corrections of {', '.join(unsure)} are uncertain by more than a fifth of the largest{why}. Take "
            "other planes, more points or more speeds."
        )
    return doubts
