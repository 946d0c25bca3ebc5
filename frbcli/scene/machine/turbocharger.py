"""A turbocharger's shaft of sections with its wheels, in its lowest free modes.

The kinds of shafts: one row for each rotor of a case file.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, ClassVar

import numpy as np

from frbcli.arrays import Array
from frbcli.case.rotor import (
    Disk,
    JeffcottRotor,
    RigidRotor,
    ShaftSection,
    TurbochargerRotor,
    bow_places,
    unbalance_sizes,
    with_losses,
)
from frbcli.case.schema import Case
from frbcli.elements.thrust import COLLAR
from frbcli.errors import Fault, NotConverged
from frbcli.rotor.assembly import Body, LinearRotor
from frbcli.rotor.beam import ELEMENTS, BeamSection
from frbcli.rotor.reduction import (
    EXACT,
    MOST,
    RIGID,
    FreeModes,
    Journal,
    Places,
    PointForces,
    Reduction,
    ReductionError,
    Wheel,
    bending_forces,
    free_modes,
    judged,
    reduction,
    reduction_error,
    turbocharger_rotor,
    wheels_on_shaft,
    with_static_modes,
)
from frbcli.scene.machine.shaft import STANDS, TURNS, BalancingPlane, JeffcottShaft, RigidShaft, Shaft, Stations
from frbcli.units import display

USUAL = 4  # free modes of a reduction that is made for its target
FREQUENCIES = 3  # bending modes that are shown


@dataclass(frozen=True)
class FreeShaft:
    """A shaft in its free modes. modes: all of each plane; reduced: the modes of its body; journals: places of all
    bearings, films first; wheels: its disks; collars: places that are held in tilt, of thrust bearings, then of rows
    of balls; bow: what bends it without load, None of a straight one."""

    modes: FreeModes
    reduced: Reduction
    journals: tuple[Journal, ...]
    wheels: tuple[Wheel, ...]
    collars: tuple[Journal, ...] = ()
    bow: PointForces | None = None

    @property
    def kept(self) -> int:
        """Modes of each plane that its body has."""
        return len(self.reduced.modes.frequencies)

    @property
    def held(self) -> Array:
        """(b, n) displacements of the modes at the bearings, then their slopes at the collars."""
        return self._held(self.modes)

    @property
    def nodes(self) -> tuple[Journal, ...]:
        """The collars that are nodes: rows of balls hold the journal of their bearing."""
        return tuple(each for each in self.collars if each.name == COLLAR)

    def reduced_on(self, springs: Array, top: float) -> Reduction:
        """The reduction with its changes on springs (b,) in N/m of the bearings, up to the speed `top` in rad/s."""
        places = _places(self.journals, self.wheels, self.collars, self.bow)
        return _judged(self.modes, self.reduced.modes, places, top, self.reduced.free, springs)

    def _held(self, modes: FreeModes) -> Array:
        slopes = [modes.slope_at(collar.position) for collar in self.collars]
        return np.stack([*(modes.at(journal.position) for journal in self.journals), *slopes])

    def reduction_error(self, springs: Array, omega: float) -> ReductionError:
        """What the reduction leaves out, on springs (b,) in N/m, or N m of collars, at omega rad/s."""
        return reduction_error(self.modes, self.reduced.modes, self._held, springs, omega)


@lru_cache(maxsize=8)
def _free_shaft(
    sections: tuple[BeamSection, ...],
    wheels: tuple[Wheel, ...],
    journals: tuple[Journal, ...],
    collars: tuple[Journal, ...],
    offsets: tuple[tuple[float, complex], ...],
    top: float,
    asked: tuple[int | None, float | None, float],
) -> FreeShaft:
    """A shaft in the modes that are asked for: their number, or a cut-off in Hz, or as many as a target needs up to the
    speed `top` in rad/s. offsets: positions and sizes of its bow in m. A command makes its machine several times.
    Raises NotConverged."""
    bent = tuple(Journal("bow", position) for position, _ in offsets)
    modes = free_modes(wheels_on_shaft(sections, wheels, (*journals, *collars, *bent)))
    bow = bending_forces(modes, *zip(*offsets, strict=True)) if offsets else None
    places, (count, cutoff, target) = _places(journals, wheels, collars, bow), asked
    if count is None and cutoff is None:
        reduced = reduction(modes, places, top, target)
    else:
        count = count or RIGID if cutoff is None else modes.below(2.0 * math.pi * cutoff)
        kept = min(max(count, RIGID), len(modes.frequencies))
        reduced = _judged(modes, modes.lowest(kept), places, top, kept)
    return FreeShaft(modes, reduced, journals, wheels, collars, bow)


def _places(
    journals: tuple[Journal, ...], wheels: tuple[Wheel, ...], collars: tuple[Journal, ...], bow: PointForces | None
) -> Places:
    bearings, disks, held = (tuple(each.position for each in some) for some in (journals, wheels, collars))
    return Places(bearings, disks, held, bow)


def _judged(
    modes: FreeModes, reduced: FreeModes, places: Places, top: float, free: int, springs: Array | None = None
) -> Reduction:
    exact = with_static_modes(modes, min(EXACT, len(modes.frequencies)), places)
    return judged(reduced, exact, places, top, free, springs)


@dataclass(frozen=True)
class TurbochargerShaft(Shaft):
    """Rigid wheels on an elastic shaft in any bearings."""

    rotor: TurbochargerRotor

    equal_bearings: ClassVar[int] = 1
    gyroscopic: ClassVar[bool] = True
    tilts: ClassVar[bool] = True
    elastic: ClassVar[bool] = True
    fronts: ClassVar[float] = 0.55

    @property
    def bearings_modelled(self) -> tuple[str, str]:  # type: ignore[override]
        """See Shaft."""
        count = len(self.case.placed_bearings)
        return f"{count} of {count}", "the rotor is not symmetric"

    def body(self) -> Body:
        rotor, free = self.rotor, self.free()
        modes = free.reduced.modes
        damping = rotor.modal_damping, rotor.external_damping
        return turbocharger_rotor(modes, free.wheels, free.journals, *damping, rotor.gravity, free.nodes, free.bow)

    def undamped_body(self) -> Body:
        free = self.free()
        none = np.zeros_like(free.modes.internal)
        undamped = replace(free.modes, internal=none, damping=none)
        return turbocharger_rotor(undamped, free.wheels, free.journals, 0.0, 0.0, 0.0, free.nodes)

    def free(self) -> FreeShaft:
        """See Shaft. Raises InputError where masses and stiffnesses differ by too many powers of ten for its modes."""
        return self._free

    @cached_property
    def _free(self) -> FreeShaft:
        case, rotor, speed = self.case, self.rotor, self.case.given_speed
        sections = tuple(BeamSection(**dict(part) | {"internal_damping": self._internal(part)}) for part in case.shaft)
        bearings = (*case.bearings, *case.elements)
        journals = tuple(Journal(bearing.name, bearing.position or 0.0) for bearing in bearings)
        acting = case.thrust_bearings if case.axial is not None else ()
        collars = [Journal(COLLAR, each.position or 0.0) for each in acting]
        pairs = (each for each in case.elements if each.kind == "ball" and each.row_distance is not None)
        collars += [Journal(each.name, each.position or 0.0) for each in pairs]
        top = 0.0 if speed is None else 2.0 * math.pi * speed.top
        asked = (rotor.modes, rotor.cutoff, case.accuracy.target)
        try:
            return _free_shaft(sections, self._wheels, journals, tuple(collars), bow_places(case), top, asked)
        except NotConverged as error:
            problem = f"is no shaft whose motion can be computed. {error}"
            remedy = "Check the orders of magnitude of its sections and of the masses of [[disk]]."
            raise case.refused(Fault("shaft", f"{len(sections)} sections", None, problem, remedy)) from None

    def free_modes(self) -> FreeModes:
        return self.free().modes

    @property
    def held(self) -> Array:
        return self.free().held

    @property
    def reduction(self) -> Reduction:
        return self.free().reduced

    def _internal(self, part: ShaftSection) -> float:
        """The internal damping of a section over its stiffness, s."""
        return self.rotor.internal_damping if part.internal_damping is None else part.internal_damping

    @property
    def dampings(self) -> tuple[tuple[str, float, str, str], ...]:
        """See Shaft; of sections with dampings of their own the largest one."""
        rotor, sections = self.rotor, self.case.shaft
        internal = [self._internal(part) for part in sections]
        of_mass, of_stiffness = zip(*((part.mass_damping, part.stiffness_damping) for part in sections), strict=True)

        def over(what: str, each: Sequence[float], turns: str) -> str:
            return f"of the shaft over its {what}{'' if len(set(each)) == 1 else '; largest of the sections'}; {turns}"

        return (
            ("external damping", rotor.external_damping, "N*s/m", "of each disk against the ground"),
            ("modal damping", rotor.modal_damping, "", f"ratio of every elastic mode; {STANDS}"),
            ("internal damping", max(internal), "s", over("stiffness", internal, TURNS)),
            ("mass damping", max(of_mass), "1/s", over("mass", of_mass, STANDS)),
            ("stiffness damping", max(of_stiffness), "s", over("stiffness", of_stiffness, STANDS)),
        )

    @property
    def internally_damped(self) -> bool:
        return any(map(self._internal, self.case.shaft))

    @property
    def _wheels(self) -> tuple[Wheel, ...]:
        """The disks of the case; those without a name are numbered."""
        return tuple(_wheel(disk, disk.name or str(number)) for number, disk in enumerate(self.case.disks, start=1))

    @property
    def _section_masses(self) -> list[float]:
        """Of the sections, kg."""
        areas = (0.25 * math.pi * (part.diameter**2 - part.inner_diameter**2) for part in self.case.shaft)
        return [area * part.length * part.density for area, part in zip(areas, self.case.shaft, strict=True)]

    @property
    def mass(self) -> float:
        return sum(self._section_masses) + sum(disk.mass for disk in self.case.disks)

    @property
    def centre_of_mass(self) -> float:
        moment, end = sum(disk.mass * disk.position for disk in self.case.disks), 0.0
        for mass, part in zip(self._section_masses, self.case.shaft, strict=True):
            moment += mass * (end + 0.5 * part.length)
            end += part.length
        return moment / self.mass

    @property
    def planes(self) -> tuple[BalancingPlane, ...]:
        return tuple(
            BalancingPlane(
                wheel.name, f"disk_{wheel.name}", wheel.position, cmath.rect(wheel.unbalance, wheel.phase)
            )
            for wheel in self._wheels
        )  # fmt: skip

    @property
    def eccentricity(self) -> float:
        return sum(map(unbalance_sizes, self.case.disks)) / self.mass

    @property
    def bow(self) -> float:
        return max((bow.offset for bow in self.case.bows), default=0.0)

    @property
    def bow_words(self) -> tuple[str, str]:
        bends = (f"{display(bow.offset, 'm')} at {display(bow.position, 'm')}" for bow in self.case.bows)
        return ", ".join(bends), "off the line through the outermost bearings; between, as a shaft loaded there bends"

    @property
    def disk_count(self) -> int:
        return len(self.case.disks)

    @property
    def freedoms(self) -> int:
        """See Shaft: below a cut-off as many modes of a plane as the shaft without its wheels has half waves at that
        frequency."""
        rotor = self.rotor
        if rotor.modes is None and rotor.cutoff is None:
            return 2 * min(USUAL + len(self.case.placed_bearings) + len(self.case.disks), self.beam_freedoms)
        if rotor.cutoff is None:
            return 2 * min(rotor.modes or RIGID, self.beam_freedoms)
        omega, waves = 2.0 * math.pi * rotor.cutoff, 0.0
        for part in self.case.shaft:
            gyration = math.hypot(part.diameter, part.inner_diameter) / 4.0
            sound = math.sqrt(part.youngs_modulus / part.density)
            waves += part.length * math.sqrt(omega / (gyration * sound)) / math.pi
        return 2 * int(min(RIGID + waves, MOST, self.beam_freedoms))

    @property
    def beam_freedoms(self) -> int:
        case = self.case
        return 2 * (1 + ELEMENTS + len(case.shaft) + len(case.disks) + len(case.placed_bearings))

    @property
    def natural_frequencies(self) -> tuple[tuple[float, ...], str]:
        """See Shaft. Raises InputError if it has no modes."""
        frequencies = self.free().modes.frequencies[RIGID : RIGID + FREQUENCIES] / (2.0 * math.pi)
        return tuple(frequencies.tolist()), "free, at rest"

    def journal(self, name: str) -> str:
        return f"journal_{name}"

    def stations(self, machine: LinearRotor) -> Stations:
        free = self.free()
        maps = np.zeros((len(free.modes.positions), 2, machine.size))
        maps[:, 0, : free.kept] = maps[:, 1, free.kept : 2 * free.kept] = free.reduced.modes.shapes
        marks = [(bearing.name, bearing.position or 0.0) for bearing in self.case.placed_bearings]
        marks += [(disk.name, disk.position) for disk in self.case.disks]
        return Stations(free.modes.positions, maps, True, tuple(marks))


def _wheel(disk: Disk, name: str) -> Wheel:
    unbalance, phase = with_losses(disk.unbalance, disk.phase, disk.losses)
    return Wheel(name, disk.position, disk.mass, disk.polar_inertia, disk.diametral_inertia, unbalance, phase)


SHAFTS: dict[type[Any], type[Any]] = {
    RigidRotor: RigidShaft,
    JeffcottRotor: JeffcottShaft,
    TurbochargerRotor: TurbochargerShaft,
}


def shaft_of(case: Case) -> Shaft:
    """The shaft of a case. Raises InputError for a case without a rotor."""
    shaft: Shaft = SHAFTS[type(case.rotor)](case, case.rotor)
    return shaft
