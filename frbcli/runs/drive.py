"""How the rotor turns in a run: by the profile of its speed, or freely by its drive; what the time loop needs for the
latter, and its signals."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from frbcli.arrays import Array
from frbcli.case.course.drive import GOVERNED
from frbcli.case.schema import Case
from frbcli.results.columns import DRIVE_SIGNALS, FRICTION_SIGNAL
from frbcli.rotor.loads import LinearPart, SpeedProfile
from frbcli.scene.machine.system import System
from frbcli.scene.shafts.table import shaft_of
from frbcli.solve.drive import NOW, DrivenRotor, driving_along
from frbcli.solve.state import SLIP, TIME, State

SLOW = 1e-9  # share of the highest speed of a run that counts as standstill
TURN = 2.0 * math.pi
TORQUE, POWER = (column.name for column in DRIVE_SIGNALS)


class Rotation(Protocol):
    """How the rotor turns at k output times."""

    @property
    def speeds(self) -> Array:
        """(k,) rad/s."""
        ...

    @property
    def states(self) -> Array:
        """(3, k) angular acceleration in rad/s^2, speed in rad/s and angle in rad."""
        ...


@dataclass(frozen=True)
class GivenRotation:
    """Along a profile, at times (k,) in s."""

    profile: SpeedProfile
    times: Array

    @property
    def speeds(self) -> Array:
        """See Rotation."""
        return self.profile.speed(self.times)

    @property
    def states(self) -> Array:
        """See Rotation."""
        return np.array([self.profile.rotation(float(t)) for t in self.times]).reshape(-1, 3).T


@dataclass(frozen=True)
class FreeRotation:
    """By columns (k,) of its degree of freedom: angle, speed, and acceleration where the run notes it."""

    angles: Array
    speeds: Array
    accelerations: Array

    @property
    def states(self) -> Array:
        """See Rotation."""
        return np.array([self.accelerations, self.speeds, self.angles])


def rotation_at(system: System, profile: SpeedProfile, times: Array, q: Array, v: Array, noted: Array) -> Rotation:
    """The rotation at output times (k,) in s, with the motion q, v and what is noted (k, ...) of Samples."""
    place = system.rotation
    if place is None:
        return GivenRotation(profile, times)
    return FreeRotation(q[:, place].copy(), v[:, place].copy(), noted[:, place] if noted.size else np.zeros(len(times)))


def rotation_of(system: System, profile: SpeedProfile, state: State) -> tuple[float, float, float]:
    """Angular acceleration, speed and angle of the rotor in a state, rad and s."""
    place = system.rotation
    if place is None:
        return profile.rotation(float(state.numbers[TIME]))
    return float(state.a[place]), float(state.v[place]), float(state.q[place])


def loop_drive(case: Case, system: System) -> DrivenRotor | tuple[()]:
    """The drive of a case as the time loop takes it."""
    drive, place = case.drive, system.rotation
    if drive is None or place is None:
        return ()
    points, unit = np.array([[0.0, 1.0], [drive.torque, drive.torque]]), 1.0
    over_time = drive.points is not None and drive.points.over == "time"
    if drive.points is not None:
        unit = 1.0 if over_time else TURN
        points = np.array([drive.points.at, drive.points.torque])
    highest = math.inf if drive.end is None else TURN * drive.end
    return DrivenRotor(
        place,
        case.polar_inertia,
        points * [[unit], [1.0]],
        over_time,
        drive.duration,
        (highest if drive.end is None else (1.0 - GOVERNED) * highest, highest),
        np.array([drive.load.constant, drive.load.linear, drive.load.square]),
        _thrust(case),
        _internal(case),
        drive.reaction,
        _weight(case) if drive.reaction else (0.0, 0.0),
        SLOW * TURN * max(case.speed.start, case.speed.end),
        np.zeros(NOW),
    )


def _thrust(case: Case) -> Array:
    """(2, k) speeds in rad/s with the torques in N m that a thrust bearing under the axial load has at rest there."""
    if not case.loads_a_collar:
        return np.zeros((2, 1))
    from frbcli.elements.collar import collar_of, rests_over_speed  # films on pads take a second to import

    collar = collar_of(case)
    rests = () if collar is None else rests_over_speed(collar)
    return np.array([[0.0, 0.0], *([rest.omega, rest.torque] for rest in rests)]).T.copy()


def _internal(case: Case) -> Array:
    """(2, m, m): see DrivenRotor."""
    damping = shaft_of(case).body().internal
    if damping is None:
        return np.zeros((2, 0, 0))
    turning, fixed, _ = LinearPart.turning(damping).at(1.0)
    return np.array([fixed, -turning])


def _weight(case: Case) -> tuple[float, float]:
    """N m: what the weight of the unbalance turns the rotor with, times the cosine and the sine of its angle."""
    body = shaft_of(case).body()
    if body.inertia is None:
        return 0.0, 0.0
    lifted = case.rotor.gravity * np.linalg.solve(body.mass, body.inertia[1])
    return float(lifted @ body.unbalance_cos), float(lifted @ body.unbalance_sin)


def begin_to_turn(case: Case, system: System, state: State) -> None:
    """Give a state at the start of a run the speed of its drive, and the acceleration but for the friction of films,
    which the first step of 1e-7 s finds."""
    drive, place = case.drive, system.rotation
    if drive is not None and place is not None:
        state.v[place] = TURN * drive.start
        state.a[place] = drive.net(0.0, TURN * drive.start)[0] / case.polar_inertia


def drive_signals(drive: DrivenRotor | tuple[()], times: Array, speeds: Array) -> dict[str, Array]:
    """Torque and power of the drive at times (k,) in s and speeds (k,) in rad/s; nothing without one."""
    if not drive:
        return {}
    torques = np.empty(len(times))
    driving_along(drive, times, speeds, torques)
    return {TORQUE: torques, POWER: torques * speeds}


def drive_units(system: System) -> dict[str, str]:
    """Names and units of the signals of a drive."""
    recorded = () if system.rotation is None else DRIVE_SIGNALS
    return {column.name: column.unit for column in (*recorded, *((FRICTION_SIGNAL,) if brakes(system) else ()))}


def brakes(system: System) -> bool:
    """Whether a run records the torque with which films brake a rotor whose speed is free: films that follow its tilt
    are not noted."""
    return system.rotation is not None and bool(system.names) and system.films.stations == 1


def friction_signal(system: System, torques: Array) -> dict[str, Array]:
    """The torque (k,) with which all films brake a rotor whose speed is free; torques: (k, films) on the journals of
    one bearing each."""
    if system.rotation is None:
        return {}
    on_rotor = (system.bodies[:, 0] < 0) & (system.turning[:, SLIP, 0] > 0.0)
    return {FRICTION_SIGNAL.name: -torques @ (system.rotor.multiplicity * on_rotor)}
