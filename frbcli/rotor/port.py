"""Forces at ports: what acts between two nodes of a machine and is not linear, such as a stop or a ball bearing.

The force on the first node is F(d, v, Omega, alpha) with the displacement d and velocity v of this node against the
second, or the ground, and the speed and angle of the rotor. Rest, small motions and time steps ask for it
and for its derivatives alone: they know no kinds of forces.

Force laws that were added from Python: a [[spring]] of this process takes them by their names.
"""

from __future__ import annotations

import hashlib
import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeVar

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import NotConverged

if TYPE_CHECKING:
    from frbcli.rotor.assembly import LinearRotor

Rest = TypeVar("Rest")
STEP, SLOW = 1e-4, 60.0  # of differences, over the length; rad/s of a vibration of a rotor that hardly turns
# Motions at which a law is tried: displacements and velocities over its length, speeds in rad/s, an angle
PLACES = ((0.0, 0.0), (0.1, 0.2), (0.5, -1.2), (-2.0, 0.7))
SPEEDS, TRIED_ANGLE = (0.0, 600.0), 0.3
WRONG = 1e-2  # share of the largest derivative by which a given one may differ from differences of the force
_NAME = re.compile("[a-z][a-z0-9-]{0,39}")
ITERATIONS = 60  # of Newton's method; from half of them on its steps are halved
D_X, D_Y, V_X, V_Y, SPEED, ANGLE, MOTION = range(7)  # what a force follows: m, m/s, rad/s and rad
F_X, F_Y, XX, XY, YX, YY, V_XX, V_XY, V_YX, V_YY = range(10)  # force, derivatives by d (XX: dF_x / d_x) and v
TORQUE, GRIP, ANSWER = range(10, 13)  # on the rotor about its axis in N m, and by how much it falls with the speed


class PortForce(NamedTuple):
    """A force (2,) in N on the first node, its derivatives (2, 2) by displacement in N/m and by velocity in N s/m."""

    force: Array
    by_displacement: Array
    by_velocity: Array


class ForceLaw(ABC):
    """How a force at a port follows the motion: a class for each kind, either with `force` or with `push`. Both are
    plain functions, compiled with the plain functions of their module that they call, which see floats, arrays and
    `math`."""

    quantity: ClassVar[str] = ""  # with which the names of its signals begin, then the name of the element
    turns: ClassVar[bool] = False  # whether it depends on the angle of the rotor
    brakes: ClassVar[bool] = False  # whether it has a torque on the rotor
    units: ClassVar[Mapping[str, str]] = {}  # of its fields in a case, e.g. "N/m"; others are plain numbers

    @property
    def numbers(self) -> Array:
        """(p,) its parameters, in SI, as `force` or `push` take them: by default the fields of the dataclass."""
        assert is_dataclass(self)
        return np.array([getattr(self, field.name) for field in fields(self)], dtype=np.float64)

    @property
    @abstractmethod
    def length(self) -> float:
        """A displacement in m over which the force changes: errors of motions are measured by it."""

    @property
    def memory(self) -> Array:
        """(w,) what an evaluation may leave for the next one to begin with, at first. No result depends on it."""
        return np.zeros(0)

    @property
    def parameters(self) -> Array:
        """(p or p + 1,) what the compiled function takes: its numbers, behind them for `push` its length."""
        return self.numbers if self.has_derivatives() else np.append(self.numbers, self.length)

    @classmethod
    def has_derivatives(cls) -> bool:
        """Whether the law is given by `force`."""
        return cls.force is not ForceLaw.force

    def plainly(self, motion: Array) -> Array:
        """(ANSWER,) force and derivatives at a motion (MOTION,) in plain Python, NaN where it cannot be computed."""
        answer = np.zeros(ANSWER)
        try:
            if self.has_derivatives():
                self.force(self.numbers, self.memory.copy(), motion, answer)
            else:
                by_differences(self.push, self, self.length, motion.tolist(), answer)
        except (ArithmeticError, ValueError):  # compiled, these are infinities and NaN
            answer[:] = np.nan
        return answer

    def inside(self, memories: Array) -> dict[str, tuple[str, Array]]:  # noqa: ARG002
        """Further signals of a run, by their quantity: unit and values (k,), from what evaluations at k moments have
        left (k, w)."""
        return {}

    @staticmethod
    def force(numbers: Any, memory: Any, motion: Any, answer: Any) -> None:
        """Fill answer (ANSWER,) with force and derivatives at a motion (MOTION,), see D_X and F_X. numbers (p,), memory
        (w,): see the properties."""
        raise NotImplementedError

    @staticmethod
    def push(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, law: Any) -> tuple[float, float]:  # noqa: ARG004
        """The force alone, F_x and F_y in N on the first node, at a displacement in m, a velocity in m/s and the speed
        of the rotor in rad/s. law: its fields. Its derivatives are central differences."""
        return math.nan, math.nan


