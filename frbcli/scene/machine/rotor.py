"""The machine of a case without its films: shaft, rings and elements as one linear system.

The elements have parts of the machine, springs and faults, and lines of the plan.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.case.bearing import FloatingRingBearing, GivenBearing
from frbcli.case.schema import Case
from frbcli.elements.ball import BallBearingElement
from frbcli.elements.coefficients import GivenCoefficients
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.elements.supports import DamperElement, HousingElement, SupportElement
from frbcli.elements.table import elements_of
from frbcli.elements.thrust import COLLAR
from frbcli.errors import Fault
from frbcli.rotor.assembly import (
    GROUND,
    PLANE,
    Body,
    LinearRotor,
    Link,
    assembled,
    point_mass,
    preset,
    spin,
    tilting_mass,
    tilting_ring,
)
from frbcli.rotor.loads import Harmonic, Tabulated
from frbcli.rotor.port import ForceLaw
from frbcli.scene.films import turning_rings
from frbcli.scene.machine.turbocharger import shaft_of


def site_of(case: Case) -> Site:
    """The machine around the elements of a case."""
    shaft = shaft_of(case)
    shells = {each.bearing: each.node for each in DamperElement.of(case)}
    supports = {each.bearing: each.node for each in SupportElement.of(case)}
    housing = next(HousingElement.of(case), None)

    def ground(bearing: str) -> str:
        return GROUND if housing is None else housing.node(bearing)

    def seat(bearing: str) -> str:
        return supports.get(bearing, ground(bearing))

    return Site(
        journal=shaft.journal,
        shell=lambda bearing: shells.get(bearing, seat(bearing)),
        seat=seat,
        ground=ground,
        count=float(shaft.equal_bearings),
        gravity=case.rotor.gravity,
    )


def element_parts(case: Case) -> Parts:
    """What all elements of a case add to the machine."""
    site = site_of(case)
    added = [element.parts(site) for element in elements_of(case)]
    return Parts(
        bodies=tuple(body for parts in added for body in parts.bodies),
        links=tuple(link for parts in added for link in parts.links),
        forces=tuple(force for parts in added for force in parts.forces),
        loads=tuple(load for parts in added for load in parts.loads),
        ports=tuple(port for parts in added for port in parts.ports),
    )


def harmonics_of(case: Case) -> tuple[Harmonic, ...]:
    """The harmonic loads of a case besides the unbalance, each on the x and y of its place."""
    return tuple(load for _, load in element_parts(case).loads if isinstance(load, Harmonic))


def tables_of(case: Case) -> tuple[Tabulated, ...]:
    """The loads of a case that are given over time."""
    return tuple(load for _, load in element_parts(case).loads if isinstance(load, Tabulated))


def stray_load_faults(case: Case) -> Iterator[Fault]:
    """The faults of loads that do not repeat with the revolutions of the rotor."""
    site = site_of(case)
    for element in elements_of(case):
        for node, load in element.parts(site).loads:
            if load.strays:
                value = node.replace("_", " ") or load.name
                yield Fault(element.key, value, None, f"{load.strays}.", "Remove it, or take a run-up.")


def port_faults(
    case: Case, problem: str, remedy: str, of: Callable[[ForceLaw], bool] = lambda _: True
) -> Iterator[Fault]:
    """The faults of forces that are not linear, where an analysis does not have them. of: whether it has not a law."""
    site = site_of(case)
    for each in elements_of(case):
        if any(of(law) for _, _, law in each.parts(site).ports):
            yield Fault(each.key, "", None, problem, remedy)


def table_faults(case: Case, begin: float, end: float) -> Iterator[Fault]:
    """The faults of tables over time that do not last from begin to end of a run, in s."""
    site = site_of(case)
    for element in elements_of(case):
        for _, load in element.parts(site).loads:
            if isinstance(load, Tabulated):
                yield from span_faults(f"{element.key}.file", load.name, load.times, begin, end)


def span_faults(key: str, named: str, times: Sequence[float] | Array, begin: float, end: float) -> Iterator[Fault]:
    """The faults of a table whose times in s do not last from begin to end of a run."""
    if times[0] > begin:
        problem = f"has a table that begins at {times[0]:.9g} s, and the run begins at {begin:g} s."
        yield Fault(key, named, None, problem, "Begin the table with the run.")
    if times[-1] < end:
        problem = f"has a table that ends at {times[-1]:.9g} s, and the run ends at {end:.9g} s."
        yield Fault(key, named, None, problem, "Lengthen the table, or end the run before.")


def table_times(case: Case) -> Array:
    """The times in s of all rows of the tables over time of a case."""
    return np.unique(np.concatenate([np.zeros(0), *(load.times for load in tables_of(case))]))


def element_forces(
    case: Case, rotor: LinearRotor, omega: float, frequency: float, q: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """(e, 2) complex amplitudes in N of the forces of the bearings without a film on the shaft, of one each. rotor: of
    the case, at omega rad/s; q: (n,) complex amplitudes of its motion with a frequency in rad/s."""
    site, nodes = site_of(case), dict(rotor.points)
    slopes = {slope.name: slope for slope in rotor.slopes}

    def motion(link: Link) -> NDArray[np.complex128]:
        outside = 0.0 if link.outside == GROUND else nodes[link.outside] @ q
        return np.asarray(nodes[link.inside] @ q - outside)

    def force(parts: Parts) -> NDArray[np.complex128]:
        total = np.zeros(2, dtype=np.complex128)
        for link, part in (each for each in parts.links if each[0].sees == PLANE):
            stiffness, damping, mass = part.at(omega)
            total -= (stiffness + 1j * frequency * damping - frequency**2 * mass) @ motion(link)
        for name, link, _ in parts.ports:
            total += (slopes[name].by_displacement + 1j * frequency * slopes[name].by_velocity) @ motion(link)
        return total

    return np.array([force(element.parts(site)) for element in _bearing_elements(case)]).reshape(-1, 2)


def _bearing_elements(case: Case) -> list[MachineElement]:
    """The bearings without a film, in the order of the case."""
    own = {each.key: each for kind in (GivenCoefficients, BallBearingElement) for each in kind.of(case)}
    return [own[key] for key in case.bearing_keys if key in own]


def changes_with_speed(case: Case) -> bool:
    """Whether coefficients of an element depend on the speed of the rotor."""
    return any(not element.linear.constant for element in GivenCoefficients.of(case))


def element_decisions(case: Case) -> Iterator[Line]:
    """What the plan says of elements: choice, value, reason."""
    site = site_of(case)
    return (element.plan_line(site) for element in elements_of(case))


def element_faults(case: Case) -> list[Fault]:
    """Every reason why the elements of a case cannot be modelled."""
    return [fault for element in elements_of(case) for fault in element.faults()]


def element_springs(case: Case, omega: float) -> Array:
    """(e,) N/m of each bearing without a film at omega rad/s, then N m of a collar that is held in tilt, and of rows of
    balls: the mean of the direct stiffness of both directions, as far as it holds the shaft; cross-coupling, damping
    and mass are left out."""
    stiffness = [each for element in elements_of(case) if (each := element.stiffness(omega)) is not None]
    tilts = (element.tilt for element in BallBearingElement.of(case))
    stiffness += [part.at(omega)[0][len(PLANE) :, len(PLANE) :] for part in tilts if part is not None]
    return np.array([max(0.5 * float(np.trace(each)), 0.0) for each in stiffness])


def without_bearing(case: Case) -> list[Fault]:
    """The fault of a case of thrust bearings alone, which has no lateral motion."""
    if case.given_bearings:
        return []
    problem = "is missing: the case has thrust bearings alone, which do not act on the lateral motion."
    return [Fault("bearing", "", None, problem, "Call `frb thrust`, or add [rotor], [speed] and [bearing].")]


def without_film(case: Case, what: str) -> list[Fault]:
    """The fault of a case in which no bearing has a film, where `what` is of films alone."""
    if case.films or not case.given_bearings:
        return []
    problem = f"has no film, and {what}."
    key, kind = first_without_film(case)
    return [Fault(key, kind, None, problem, "Add a bearing with a film.")]


def first_without_film(case: Case) -> tuple[str, str]:
    """Key and value of the kind of the first bearing without a film, of a case that has one."""
    keyed = zip(case.bearing_keys, case.placed_bearings, strict=True)
    return next((f"{key}.kind", bearing.kind) for key, bearing in keyed if bearing in case.elements)


def support_faults(case: Case, what: str, remedy: str) -> list[Fault]:
    """The faults of what is more than bearings on the ground, where `what` is of these alone."""
    return [Fault(each.key, "", None, f"adds to the bearings, and {what}.", remedy) for each in beside_bearings(case)]


def beside_bearings(case: Case) -> tuple[MachineElement, ...]:
    """What lets the shells of bearings move, or pulls at the shaft."""
    return tuple(element for element in elements_of(case) if element.besides_bearings)


def speed_dependent(case: Case, what: str) -> list[Fault]:
    """The faults of elements whose coefficients depend on the speed, where `what` needs constant ones."""
    problem = f"depends on the speed, and {what}."
    remedy = "Give constant stiffness, damping and mass, those at the speed of interest."
    refusals = [
        Fault(f"{element.key}.over_speed", element.given.name, None, problem, remedy)
        for element in GivenCoefficients.of(case)
        if not element.linear.constant
    ]
    if shaft_of(case).internally_damped:
        turns = f"turns with the shaft, so that its force depends on the speed, and {what}."
        refusals.append(Fault("rotor.internal_damping", "", None, turns, "Write 0, or take a run-up."))
    return refusals


def make_rotor(case: Case, sees: tuple[str, ...] = PLANE, free_speed: bool = False) -> LinearRotor:
    """The machine of a case, with its films in the order of film_places and the angles of its turning rings last. sees:
    the coordinates of their journals that films act on; free_speed: with the angle of the rotor before them.

    Raises InputError if its shaft has no modes.
    """
    bodies, films, elements, centred = _bodies_and_links(case, sees, free_speed)
    own = elements.links, elements.forces, elements.loads, elements.ports
    rotor = preset(assembled(bodies, films, *own), centred)
    return replace(rotor, cones=tuple(_cones(case, bodies)))


def collar_tilt(case: Case) -> Array | None:
    """(2, n) tilts about x and y of the collar of a case against its pads, None where it does not act in tilt."""
    bodies, _, elements, _ = _bodies_and_links(case, PLANE)
    links = [link for link, _ in elements.links if link.inside == COLLAR]
    return assembled(bodies, links).journals[0] if links else None


def _bodies_and_links(
    case: Case, sees: tuple[str, ...], free_speed: bool = False
) -> tuple[list[Body], list[Link], Parts, list[int]]:
    """Bodies of the machine, links of its films, parts of its elements, and which of the films are centred dampers."""
    site, count = site_of(case), float(shaft_of(case).equal_bearings)
    bodies, films = [shaft_of(case).body()], []
    for given in case.given_bearings:
        bodies += _rings(given, count, case)
    for bearing in case.bearings:
        journal, shell = site.journal(bearing.name), site.shell(bearing.name)
        if bearing.kind == "floating-ring":
            ring = _ring_node(bearing)
            films += [Link(journal, ring, count, sees), Link(ring, shell, count, sees)]
        else:
            films.append(Link(journal, shell, count, sees))
    dampers = list(DamperElement.of(case))
    centred = [len(films) + number for number, damper in enumerate(dampers) if damper.given.centred]
    films += [replace(damper.link(site), sees=sees) for damper in dampers]
    elements = element_parts(case)
    spins = [spin(sum(bearing.ring_inertia for bearing in around)) for around in turning_rings(case)]
    rotation = [spin(case.polar_inertia)] if free_speed else []
    return [*bodies, *elements.bodies, *rotation, *spins], films, elements, centred


def _ring_node(bearing: FloatingRingBearing) -> str:
    """The node of a ring: of a cartridge, the node of one end."""
    return f"ring_{bearing.name}".rstrip("_")


def _rings(bearing: GivenBearing, count: float, case: Case) -> Iterator[Body]:
    """The bodies of the ring of a bearing: the rings of equal bearings move as one, with the mass of all. A ring of its
    own tilts where its films follow that."""
    gravity = case.rotor.gravity
    if bearing.kind == "cartridge":
        (mass, _, tilt_inertia), (left, right), (start, end) = bearing.body, bearing.parts, bearing.positions
        yield tilting_mass((_ring_node(left), _ring_node(right)), mass, tilt_inertia, end - start, gravity)
    if bearing.kind == "floating-ring":
        node, mass = _ring_node(bearing), count * bearing.ring_mass
        tilts, inertia = case.film.tilt == "follows", count * bearing.ring_tilt_inertia
        yield tilting_ring(node, mass, inertia, gravity) if tilts else point_mass(node, mass, gravity)


def _cones(case: Case, bodies: Sequence[Body]) -> Iterator[tuple[int, Array]]:
    """See LinearRotor: the slopes of the rings that turn and tilt."""
    around = turning_rings(case)
    if not around:
        return
    slopes = assembled(bodies, [Link(_ring_node(ends[0]), sees=("tilt_y", "tilt_x")) for ends in around]).journals
    for number, (ends, slope) in enumerate(zip(around, slopes, strict=True), start=slopes.shape[2] - len(around)):
        if slope.any():  # in y it is that about x against it
            inertia = sum(end.ring_inertia for end in ends)
            yield number, math.sqrt(inertia) * slope * [[1.0], [-1.0]]
