"""The developed gap of one section: its size, where the pressure is given, what happens at its ends (section 4.1).

A bearing in operation: strains of its parts, its warm gap, Reynolds and Sommerfeld number.

Strains are the displacement of a surface over its radius, in the plane stress state of table A.2. Temperatures are
differences to the temperatures at which the parts were measured, in K.
"""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from frbcli.arrays import Array
from frbcli.materials import Solid

Displacement = tuple[float, float] | tuple[Array, Array]  # x, y over the clearance; along the axis if it tilts
Edge = str  # "oil-bath" | "free-to-air" | "groove" | "symmetry"
OPEN_ENDS = ("oil-bath", "free-to-air")
CLOSED = 1e-7  # share of the flow of an open end that counts as none: the limit of tight seals
NO_BATH = -1.0
ON_EDGE = 1e-9  # rad by which an angle may miss the edge of a lobe, or two edges each other
SAMPLES = 3601
MOST_CORNERS = 24  # of a profile whose points are corners
LEAST = 2  # cells between two edges
LARGEST_ECCENTRICITY = 0.9999  # end of the tables


@dataclass(frozen=True)
class AxialGroove:
    """A groove over the whole width: phi of its middle, opening angle, both rad; gauge pressure in the middle, Pa.

    The pressure falls to ambient at the ends of the bearing by (6.2). """

    position: float
    opening: float
    pressure: float


@dataclass(frozen=True)
class Hole:
    """A bore or pocket, at a gauge pressure in Pa.

    position, axial: of its middle, phi in rad and m from the end z = 0; half_angle, half_width: half extents in rad
    and m; round: an ellipse in the developed gap, else a rectangle; through: it goes through the body around the film,
    else it is a recess.
    """

    position: float
    axial: float
    half_angle: float
    half_width: float
    pressure: float = 0.0
    round: bool = False
    through: bool = False


class ShellProfile(ABC):
    """The inner surface of a shell that is no cylinder. Section.clearance is the gap of the centred journal where it is
    narrowest, or nearly."""

    key: ClassVar[str]  # of a film in a case file

    @property
    @abstractmethod
    def words(self) -> str:
        """What it is, as `3 lobes`."""

    @abstractmethod
    def plan_entry(self, clearance: float) -> tuple[str, str]:
        """Its value and reason in a plan, of a film with a clearance in m."""

    @property
    def fault(self) -> tuple[str, str]:
        """What is wrong with it, and the remedy."""
        return "", ""

    @property
    @abstractmethod
    def edges(self) -> tuple[float, ...]:
        """phi in rad of its corners, where faces of cells have to lie."""

    @abstractmethod
    def depth(self, phi: Array) -> Array:
        """H of the centred journal at the angles phi (n,) without the 1 of a cylinder."""


@dataclass(frozen=True)
class LobedShell(ShellProfile):
    """Equal arcs of the shell, each bored with a larger radius than the journal needs, around a centre of its own.

    With the clearance c_b of the centred journal at the narrowest place of a lobe and the machined clearance c_p of its
    bore the preload is m = 1 - c_b / c_p. Section.clearance is c_b. position: phi of the middle of the first lobe, rad;
    offset: where a lobe is narrowest, as a share of its arc from its start, counter-clockwise.
    """

    count: int
    preload: float
    position: float
    offset: float = 0.5

    key: ClassVar[str] = "lobes"

    @property
    def words(self) -> str:
        return f"{self.count} lobes"

    def plan_entry(self, clearance: float) -> tuple[str, str]:
        machined = 1e6 * clearance / (1.0 - self.preload)
        reason = f"clearance {1e6 * clearance:.4g} um where they are narrowest, {machined:.4g} um of their bores"
        return f"{self.words}, preload {self.preload:g}", reason

    @property
    def fault(self) -> tuple[str, str]:
        if self.count >= 1 and 0.0 <= self.preload < 1.0:
            return "", ""
        problem = f"{self.count:g} lobes with a preload of {self.preload:g}"
        return problem, "The preload must be at least 0 and less than 1."

    @property
    def arc(self) -> float:
        """Angle of one lobe in rad."""
        return 2.0 * math.pi / self.count

    @property
    def start(self) -> float:
        """phi at which the first lobe begins."""
        return self.position - 0.5 * self.arc

    @property
    def edges(self) -> tuple[float, ...]:
        return tuple(self.start + i * self.arc for i in range(self.count))

    def depth(self, phi: Array) -> Array:
        """m / (1 - m) (1 - cos(phi - phi_l)), phi_l being where the lobe is narrowest. An edge between two lobes
        belongs to the one that begins there."""
        within = np.mod(phi - self.start + ON_EDGE, self.arc) - ON_EDGE
        return np.asarray(self.preload / (1.0 - self.preload) * (1.0 - np.cos(within - self.offset * self.arc)))