def by_differences(push: Any, law: Any, length: float, motion: Any, answer: Any) -> None:
    """Fill answer (ANSWER,) with the force `push` and its derivatives at a motion (MOTION,), see ForceLaw. A step is
    STEP of the length, and of the velocity of a vibration of this size with the rotor."""
    d_x, d_y, v_x, v_y, omega = motion[D_X], motion[D_Y], motion[V_X], motion[V_Y], motion[SPEED]
    for i in range(ANSWER):
        answer[i] = math.nan if i < TORQUE else 0.0  # what is left where the function fails
    f_x, f_y = push(d_x, d_y, v_x, v_y, omega, law)
    for by in range(4):
        step = STEP * length * (1.0 if by < 2 else max(abs(omega), SLOW))
        a, b, c, d = step * (by == 0), step * (by == 1), step * (by == 2), step * (by == 3)
        x_above, y_above = push(d_x + a, d_y + b, v_x + c, v_y + d, omega, law)
        x_below, y_below = push(d_x - a, d_y - b, v_x - c, v_y - d, omega, law)
        place = (XX if by < 2 else V_XX) + by % 2
        answer[place], answer[place + 2] = (x_above - x_below) / (2.0 * step), (y_above - y_below) / (2.0 * step)
    answer[F_X], answer[F_Y] = f_x, f_y


class Slope(NamedTuple):
    """A port in small motions. name: of its signal; by_displacement, by_velocity: (2, 2) see PortForce."""

    name: str
    by_displacement: Array
    by_velocity: Array


@dataclass(frozen=True)
class Port:
    """A force of a machine. name: of its signal; place: (2, n) the displacement it sees; count: of equal elements that
    it represents."""

    name: str
    place: Array
    count: float
    law: ForceLaw

    def at(self, q: Array, v: Array, omega: float, angle: float = 0.0, compiled: bool = True) -> PortForce:
        """The force of one element, with displacements q and velocities v (n,) of the machine. compiled: or as plain
        Python, which needs no compiler, for plans."""
        motion = np.concatenate([self.place @ q, self.place @ v, [omega, angle]])
        if compiled:
            from frbcli.rotor.port_function import evaluate  # numba takes long to load

            answer = evaluate(self.law, motion)
        else:
            answer = self.law.plainly(motion)
        return PortForce(answer[:XX], answer[XX:V_XX].reshape(2, 2), answer[V_XX:TORQUE].reshape(2, 2))

    def along(self, q: Array, v: Array, omega: Array, angle: Array) -> tuple[Array, Array]:
        """(k, 3) N on the first node by one element and its torque on the rotor in N m, at displacements q and
        velocities v (k, n), and (k, w) what the law has left behind each."""
        from frbcli.rotor.port_function import evaluate_along  # as above

        return evaluate_along(self.law, np.column_stack([q @ self.place.T, v @ self.place.T, omega, angle]))

    def signals(self, q: Array, v: Array, omega: Array, angle: Array) -> dict[str, tuple[str, Array]]:
        """Units and values (k,) of its signals in a run, at displacements q and velocities v (k, n)."""
        forces, memories = self.along(q, v, omega, angle)
        columns = {f"{self.name}_{axis}_N": ("N", forces[:, i]) for i, axis in enumerate("xy")}
        part = self.name.removeprefix(self.law.quantity)
        for quantity, (unit, values) in self.law.inside(memories).items():
                columns[f"{quantity}{part}{unit and f'_{unit}'}"] = unit, values
        return columns


