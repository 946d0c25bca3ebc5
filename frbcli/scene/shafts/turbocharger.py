"""A turbocharger's shaft of sections with its wheels, in its lowest free modes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from frbcli.case.rotor import ShaftSection, TurbochargerRotor
from frbcli.elements.collar.thrust import COLLAR
from frbcli.errors import Fault, InputError, NotConverged
from frbcli.rotor.beam import ELEMENTS, BeamSection
from frbcli.rotor.body import Body
from frbcli.rotor.linear import Array, LinearRotor
from frbcli.rotor.reduction import MOST, RIGID, FreeModes, ReductionError, free_modes, reduction_error
from frbcli.rotor.turbocharger import Journal, Wheel, turbocharger_rotor, wheels_on_shaft
from frbcli.scene.shafts.shaft import STANDS, TURNS, Shaft, Stations

FREQUENCIES = 3  # bending modes that are shown


@dataclass(frozen=True)
class FreeShaft:
    """A shaft in its free modes. modes: all of each plane; kept: how many of them its body has; journals: places of all
    bearings, those with a film first; wheels: its disks; collars: places that are held in tilt."""

    modes: FreeModes
    kept: int
    journals: tuple[Journal, ...]
    wheels: tuple[Wheel, ...]
    collars: tuple[Journal, ...] = ()

    @property
    def held(self) -> Array:
        """(b, n) displacements of the modes at the bearings, then their slopes at the collars."""
        slopes = [self.modes.slope_at(collar.position) for collar in self.collars]
        return np.stack([*(self.modes.at(journal.position) for journal in self.journals), *slopes])

    def reduction_error(self, springs: Array, omega: float) -> ReductionError:
        """What the modes leave out that are not kept, on springs (b,) in N/m, or N m of collars, at omega rad/s."""
        return reduction_error(self.modes, self.kept, self.held, springs, omega)


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
        modes = free.modes.lowest(free.kept)
        damping = rotor.modal_damping, rotor.external_damping
        return turbocharger_rotor(modes, free.wheels, free.journals, *damping, rotor.gravity, free.collars)

    def undamped_body(self) -> Body:
        free = self.free()
        undamped = replace(free.modes, internal=np.zeros_like(free.modes.internal))
        return turbocharger_rotor(undamped, free.wheels, free.journals, 0.0, 0.0, 0.0, free.collars)

    def free(self) -> FreeShaft:
        """See Shaft. Raises InputError where masses and stiffnesses differ by too many powers of ten for its modes."""
        return self._free

    @cached_property
    def _free(self) -> FreeShaft:
        case = self.case
        sections = [BeamSection(**dict(part) | {"internal_damping": self._internal(part)}) for part in case.shaft]
        bearings = (*case.bearings, *case.elements)
        journals = tuple(Journal(bearing.name, bearing.position or 0.0) for bearing in bearings)
        acting = case.thrust_bearings if case.axial is not None else ()
        collars = tuple(Journal(COLLAR, each.position or 0.0) for each in acting)
        try:
            modes = free_modes(wheels_on_shaft(sections, self._wheels, (*journals, *collars)))
        except NotConverged as error:
            problem = f"is no shaft whose motion can be computed. {error}"
            remedy = "Check the orders of magnitude of its sections and of the masses of [[disk]]."
            fault = Fault("shaft", f"{len(sections)} sections", None, problem, remedy)
            raise InputError(case.name or "case", (fault,)) from None
        cutoff = self.rotor.cutoff
        count = self.rotor.modes if cutoff is None else modes.below(2 * math.pi * cutoff)
        return FreeShaft(modes, min(max(count, RIGID), len(modes.frequencies)), journals, self._wheels, collars)

    def _internal(self, part: ShaftSection) -> float:
        """The internal damping of a section over its stiffness, s."""
        return self.rotor.internal_damping if part.internal_damping is None else part.internal_damping

    @property
    def dampings(self) -> tuple[tuple[str, float, str, str], ...]:
        """See Shaft; of sections with internal dampings of their own the largest one."""
        rotor, internal = self.rotor, [self._internal(part) for part in self.case.shaft]
        largest = "" if len(set(internal)) == 1 else "; largest of the sections"
        return (
            ("external damping", rotor.external_damping, "N*s/m", "of each disk against the ground"),
            ("modal damping", rotor.modal_damping, "", f"ratio of every elastic mode; {STANDS}"),
            ("internal damping", max(internal), "s", f"of the shaft over its stiffness{largest}; {TURNS}"),
        )

    @property
    def internally_damped(self) -> bool:
        return any(map(self._internal, self.case.shaft))

    @property
    def _wheels(self) -> tuple[Wheel, ...]:
        """The disks of the case; those without a name are numbered."""
        named = enumerate(self.case.disks, start=1)
        return tuple(Wheel(**{**dict(disk), "name": disk.name or str(number)}) for number, disk in named)

    @property
    def mass(self) -> float:
        areas = (0.25 * math.pi * (part.diameter**2 - part.inner_diameter**2) for part in self.case.shaft)
        shaft = sum(area * part.length * part.density for area, part in zip(areas, self.case.shaft, strict=True))
        return shaft + sum(disk.mass for disk in self.case.disks)

    @property
    def eccentricity(self) -> float:
        return sum(disk.unbalance for disk in self.case.disks) / self.mass

    @property
    def disk_count(self) -> int:
        return len(self.case.disks)

    @property
    def freedoms(self) -> int:
        """See Shaft: below a cut-off as many modes of a plane as the shaft without its wheels has half waves at that
        frequency."""
        rotor = self.rotor
        if rotor.cutoff is None:
            return 2 * min(rotor.modes, self.beam_freedoms)
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
        maps[:, 0, : free.kept] = maps[:, 1, free.kept : 2 * free.kept] = free.modes.shapes[:, : free.kept]
        marks = [(bearing.name, bearing.position or 0.0) for bearing in self.case.placed_bearings]
        marks += [(disk.name, disk.position) for disk in self.case.disks]
        return Stations(free.modes.positions, maps, True, tuple(marks))