@dataclass(frozen=True)
class TabledShell(ShellProfile):
    """A shell as a table over the angle, linear in between: angles, phi in rad, rising over one turn; depths: H of the
    centred journal there without 1."""

    angles: tuple[float, ...]
    depths: tuple[float, ...]

    key: ClassVar[str] = "profile"

    @property
    def words(self) -> str:
        return f"a profile of {len(self.angles)} points"

    def plan_entry(self, clearance: float) -> tuple[str, str]:
        least, most = (1e6 * clearance * (1.0 + f(self.depths)) for f in (min, max))
        return self.words, f"gaps of {least:.4g} to {most:.4g} um around the centred journal"

    @property
    def edges(self) -> tuple[float, ...]:
        """The corners of a drawn profile. Points of a measured one are many, and lie closer than cells."""
        return self.angles if len(self.angles) <= MOST_CORNERS else ()

    def depth(self, phi: Array) -> Array:
        return np.asarray(np.interp(phi, self.angles, self.depths, period=2.0 * math.pi))


@dataclass(frozen=True)
class Diffusion:
    """Artificial diffusion (4.42) of the published two-phase form. length: L of an element around, rad; along: whether
    it acts along the axis, too."""

    length: float
    along: bool


@dataclass(frozen=True)
class FeedHole:
    """An opening of a channel: the number of the film, and a hole of its section."""

    film: int
    hole: Hole


@dataclass(frozen=True)
class Channel:
    """A bore between two films. inner, outer: its feed holes, the outer one None where it opens to a groove of a gauge
    pressure in Pa; resistance in Pa s / m^3; centrifugal: in Pa s^2, see CHANNEL."""

    inner: FeedHole
    outer: FeedHole | None
    resistance: float
    groove_pressure: float
    centrifugal: float


def channel_resistance(diameter: float, length: float, viscosity: float) -> float:
    """Pa s / m^3 of laminar flow through a round bore (Hagen and Poiseuille); m, m, Pa s."""
    return 128.0 * viscosity * length / (math.pi * diameter**4)


