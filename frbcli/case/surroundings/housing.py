"""The housing that all bearings stand in: a rigid body on mounts, or the modes of an elastic one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated

from pydantic import BeforeValidator, Field

from frbcli.case.model import AlsoAs, Model
from frbcli.case.quantities import Fraction, Identifier, Label, Position, Quantity, RingInertia, ShellMass
from frbcli.case.surroundings.support import DIRECTIONS, Dampings, Stiffnesses
from frbcli.units import NUMBER, SPEED

Entry = Annotated[float, Quantity(NUMBER, "0.3")]
Inertias = Annotated[tuple[RingInertia, RingInertia], *DIRECTIONS]


class Mount(Model):
    """Springs and dampers between the housing and the ground."""

    position: Position | None = Field(default=None, description="along the shaft; must be given for a turbocharger")
    stiffness: Stiffnesses = Field(description="of both directions, or [x, y]")
    damping: Dampings = Field(default=(0.0, 0.0), description="of both directions, or [x, y]")


class ModeAt(Model):
    """The displacement of a mode at a place."""

    place: Identifier = Field(description="a bearing by its name, `bearing` of a symmetric rotor, or a key of `masses`")
    displacement: tuple[Entry, Entry] = Field(description="[x, y] in 1/sqrt(kg), of the mode with a modal mass of 1 kg")


class MassAt(Model):
    """A mass of the housing at a place."""

    place: Identifier = Field(description="as in `at` of the modes")
    mass: ShellMass = Field(description="of the housing there")


_BY_PLACE = AlsoAs(lambda listed: [{"type": "object"}, listed])  # a table by places


def _listed(value: str) -> BeforeValidator:
    """Reads { left = ..., right = ... } as a list of tables with `place` and `value`."""

    def listed(given: object) -> object:
        return [{"place": place, value: each} for place, each in given.items()] if isinstance(given, dict) else given

    return BeforeValidator(listed)


class HousingMode(Model):
    """A mode of the housing with all that is fixed to it, without rotor and bearings."""

    frequency: Annotated[float, Quantity(SPEED, "120 Hz", above=0)] = Field(description="undamped natural frequency")
    damping: Fraction = Field(default=0.0, description="ratio to the critical damping")
    at: Annotated[tuple[ModeAt, ...], _listed("displacement"), _BY_PLACE] = Field(
        description="displacements at all bearings in 1/sqrt(kg), e.g. { left = [0.3, 0], right = [-0.2, 0] }"
    )


class Housing(Model):
    """What all bearings stand in, in place of the ground: a rigid body with mass, inertia and mounts, or modes."""

    mass: ShellMass | None = Field(default=None, description="of a rigid housing; above 0")
    inertia: Inertias | None = Field(
        default=None,
        description="of a rigid housing that tilts, about its centre of mass: of both planes, or [x z, y z]; must be "
        "given for a turbocharger, and has no effect on a symmetric rotor, whose ends move alike",
    )
    position: Position | None = Field(default=None, description="of its centre of mass along the shaft, as `inertia`")
    mounts: tuple[Mount, ...] = Field(default=(), description="what holds a rigid housing")
    modes: tuple[HousingMode, ...] = Field(default=(), description="of an elastic housing, in place of all these keys")
    file: Label = Field(
        default="", description="in place of `modes`: a CSV with a row for each mode and the columns frequency_Hz, "
        "damping, and left_x, left_y and so on by places, or a rotor file of ROSS, .toml or .json, whose bearings are "
        "on point masses; from the case's folder",
    )  # fmt: skip
    masses: Annotated[tuple[MassAt, ...], _listed("mass"), _BY_PLACE] = Field(
        default=(),
        description="all masses of an elastic housing by their places, each with a unit: modes are then "
        "checked to be orthonormal, and the housing has its weight",
    )


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
