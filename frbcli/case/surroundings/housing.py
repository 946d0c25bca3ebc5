"""The housing of all bearings: a rigid body on mounts, or the modes of an elastic one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated

from pydantic import BeforeValidator, Field

from frbcli.case.model import AlsoAs, Model
from frbcli.case.quantities import Fraction, Identifier, Label, Position, Quantity, RingInertia, ShellMass
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.machine_table import MachineTable
from frbcli.case.surroundings.support import DIRECTIONS, Dampings, Stiffnesses
from frbcli.nearest import did_you_mean
from frbcli.units import NUMBER, SPEED

if TYPE_CHECKING:
    from frbcli.case.schema import Case

KEY = "housing"
ORTHONORMAL = 0.01  # of 1: modes that are written with two digits
RIGID = ("mass", "inertia", "position", "mounts")
SYMMETRIC_PLACE = "bearing"  # of a symmetric rotor, whose bearings move alike

Entry = Annotated[float, Quantity(NUMBER, "0.3")]
Inertias = Annotated[tuple[RingInertia, RingInertia], *DIRECTIONS]


class Mount(Model):
    """Springs and dampers between housing and ground."""

    position: Position | None = Field(default=None, description="along the shaft; required for a turbocharger")
    stiffness: Stiffnesses = Field(description="to ground")
    damping: Dampings = Field(default=(0.0, 0.0), description="to ground")


class ModeAt(Model):
    """The displacement of a mode at a place."""

    place: Identifier = Field(description="name of a bearing, `bearing` of a symmetric rotor, or a key of `masses`")
    displacement: tuple[Entry, Entry] = Field(description="[x, y] in 1/sqrt(kg), for a modal mass of 1 kg")


class MassAt(Model):
    """A mass of the housing."""

    place: Identifier = Field(description="as in `at` of the modes")
    mass: ShellMass = Field(description="at this place")


_BY_PLACE = AlsoAs(lambda listed: [{"type": "object"}, listed])  # a table by places


def _listed(value: str) -> BeforeValidator:
    """Reads { left = ..., right = ... } as a list of tables with `place` and `value`."""

    def listed(given: object) -> object:
        return [{"place": place, value: each} for place, each in given.items()] if isinstance(given, dict) else given

    return BeforeValidator(listed)


class HousingMode(Model):
    """A mode of the housing and all fixed to it, without rotor and bearings."""

    frequency: Annotated[float, Quantity(SPEED, "120 Hz", above=0)] = Field(description="undamped")
    damping: Fraction = Field(default=0.0, description="ratio")
    at: Annotated[tuple[ModeAt, ...], _listed("displacement"), _BY_PLACE] = Field(
        description="displacements in 1/sqrt(kg): { left = [0.3, 0], right = [-0.2, 0] }"
    )


class Housing(MachineTable):
    """The body that carries all bearings: rigid on mounts, or modes."""

    mass: ShellMass | None = Field(default=None, description="of a rigid housing")
    inertia: Inertias | None = Field(
        default=None,
        description="of a rigid housing about its centre of mass, or [x z, y z]; required for a turbocharger",
    )
    position: Position | None = Field(default=None, description="of its centre of mass")
    mounts: tuple[Mount, ...] = Field(default=(), description="of a rigid housing")
    modes: tuple[HousingMode, ...] = Field(default=(), description="of an elastic housing; replaces the keys above")
    file: Label = Field(
        default="",
        description="replaces `modes`: CSV with frequency_Hz, damping, left_x, left_y etc., or a rotor file of ROSS "
        "with point masses",
    )
    masses: Annotated[tuple[MassAt, ...], _listed("mass"), _BY_PLACE] = Field(
        default=(),
        description="of an elastic housing, for its weight and a check of the modes",
    )

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        return _modal(path, case, self) if self.modes else _rigid(path, case, self)


def shape(mode: HousingMode) -> Mapping[str, tuple[float, float]]:
    """Displacements of a mode by places, 1/sqrt(kg)."""
    return {each.place: each.displacement for each in mode.at}


def modal_products(housing: Housing) -> Iterator[tuple[int, int, float]]:
    """Numbers of two modes and the sum of mass times their displacements, 1 for a mode with itself and else 0."""
    masses = {each.place: each.mass for each in housing.masses}
    shapes = [shape(mode) for mode in housing.modes]
    for j, one in enumerate(shapes):
        for k, other in enumerate(shapes[: j + 1]):
            shared = one.keys() & other.keys() & masses.keys()
            yield j, k, sum(masses[p] * sum(a * b for a, b in zip(one[p], other[p], strict=True)) for p in shared)


def _rigid(path: Path, case: Case, housing: Housing) -> Iterator[Breach]:
    if housing.masses:
        yield Breach((*path, "masses"), "has no effect without modes.", "Remove it, or give the housing by its modes.")
    if not housing.mass:
        problem = "is 0, and the housing is a body" if housing.mass == 0.0 else "is missing, and there are no modes"
        yield Breach((*path, "mass"), f"{problem}.", 'Write e.g. mass = "50 kg".')
    if not housing.mounts:
        remedy = 'Add e.g. mounts = [{ stiffness = "1e8 N/m" }].'
        yield Breach((*path, "mounts"), "is missing: nothing holds the housing.", remedy)
    if case.rotor.symmetric:
        problem = "has no effect: both ends of a symmetric rotor move alike, and the housing does not tilt."
        places: list[tuple[Path, object]] = [((*path, key), getattr(housing, key)) for key in ("inertia", "position")]
        places += [((*path, "mounts", i, "position"), mount.position) for i, mount in enumerate(housing.mounts)]
        yield from (Breach(key, problem, "Remove it.") for key, value in places if value is not None)
        return
    for key, example in (("inertia", "2 kg*m^2"), ("position", "80 mm")):
        if getattr(housing, key) is None:
            yield Breach((*path, key), "is missing: a rigid housing tilts.", f'Write e.g. {key} = "{example}".')
    for number, mount in enumerate(housing.mounts):
        if mount.position is None:
            yield Breach((*path, "mounts", number, "position"), "is missing.", 'Write e.g. position = "20 mm".')
    if housing.mounts and len({mount.position for mount in housing.mounts}) == 1:
        problem = "are at one position, about which the housing tilts freely."
        yield Breach((*path, "mounts"), problem, "Add another one.")


def _modal(path: Path, case: Case, housing: Housing) -> Iterator[Breach]:
    for key in RIGID:
        if getattr(housing, key) not in (None, ()):
            yield Breach((*path, key), "is given with modes.", "Keep the keys of a rigid housing, or its modes.")
    carried = (SYMMETRIC_PLACE,) if case.rotor.symmetric else tuple(bearing.name for bearing in case.placed_bearings)
    known = {each.place for each in housing.masses}
    for number, mode in enumerate(housing.modes):
        yield from _at((*path, "modes", number, "at"), mode, carried, known)
    if not housing.masses:
        return
    for j, k, product in modal_products(housing):
        wanted = float(j == k)
        if abs(product - wanted) > ORTHONORMAL:
            which = "with itself" if j == k else f"with mode {k + 1}"
            problem = f"has a sum of masses times displacements {which} of {product:.4g} instead of {wanted:g}."
            remedy = "Give orthonormal modes, each divided by the root of its modal mass, and all masses."
            yield Breach((*path, "modes", j, "at"), problem, remedy)


def _at(path: Path, mode: HousingMode, carried: tuple[str, ...], known: set[str]) -> Iterator[Breach]:
    places = [each.place for each in mode.at]
    for place in carried:
        if place not in places:
            yield Breach(path, f"has no displacement at {place}.", f"Write e.g. {place} = [0.3, 0].")
    for place in dict.fromkeys(places):
        if place not in carried and place not in known:
            problem = f"has a displacement at {place}, which is neither a bearing nor a place of housing.masses."
            yield Breach(path, problem, did_you_mean(place, (*carried, *known)))
        if places.count(place) > 1:
            yield Breach(path, f"has {places.count(place)} displacements at {place}.", "Keep one.")
    if not any(any(displacement) for displacement in shape(mode).values()):
        yield Breach(path, "is zero everywhere: no mode.", "Give its displacements.")