@dataclass(frozen=True)
class Section:
    """One rectangular section of a film, SI units; pressures are gauge, over the ambient pressure.

    width: b of the section; copies: how many equal ones make the bearing; near, far: its edges at z = 0 and z = 1;
    far_pressure: in the groove at the far edge; bearing_width: the whole B, for (6.2); sealed: share of the flow of an
    open end that the ends let out, 1 without seals; largest_flow: of a flow-limited supply, m^3/s; flow_roughness: of
    both surfaces in m, which the flow follows, 0 of smooth ones; shear: by which the journal's share of its square
    exceeds the shell's, -1 to 1; bath: height of the oil at free ends over the middle of the shell, over its radius, -1
    without any. """

    radius: float
    width: float
    bearing_width: float
    clearance: float
    viscosity: float
    ambient_pressure: float
    cavitation_pressure: float
    copies: int
    near: Edge
    far: Edge
    far_pressure: float = 0.0
    grooves: tuple[AxialGroove, ...] = ()
    holes: tuple[Hole, ...] = field(default=())
    profile: ShellProfile | None = None
    sealed: float = 1.0
    largest_flow: float = math.inf
    flow_roughness: float = 0.0
    shear: float = 0.0
    bath: float = NO_BATH
    diffusion: Diffusion | None = None

    @property
    def seals(self) -> tuple[float, float]:
        """Resistance of the ends z = 0 and z = 1, as the length of a land over the width, 0 without a seal.

        With the land L between an end and a groove, or the middle, a film of constant gap that is fed there lets out
        the share s through a seal that is worth L (1 / s - 1).
        """
        land = self.width if self.far == "groove" else 0.5 * self.bearing_width
        each = land / self.width * (1.0 / max(self.sealed, CLOSED) - 1.0)
        return each, each if self.far in OPEN_ENDS else 0.0

    @property
    def pressure_scale(self) -> float:
        """12 eta / psi^2: turns a scaled pressure (1/s) into Pa, see (3.9)."""
        return 12.0 * self.viscosity * (self.radius / self.clearance) ** 2

    @property
    def area(self) -> float:
        """R b times the number of sections, m^2."""
        return self.copies * self.radius * self.width

    @property
    def force_scale(self) -> float:
        """R b times pressure_scale times the number of sections, N s, see (3.13)."""
        return self.area * self.pressure_scale

    @property
    def flow_scale(self) -> float:
        """R b C times the number of sections, m^3: turns a scaled flow (1/s) of a section into m^3/s of the bearing."""
        return self.area * self.clearance

    @property
    def aspect(self) -> float:
        """(R/b)^2 of (3.9)."""
        return (self.radius / self.width) ** 2


def whole_width(section: Section) -> Section:
    """The section over the whole width of the bearing, unless a groove divides it: films made of rectangles are solved
    on it, without a plane of symmetry."""
    if section.far == "groove":
        return section
    whole = section.copies * section.largest_flow
    return replace(section, width=section.bearing_width, copies=1, far=section.near, largest_flow=whole)


def ends_at_ambient(section: Section) -> Section:
    """The section with its free ends at the ambient pressure, for models that know no oil that is missing there."""
    near, far = ("oil-bath" if edge == "free-to-air" else edge for edge in (section.near, section.far))
    return replace(section, near=near, far=far)


def gap_height(section: Section, d: Displacement, phi: Array) -> Array:
    """H at the angles phi (n,) for the displacement d over the clearance: (4.4), with the depth of a profile

    H = 1 + depth(phi) + d_x sin(phi) - d_y cos(phi).
    """
    plain: Array = 1.0 + d[0] * np.sin(phi) - d[1] * np.cos(phi)
    return plain if section.profile is None else plain + section.profile.depth(phi)


def gap_rate(v: Displacement, phi: Array) -> Array:
    """dH/dt in 1/s at the angles phi (n,) for the velocity v over the clearance."""
    return np.asarray(v[0] * np.sin(phi) - v[1] * np.cos(phi), dtype=np.float64)


def smallest_gap(section: Section, d: tuple[float, float]) -> float:
    """The least H over the turn."""
    if section.profile is None:
        return 1.0 - math.hypot(*d)
    return float(gap_height(section, d, np.linspace(-np.pi, np.pi, SAMPLES)).min())


SUPPLY_LENGTH = 0.1  # z_1 of (6.2): share of the bearing's width over which a groove's pressure rises from its end


def groove_pressure(section: Section, groove: AxialGroove, distance: Array) -> Array:
    """Gauge pressure in an axial groove at the distance (n,) in m from the nearer end of the bearing, (6.2); it falls
    less towards an end that lets out a share of the flow alone."""
    falls = np.exp(-distance / (SUPPLY_LENGTH * section.bearing_width))
    return groove.pressure * (1.0 - section.sealed * falls)