def port_forces(rotor: LinearRotor, q: Array, v: Array, omega: float, angle: float = 0.0) -> Array:
    """(n,) N on all degrees of freedom by the ports of a machine, at displacements q and velocities v (n,)."""
    forces = np.zeros(rotor.size)
    for port in rotor.ports:
        forces += port.count * port.place.T @ port.at(q, v, omega, angle).force
    return forces


def pushed(rotor: LinearRotor) -> Array:
    """(n,) displacements by which its static load pushes each port of a machine over its length."""
    pushes = np.zeros(rotor.size)
    for port in rotor.ports:
        along = port.place @ rotor.static_load
        if size := float(np.linalg.norm(along)):
            pushes += port.law.length / size * np.linalg.pinv(port.place) @ along
    return pushes


def settled(
    rotor: LinearRotor,
    omega: float,
    starts: Sequence[Array],
    rest: Callable[[LinearRotor, Array], tuple[Array, Rest]],
    step: float,
    compiled: bool = True,
) -> Rest:
    """Where a machine rests with its ports, by Newton's method: each step is the rest of the machine with their forces
    to first order about displacements (n,), by the function `rest` of that machine and these; it returns its own.

    starts: displacements that are tried in turn; step: over the length of a port, below it the machine rests; compiled:
    see Port.at. Raises NotConverged, with what `rest` has raised first.
    """
    reason: NotConverged | None = None
    for q in starts:
        moved = np.zeros(rotor.size)
        for iteration in range(ITERATIONS):
            try:
                there, position = rest(tangent(rotor, omega, q, compiled), q)
            except NotConverged as error:
                reason = reason or error
                if not moved.any():
                    break
                moved = 0.5 * moved  # a step to where a port holds nothing is too long
                q = q - moved
                continue
            moved = there - q
            if all(float(np.abs(port.place @ moved).max()) < step * port.law.length for port in rotor.ports):
                return position
            moved = moved if iteration < ITERATIONS // 2 else 0.5 * moved  # to and fro over a corner
            q = q + moved
    name = rotor.ports[0].name.replace("_", " ")
    raise reason or NotConverged(f"No static equilibrium: the {name} does not settle. Start a run in the centre.")


def tangent(rotor: LinearRotor, omega: float, q: Array, compiled: bool = True) -> LinearRotor:
    """The machine with its ports in small motions about displacements q (n,), at which it does not move: their
    stiffness and damping join its matrices, and its static load has their force there. compiled: see Port.at."""
    stiffness, damping, load, slopes = rotor.stiffness, rotor.damping, rotor.static_load, list[Slope]()
    for port in rotor.ports:
        here = port.at(q, np.zeros_like(q), omega, compiled=compiled)
        pull = port.count * port.place.T
        stiffness = stiffness - pull @ here.by_displacement @ port.place
        damping = damping - pull @ here.by_velocity @ port.place
        load = load + pull @ (here.force - here.by_displacement @ port.place @ q)
        slopes.append(Slope(port.name, here.by_displacement, here.by_velocity))
    return replace(
        rotor, stiffness=stiffness, damping=damping, static_load=load, ports=(), slopes=(*rotor.slopes, *slopes)
    )


_own: dict[str, type[ForceLaw]] = {}  # the laws of this process that were added from Python


