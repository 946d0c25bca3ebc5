"""What acts on a rotor besides its bearings: forces, motion of the ground, magnetic pull, springs and stops."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import BeforeValidator, Field

from frbcli.case.model import (
    ONE_OR_MANY,
    Angle,
    Damping,
    Identifier,
    Label,
    Length,
    Quantity,
    SignedSpeed,
    Speed,
    Stiffness,
)
from frbcli.case.reading.tables import Breach, Path
from frbcli.case.surroundings.over_time import OverTime
from frbcli.case.surroundings.places import MachineTable, no_place, node_at, table_breaches
from frbcli.errors import did_you_mean
from frbcli.rotor.port import ForceLaw, keys_of, own_laws
from frbcli.units import NUMBER, ValueFault, quantity

if TYPE_CHECKING:
    from frbcli.case.schema import Case

ForceEntry = Annotated[float, Quantity("N", "10 N")]
Order = Annotated[float, Quantity(NUMBER, "2")]


class AppliedForce(MachineTable):
    """A constant, harmonic or tabulated force on a disk, journal, ring or support."""

    at: Identifier = Field(
        description="disk or bearing by name, or a point of a run such as `disk`, `journal_left`, `support`"
    )
    force: tuple[ForceEntry, ForceEntry] | None = Field(
        default=None,
        description="[x, y] or amplitude; factor of the columns of `file`, default: 1 N",
    )
    order: Order | None = Field(
        default=None, description="times the rotor angle; below 0 clockwise"
    )
    frequency: SignedSpeed | None = Field(default=None, description="fixed; replaces `order`")
    rotating: bool = Field(
        default=False,
        description="turns counter-clockwise, default: with the rotor",
    )
    phase: Angle = Field(default=0.0, description="at angle and time zero")
    file: Label = Field(
        default="",
        description="replaces the four: CSV, WAV, MAT or UFF with columns time, x and y, or one for both",
    )
    over_time: OverTime | None = Field(default=None, description="contents of `file`, written by runs")

    @property
    def amplitude(self) -> tuple[float, float]:
        """Amplitude along x and y in N, the factors of a table over time."""
        return self.force or (1.0, 1.0)

    @property
    def turns(self) -> tuple[float, float]:
        """Order, and frequency in Hz; both 0 of a constant force."""
        if self.order is None and self.frequency is None:
            return (1.0 if self.rotating else 0.0), 0.0
        return self.order or 0.0, self.frequency or 0.0

    @property
    def constant(self) -> bool:
        """Whether it depends neither on the angle of the rotor nor on time."""
        return self.turns == (0.0, 0.0) and self.over_time is None

    @property
    def turning(self) -> str:
        """Its order, its frequency or its table in words; "" of a constant force."""
        if self.over_time is not None:
            return self.over_time.origin
        order, frequency = self.turns
        return f"order {order:g}" if order else f"{frequency:g} Hz" if frequency else ""

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        if not node_at(case, self.at):
            yield Breach((*path, "at"), *no_place(case, self.at))
        if self.order is not None and self.frequency is not None:
            yield Breach((*path, "frequency"), "is given with order.", "Keep one of the two.")
        for key in ("order", "frequency"):
            if getattr(self, key) == 0.0:
                yield Breach((*path, key), "is 0.", "Leave it out: the force is then constant.")
        if self.over_time is not None:
            yield from table_breaches(path, self, self.over_time, ("order", "frequency", "rotating", "phase"))
        elif self.force is None:
            yield Breach((*path, "force"), "is missing.", 'Write e.g. ["10 N", "0 N"].')
        elif self.phase and self.constant:
            yield Breach((*path, "phase"), "has no effect: the force is constant.", "Remove it, or give an order.")


AccelerationEntry = Annotated[float, Quantity("m/s^2", "2 m/s^2")]


class Base(MachineTable):
    """Motion of the ground, harmonic or tabulated. Displacements are relative to it."""

    acceleration: tuple[AccelerationEntry, AccelerationEntry] | None = Field(
        default=None,
        description="[x, y] amplitude; factor of the columns of `file`, default: 1 m/s^2",
    )
    order: Order | None = Field(default=None, description="times the angle of the source; default: 1")
    speed: Speed | None = Field(default=None, description="of the source, such as an engine; default: of the rotor")
    phase: Angle = Field(default=0.0, description="at angle and time zero")
    file: Label = Field(
        default="",
        description="replaces order, speed and phase: as of a [[force]]",
    )
    over_time: OverTime | None = Field(default=None, description="contents of `file`, written by runs")

    alone: ClassVar[bool] = True

    @property
    def amplitude(self) -> tuple[float, float]:
        """Amplitude along x and y in m/s^2, the factors of a table over time."""
        return self.acceleration or (1.0, 1.0)

    @property
    def turns(self) -> tuple[float, float]:
        """Order of the rotor speed, and frequency in Hz."""
        order = 1.0 if self.order is None else self.order
        return (order, 0.0) if self.speed is None else (0.0, order * self.speed)

    @property
    def turning(self) -> str:
        """What it changes with, in words."""
        if self.over_time is not None:
            return self.over_time.origin
        of = "" if self.speed is None else f" of {self.speed:g} Hz"
        return f"order {1.0 if self.order is None else self.order:g}{of}"

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        if case.housing is not None and case.housing.modes and not case.housing.masses:
            problem = "acts on masses, and the masses of the housing are unknown: its modes do not contain them."
            yield Breach(path, problem, "Give housing.masses, or a rigid housing.")
        if self.over_time is not None:
            yield from table_breaches(path, self, self.over_time, ("order", "speed", "phase"))
            return
        if self.acceleration is None:
            yield Breach((*path, "acceleration"), "is missing.", 'Write e.g. ["2 m/s^2", "0 m/s^2"], or a file.')
        elif self.order is None and self.speed is None:
            problem = "would not change: a ground that is only accelerated moves away."
            yield Breach((*path, "acceleration"), problem, "Give an order, the speed of what shakes, or a file.")
        for key in ("order", "speed"):
            if getattr(self, key) == 0.0:
                yield Breach((*path, key), "is 0.", "Give the order or the speed of what shakes the ground.")


def _as_list(given: object) -> object:
    return [given] if isinstance(given, dict | Base) else given


Bases = Annotated[tuple[Base, ...], BeforeValidator(_as_list), ONE_OR_MANY]


Pull = Annotated[float, Quantity("N/m", "1e5 N/m", above=0)]


class MagneticPull(MachineTable):
    """Unbalanced magnetic pull of an electrical machine: a negative spring."""

    at: Identifier = Field(description="place of the rotor, as of a [[force]]")
    pull: Pull = Field(description="force over displacement; of a symmetric rotor at each journal")
    stator: Identifier = Field(
        default="", description="place of the stator, such as `housing`; default: the ground"
    )

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        for key, place in (("at", self.at), ("stator", self.stator)):
            if (place or key == "at") and not node_at(case, place):
                yield Breach((*path, key), *no_place(case, place))
        if self.stator and node_at(case, self.stator) == node_at(case, self.at):
            yield Breach((*path, "stator"), "is the place of the rotor.", "Name what carries the stator, or remove it.")


Cubic = Annotated[float, Quantity("N/m^3", "1e15 N/m^3", least=0, most=1e30)]
Gap = Annotated[float, Quantity("m", "20 um", least=0)]
Friction = Annotated[float, Quantity(NUMBER, "0.1", least=0)]


class Spring(MachineTable):
    """A spring with damper, or a stop, to ground or between two places."""

    at: Identifier = Field(default="", description="place, as of a [[force]]")
    between: tuple[Identifier, Identifier] | None = Field(
        default=None, description="replaces `at`: two places, such as `compressor` and `housing`"
    )
    stiffness: Stiffness | None = Field(default=None, description="in all directions; of a stop, beyond its gap")
    cubic: Cubic = Field(default=0.0, description="force over displacement cubed")
    gap: Gap = Field(default=0.0, description="radial gap of a stop")
    damping: Damping = Field(default=0.0, description="of a stop, in contact only, without pull")
    friction: Friction = Field(default=0.0, description="of a stop, against sliding of the first place")
    radius: Length | None = Field(
        default=None,
        description="where a turning shaft rubs: sliding by rotation and centre motion; without it by the sense of "
        "rotation",
    )

    law: Identifier = Field(
        default="", description="replaces these: a force law from Python, by its name"
    )
    numbers: dict[str, float | str] = Field(default={}, description="of the law, by the names of its fields")

    @property
    def linear(self) -> bool:
        """Whether its force is proportional to the motion."""
        return not (self.gap or self.cubic or self.friction or self.law)

    @property
    def own_law(self) -> ForceLaw:
        """The force law of its name with its numbers in SI, once its rules hold."""
        kind = own_laws()[self.law]
        return kind(**{name: quantity(self.numbers[name], unit or NUMBER) for name, unit in keys_of(kind).items()})

    @property
    def ends(self) -> tuple[str, str]:
        """Both places; "" is the ground."""
        return self.between or (self.at, "")

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        if bool(self.at) == (self.between is not None):
            problem = "are both given." if self.at else "is missing, and so is at."
            yield Breach((*path, "between"), problem, "Give at, a place, or between, two of them.")
            return
        for place in self.between or (self.at,):
            if not node_at(case, place):
                yield Breach((*path, "between" if self.between else "at"), *no_place(case, place))
        if self.between is not None and len({node_at(case, each) for each in self.between}) == 1:
            yield Breach((*path, "between"), "names one place twice.", "Name two places, or give at.")
        if self.law:
            yield from self._law_breaches(path)
            return
        if self.numbers:
            yield Breach((*path, "numbers"), "has no effect without a law.", "Give the name of a law, or remove it.")
        if not (self.stiffness or self.cubic or (self.damping and self.linear)):
            yield Breach((*path, "stiffness"), "is missing.", "Give a stiffness, cubic or, without a gap, a damping.")
        if self.friction and not self.gap:
            yield Breach(
                (*path, "friction"), "needs a gap: without one nothing slides.", "Give one, or remove it."
            )
        if self.radius is not None and not self.friction:
            yield Breach((*path, "radius"), "has no effect without friction.", "Give a friction, or remove it.")

    def _law_breaches(self, path: Path) -> Iterator[Breach]:
        """What is wrong with a law that was added from Python, or with its numbers."""
        for key in sorted(self.model_fields_set - {"at", "between", "law", "numbers"}):
            yield Breach((*path, key), "has no effect with a law.", "Remove it.")
        kind = own_laws().get(self.law)
        if kind is None:
            known = ", ".join(own_laws()) or "none"
            remedy = f"Call frbcli.add_force_law in this process before the case is read; added so far: {known}."
            yield Breach((*path, "law"), "is no force law of this process.", remedy)
            return
        keys = keys_of(kind)
        for name in keys.keys() - self.numbers.keys():
            yield Breach((*path, "numbers"), f"lacks {name}.", f"Give {', '.join(keys)}.")
        for name, value in self.numbers.items():
            if name not in keys:
                yield Breach((*path, "numbers", name), "is no field of the law.", did_you_mean(name, keys))
                continue
            if keys[name] and not isinstance(value, str):
                problem, remedy = "has no unit.", f'Write e.g. "{value:g} {keys[name]}".'
                yield Breach((*path, "numbers", name), problem, remedy)
                continue
            try:
                quantity(value, keys[name] or NUMBER)
            except ValueFault as fault:
                yield Breach((*path, "numbers", name), fault.problem, fault.remedy)