def graded_ring(elements: int, narrowest: float, contraction: float, breaks: Array, exact: bool = False) -> Array:
    """(n + 1,) boundaries of cells over one turn from the first break (or -pi), denser around phi = narrowest.

    breaks: angles that must be boundaries (edges of grooves). The density follows Sommerfeld's angle: ring_vertices.
    Each piece has its share of the elements, rounded, and LEAST at least; exact: n is the number of elements, or as
    many as the pieces need at least.
    """
    gamma = np.linspace(-np.pi, np.pi, 20_001)
    angle = narrowest + 2.0 * np.arctan2(contraction * np.sin(0.5 * gamma), np.cos(0.5 * gamma))
    cuts = _apart(np.sort(np.mod(breaks - angle[0], 2 * np.pi)) + angle[0]) if len(breaks) else angle[:1]
    turn = np.append(cuts, cuts[0] + 2 * np.pi)
    # gamma over one and a half turns, so that pieces may start anywhere
    long_angle = np.concatenate([angle[:-1], angle + 2 * np.pi])
    long_gamma = np.concatenate([gamma[:-1], gamma + 2 * np.pi])
    places = np.interp(turn, long_angle, long_gamma)
    shares = [elements * (end - start) / (2 * math.pi) for start, end in itertools.pairwise(places)]
    counts = [max(LEAST, round(share)) for share in shares]
    if exact:
        _add_up(counts, shares, elements)
    pieces = []
    for (start, end), count in zip(itertools.pairwise(places), counts, strict=True):
        pieces.append(np.interp(np.linspace(start, end, count + 1)[:-1], long_gamma, long_angle))
    pieces.append(turn[-1:])
    return np.concatenate(pieces)


def _add_up(counts: list[int], shares: list[float], total: int) -> None:
    """Change counts, where they are furthest from their shares, until they add up to a total that leaves each LEAST."""
    total = max(total, LEAST * len(counts))
    while (missing := total - sum(counts)) != 0:
        sign = 1 if missing > 0 else -1
        # pieces that are equal but for round-off are taken in their order
        off = [round(sign * (share - count), 6) for count, share in zip(counts, shares, strict=True)]
        open_ones = [i for i, count in enumerate(counts) if sign > 0 or count > LEAST]
        counts[max(open_ones, key=off.__getitem__)] += sign


def _apart(cuts: Array) -> Array:
    """The sorted angles (n,) within a turn without those that coincide with the one before."""
    turn = np.append(cuts[-1] - 2 * np.pi, cuts)
    kept = cuts[np.diff(turn) > ON_EDGE]
    return kept if len(kept) else cuts[:1]


LAMINAR_BELOW = 2300.0  # (3.3)
RING_SPEED = 0.3  # of the rotor's, by table A.1: what a floating ring reaches at most


def reynolds_number(density: float, omega: float, radius: float, clearance: float, viscosity: float) -> float:
    """Re (3.3) of a film, with omega = omega_J + omega_S in rad/s, all in SI. Laminar below LAMINAR_BELOW."""
    return density * abs(omega) * radius * clearance / viscosity


def sommerfeld_number(
    force: float, width: float, radius: float, clearance: float, viscosity: float, omega: float
) -> float:
    """So (3.14) of a whole bearing, with omega = omega_J + omega_S in rad/s, all in SI; NaN where nothing turns."""
    shear = 2.0 * radius * width * viscosity * abs(omega)
    return (clearance / radius) ** 2 * force / shear if shear > 0.0 else math.nan


def friction_coefficient(torque: float, force: float, radius: float) -> float:
    """mu = |T| / (R F) of the torque on the journal in N m, the load in N and the radius in m; NaN without a load."""
    return abs(torque) / (radius * force) if force > 0.0 else math.nan


def shaft_rotation_strain(solid: Solid, omega: float, radius: float) -> float:
    """Strain of the surface of a solid shaft with a radius in m that turns with omega in rad/s."""
    return 0.25 * solid.density * (omega * radius) ** 2 * (1.0 - solid.poisson) / solid.modulus


def ring_rotation_strains(solid: Solid, omega: float, inner: float, outer: float) -> tuple[float, float]:
    """Strains of the inner and the outer surface of a ring with these radii in m that turns with omega in rad/s."""
    scale = 0.25 * solid.density * omega**2 / solid.modulus
    near, across = 1.0 - solid.poisson, 3.0 + solid.poisson
    return scale * (across * outer**2 + near * inner**2), scale * (near * outer**2 + across * inner**2)
