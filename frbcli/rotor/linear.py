"""The machine without its films, as one linear system: assembled of bodies, see assembly.py.

M q'' + (D + Omega G) q' + K q = f_static + unbalance(alpha) + sum over films of P^T F

Elements whose forces are linear are part of M, D and K; where their coefficients depend on the speed, `over_speed`
holds what they add to the matrices, and `at` gives the rotor at a speed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.rotor.loads import BOW, Harmonic, LinearPart, Load, summed
from frbcli.rotor.port import Port, Slope


@dataclass(frozen=True)
class LinearRotor:
    """A machine with n degrees of freedom: a rotor, its rings and whatever else moves. SI units.

    mass, damping, gyroscopic, stiffness: (n, n); gyroscopic is multiplied by the rotor speed in rad/s. static_load:
    (n,) N. unbalance_cos, unbalance_sin: (n,) kg m: the unbalance pulls (2.3) with unbalance_cos (alpha'' cos alpha -
    alpha'^2 sin alpha) + unbalance_sin (alpha'' sin alpha + alpha'^2 cos alpha). journals: (films, c, n): P, the first
    c of the COORDINATES of each film's journal relative to its shell: x and y, and its tilts where films see them.
    multiplicity: (films,) how many equal bearings one film represents (2 in a symmetric rotor). points: names and (2,
    n) maps of the points that a run records and whose error is controlled. over_speed: what elements add to mass,
    damping and stiffness at a speed, None where nothing depends on it. loads: what else acts on it, and changes with
    the angle of the rotor or with time. cones: of bodies that turn by themselves and tilt, cartridges: each with the
    degree of freedom of its angle, and (2, n) its slopes in x and y times the root of its polar inertia: its gyroscopic
    moments pull with -(C^T J C) q' times its speed, J = [[0, 1], [-1, 0]]. ports: forces that are not linear; only
    `tangent` puts them into the matrices, and notes them as slopes. turning: degrees of freedom of rings that turn
    while it moves in small: on their angles nothing depends, on their speeds the films. """

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    static_load: Array
    unbalance_cos: Array
    unbalance_sin: Array
    journals: Array
    multiplicity: Array
    points: tuple[tuple[str, Array], ...]
    over_speed: LinearPart | None = None
    loads: tuple[Load, ...] = ()
    cones: tuple[tuple[int, Array], ...] = ()
    turning: tuple[int, ...] = ()
    ports: tuple[Port, ...] = ()
    slopes: tuple[Slope, ...] = ()

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return len(self.mass)

    @property
    def unbalance(self) -> NDArray[np.complex128]:
        """(n,) kg m: at a constant speed Omega the unbalance pulls with Re(Omega^2 unbalance exp(i alpha))."""
        return np.asarray(self.unbalance_sin + 1j * self.unbalance_cos)

    @property
    def bent(self) -> NDArray[np.complex128]:
        """(n,) N: the forces by the bow are Re(bent exp(i alpha))."""
        bows = (load for load in self.loads if isinstance(load, Harmonic) and load.name == BOW)
        return sum((load.excitation(0.0)[1] for load in bows), np.zeros(self.size, dtype=np.complex128))

    def at(self, omega: float) -> LinearRotor:
        """The rotor at omega rad/s, with matrices that do not depend on the speed any more, but for the gyroscopic
        term."""
        if self.over_speed is None:
            return self
        stiffness, damping, mass = self.over_speed.at(omega)
        return replace(
            self,
            mass=self.mass + mass,
            damping=self.damping + damping,
            stiffness=self.stiffness + stiffness,
            over_speed=None,
        )

    def precession(self, speeds: Array) -> Array:
        """(n, n) what multiplies q' in addition to the damping, by the cones, at speeds (n,) of the angles in rad/s."""
        matrix = np.zeros_like(self.damping)
        for spin, cone in self.cones:
            matrix += speeds[spin] * (np.outer(cone[0], cone[1]) - np.outer(cone[1], cone[0]))
        return matrix

    def with_parts(self, parts: Sequence[LinearPart]) -> LinearRotor:
        """The rotor with linear parts on all of its degrees of freedom: constant ones join its matrices."""
        stiffness, damping, mass = self.stiffness, self.damping, self.mass
        for part in parts:
            if part.constant:
                stiffness, damping, mass = (
                    mine + more[0]
                    for mine, more in ((stiffness, part.stiffness), (damping, part.damping), (mass, part.mass))
                )
        own = () if self.over_speed is None else (self.over_speed,)
        changing = [*own, *(part for part in parts if not part.constant)]
        return replace(self, stiffness=stiffness, damping=damping, mass=mass, over_speed=summed(changing))


Real = TypeVar("Real", float, Array)


def unbalance_shares(alpha: Real, omega: Real, sine: Real, cosine: Real) -> tuple[Real, Real]:
    """What multiplies unbalance_cos and unbalance_sin in the force of the unbalance (2.3), 1/s^2, at the angular
    acceleration alpha and the speed omega of the rotor; sine and cosine: of its angle."""
    return alpha * cosine - omega**2 * sine, alpha * sine + omega**2 * cosine


def with_precession(rotor: LinearRotor, speeds: Array) -> LinearRotor:
    """The machine with the gyroscopic moments of its rings, which turn with speeds (rings,) in rad/s."""
    if not rotor.cones:
        return rotor
    turning = np.concatenate([np.zeros(rotor.size - len(speeds)), speeds])
    return replace(rotor, damping=rotor.damping + rotor.precession(turning), cones=())


def without_spins(rotor: LinearRotor, speeds: Array) -> LinearRotor:
    """The machine without its last degrees of freedom, the angles of its rings, which keep their speeds (rings,) in
    rad/s."""
    if len(speeds) == 0:
        return rotor
    rotor, kept = with_precession(rotor, speeds), np.arange(rotor.size - len(speeds))
    square = np.ix_(kept, kept)
    return replace(
        rotor,
        mass=rotor.mass[square],
        damping=rotor.damping[square],
        gyroscopic=rotor.gyroscopic[square],
        stiffness=rotor.stiffness[square],
        static_load=rotor.static_load[kept],
        unbalance_cos=rotor.unbalance_cos[kept],
        unbalance_sin=rotor.unbalance_sin[kept],
        journals=rotor.journals[:, :, kept],
        points=tuple((name, place[:, kept]) for name, place in rotor.points),
        over_speed=None if rotor.over_speed is None else rotor.over_speed.cut(kept),
        loads=tuple(load.cut(kept) for load in rotor.loads),
        ports=tuple(replace(port, place=port.place[:, kept]) for port in rotor.ports),
    )