def add_force_law(name: str, law: type[ForceLaw]) -> None:
    """Let the key `law` of a [[spring]] take a force law in this process.

    Parameters
    ----------
    name : str
        Its name in cases: small letters, digits and -. A law of the same name that was added before is replaced.
    law : type[ForceLaw]
        A dataclass on ForceLaw; its fields are the `numbers` of the [[spring]].

    Raises
    ------
    ValueError
        If the name has other characters, or the class is no such dataclass.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.add_force_law("fifth-power", FifthPower)  # doctest: +SKIP
    """
    if not _NAME.fullmatch(name):
        raise ValueError(f"{name!r}: write the name of a law with small letters, digits and -")
    if not (isinstance(law, type) and issubclass(law, ForceLaw) and is_dataclass(law)):
        raise ValueError(f"{law!r} is no dataclass on frbcli.ForceLaw")
    if not law.has_derivatives() and law.push is ForceLaw.push:
        raise ValueError(f"{law.__name__} has neither a function force nor a function push")
    _own[name] = law


def remove_force_law(name: str) -> None:
    """Remove a force law that add_force_law has added.

    Parameters
    ----------
    name : str
        Name of the law.

    Raises
    ------
    KeyError
        For any other law.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.remove_force_law("fifth-power")  # doctest: +SKIP
    """
    del _own[name]


def own_laws() -> Mapping[str, type[ForceLaw]]:
    """The laws of this process by their names."""
    return dict(_own)


def keys_of(law: type[ForceLaw]) -> dict[str, str]:
    """The fields of a law, each with its unit, "" of a plain number."""
    assert is_dataclass(law)
    return {field.name: law.units.get(field.name, "") for field in fields(law)}


def problem_of(law: ForceLaw) -> str:
    """What is wrong with the forces of a law at some motions, or nothing: before anything is computed."""
    for motion in _motions(law):
        answer = law.plainly(motion)
        if not np.all(np.isfinite(answer)):
            return f"has no finite force or derivative at {_words(motion)}"
    if not law.has_derivatives():
        return ""
    worst = ""
    for motion in _motions(law):  # a force that has a corner at one of them is not wrong
        given, differences = law.plainly(motion), np.zeros(ANSWER)
        by_differences(_law_force, law, law.length, motion, differences)
        off = [_off(given[part], differences[part]) for part in (slice(XX, V_XX), slice(V_XX, TORQUE))]
        if max(off) <= WRONG:
            return ""
        worst = f"has derivatives that differ from the force's slopes by {100 * max(off):.2g} % at {_words(motion)}"
    return worst


def fingerprint(law: ForceLaw) -> str:
    """Digest of the forces of a law to nine digits: laws of one name that differ have different ones."""
    forces = np.array([law.plainly(motion)[:XX] for motion in _motions(law)])
    size = float(np.abs(forces).max()) or 1.0
    words = " ".join(f"{value:.8e}" for value in np.round(forces / size, 9).ravel() + 0.0)
    return hashlib.sha256(f"{size:.8e} {words}".encode()).hexdigest()[:16]


def _motions(law: ForceLaw) -> list[Array]:
    found = []
    for speed in SPEEDS:
        for (d_x, d_y), (v_x, v_y) in zip(PLACES, PLACES[1:] + PLACES[:1], strict=True):
            moved = law.length * np.array([d_x, d_y]), law.length * max(speed, SLOW) * np.array([v_x, v_y])
            found.append(np.concatenate([*moved, [speed, TRIED_ANGLE]]))
    return found


def _law_force(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, law: ForceLaw) -> tuple[float, float]:
    f_x, f_y = law.plainly(np.array([d_x, d_y, v_x, v_y, omega, TRIED_ANGLE]))[:XX]
    return float(f_x), float(f_y)


def _off(given: Array, differences: Array) -> float:
    size = float(np.abs(differences).max())
    worst = float(np.abs(given - differences).max())
    return worst / size if size else (math.inf if worst else 0.0)


def _words(motion: Array) -> str:
    d_x, d_y, v_x, v_y, speed, _ = motion
    assert len(motion) == MOTION
    return f"d = ({d_x:.4g}, {d_y:.4g}) m, v = ({v_x:.4g}, {v_y:.4g}) m/s, omega = {speed:.4g} rad/s"
