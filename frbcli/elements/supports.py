"""What bearings stand on: supports, squeeze film dampers, the housing.

- Support: the shell of a bearing is a body on springs and dampers, M u'' + C u' + K u = weight + what acts on it. Film
  or coefficients act between the shaft, or the ring, and that body.
- Squeeze film damper: the shell of a bearing is a body that moves in a film, on a centring spring, without turning. The
  film is one of the machine's, between the shell and its seat; the spring acts in parallel.
- Rigid housing: it moves by q = [x, y, a, b], its centre of mass and the slopes of its axis in the planes x z and y z;
  a bearing at a distance l of the centre moves by (x + l a, y + l b).
- Elastic housing: it moves by its modes of unit modal mass, a bearing by the sum over k of u_k q_k, with

      q_k'' + 2 zeta_k omega_k q_k' + omega_k^2 q_k = sum over bearings of u_k . F.

Equal bearings of a symmetric rotor move alike: one body represents both shells, with twice their mass, stiffness and
damping, and the housing has q = [x, y] alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.case.surroundings import KEY, SYMMETRIC_PLACE, Damper, Housing, Support, shape
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.rotor.assembly import Body, Link, free_body, point_mass
from frbcli.rotor.loads import LinearPart
from frbcli.units import display


@dataclass(frozen=True)
class SupportElement(MachineElement):
    """The shell of a bearing as a body. bearing: its name."""

    bearing: str
    given: Support

    symbol: ClassVar[str] = "spring"
    besides_bearings: ClassVar[bool] = True

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for key, bearing in zip(case.bearing_keys, case.placed_bearings, strict=True):
            if bearing.support is not None:
                yield cls(f"{key}.support", bearing.name, bearing.support)

    @property
    def node(self) -> str:
        """Name of the node of the shell."""
        return f"support_{self.bearing}".rstrip("_")

    def parts(self, site: Site) -> Parts:
        mount = LinearPart.of(np.diag(self.given.stiffness), np.diag(self.given.damping))
        link = Link(self.node, site.ground(self.bearing), site.count)
        return Parts((point_mass(self.node, site.count * self.given.mass, site.gravity),), ((link, mount),))

    def plan_line(self, site: Site) -> Line:
        springs = directions(self.given.stiffness, "N/m")
        damping = f", {directions(self.given.damping, 'N*s/m')}" if any(self.given.damping) else ", undamped"
        value = f"{self.bearing}: {display(self.given.mass, 'kg')} on springs".removeprefix(": ")
        why = "the shell is a body with its weight; what acts in the bearing acts between shaft and shell"
        return "support", value, f"{springs}{damping}; {why}"


def directions(both: tuple[float, float], unit: str) -> str:
    """Quantities of x and y in words."""
    x, y = (display(each, unit) for each in both)
    return x if x == y else f"{x} in x and {y} in y"


FILM = "the shell moves without turning, and the film acts by squeezing alone"


@dataclass(frozen=True)
class DamperElement(MachineElement):
    """The shell of a bearing in a damper. bearing: its name."""

    bearing: str
    given: Damper

    symbol: ClassVar[str] = "damper"
    besides_bearings: ClassVar[bool] = True

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for key, bearing in zip(case.bearing_keys, case.placed_bearings, strict=True):
            if bearing.damper is not None:
                yield cls(f"{key}.damper", bearing.name, bearing.damper)

    @property
    def node(self) -> str:
        """Name of the node of the shell."""
        return f"shell_{self.bearing}".rstrip("_")

    @property
    def film(self) -> str:
        """The name of its film."""
        return f"{self.bearing}_damper".lstrip("_")

    def parts(self, site: Site) -> Parts:
        spring = LinearPart.of(np.diag(self.given.spring))
        return Parts((point_mass(self.node, site.count * self.given.mass, site.gravity),), ((self.link(site), spring),))

    def link(self, site: Site) -> Link:
        """The link between shell and seat on which spring and film act."""
        return Link(self.node, site.seat(self.bearing), site.count)

    def plan_line(self, site: Site) -> Line:
        value = f"{self.bearing}: {display(self.given.mass, 'kg')} in a film".removeprefix(": ")
        spring = "no centring spring: it sinks under a static load"
        if any(self.given.spring):
            spring = f"centring spring {directions(self.given.spring, 'N/m')}, which carries the static load"
            spring += ", the shell in the centre" if self.given.centred else ""
        return "damper", value, f"{spring}; {FILM}"


NODE = "housing"  # the centre of mass, or all of the housing of a symmetric rotor


@dataclass(frozen=True)
class HousingElement(MachineElement):
    """The housing. bearings: names and positions of what it carries, none of a symmetric rotor."""

    given: Housing
    bearings: tuple[tuple[str, float], ...]

    besides_bearings: ClassVar[bool] = True

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        if case.housing is not None:
            places = () if case.rotor.symmetric else case.placed_bearings
            yield cls(KEY, case.housing, tuple((bearing.name, bearing.position or 0.0) for bearing in places))

    def node(self, bearing: str) -> str:
        """The node that a bearing stands on, by its name."""
        return f"{NODE}_{bearing}" if self.bearings else NODE

    def parts(self, site: Site) -> Parts:
        return Parts(bodies=(self._modal(site.gravity) if self.given.modes else self._rigid(site.gravity),))

    def plan_line(self, site: Site) -> Line:
        if self.given.modes:
            frequencies = ", ".join(f"{mode.frequency:.4g}" for mode in self.given.modes)
            weight = "its weight at its masses" if self.given.masses else "without its weight, for no masses are given"
            return "housing", f"{len(self.given.modes)} modes", f"{frequencies} Hz; carries all bearings; {weight}"
        mass, count = display(self.given.mass or 0.0, "kg"), len(self.given.mounts)
        tilts = "moves and tilts" if self.bearings else "moves, and does not tilt with a symmetric rotor"
        mounts = f"{count} mounts" if count > 1 else "one mount"
        return "housing", f"{mass} on {mounts}", f"a rigid body that {tilts}, with its weight; carries all bearings"

    def _rigid(self, gravity: float) -> Body:
        given = self.given
        mass, inertia = given.mass or 0.0, given.inertia or (0.0, 0.0)
        size = 4 if self.bearings else 2

        def at(position: float | None) -> Array:
            """(2, size) displacement there."""
            arm = (position or 0.0) - (given.position or 0.0)
            return np.hstack([np.eye(2), arm * np.eye(2)])[:, :size]

        tilts = np.array([[0.0, 0.0, 0.0, -1.0], [0.0, 0.0, 1.0, 0.0]])[:, :size]  # about x by -b, about y by a

        stiffness, damping = np.zeros((2, size, size))
        for mount in given.mounts:
            place = at(mount.position)
            stiffness += place.T @ np.diag(mount.stiffness) @ place
            damping += place.T @ np.diag(mount.damping) @ place
        carried = mass * np.eye(2, size)
        places = ((NODE, given.position), *((self.node(name), place) for name, place in self.bearings))
        nodes = tuple((name, np.vstack([at(place), tilts])) for name, place in places)
        return free_body(np.diag([mass, mass, *inertia][:size]), nodes, gravity, carried, damping, stiffness)

    def _modal(self, gravity: float) -> Body:
        modes = self.given.modes
        shapes = [shape(mode) for mode in modes]
        omega = 2.0 * math.pi * np.array([mode.frequency for mode in modes])
        damping = np.diag(2.0 * np.array([mode.damping for mode in modes]) * omega)

        def at(place: str) -> Array:
            """(2, modes) displacement there."""
            return np.array([each.get(place, (0.0, 0.0)) for each in shapes]).T

        masses = [each.mass * at(each.place) for each in self.given.masses]
        carried = sum(masses, np.zeros((2, len(modes)))) if masses else None
        nodes = tuple((self.node(name), at(name)) for name, _ in self.bearings or ((SYMMETRIC_PLACE, 0.0),))
        return free_body(np.eye(len(modes)), nodes, gravity, carried, damping, np.diag(omega**2))
