"""What acts on a rotor besides its bearings: forces, motion of the ground, magnetic pull, springs and stops.

What bearings stand on: supports, squeeze film dampers, and a housing, as a rigid body on mounts or by its modes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import BeforeValidator, Field

from frbcli.case.film import RingFilm
from frbcli.case.model import (
    ONE_OR_MANY,
    AlsoAs,
    Angle,
    Damping,
    Fraction,
    Identifier,
    Label,
    Length,
    Model,
    Position,
    Quantity,
    RingInertia,
    ShellMass,
    SignedSpeed,
    Speed,
    Stiffness,
    repeated,
)
from frbcli.case.over_time import MachineTable, OverTime, no_place, node_at, table_breaches
from frbcli.case.reading.tables import Breach, Path
from frbcli.errors import did_you_mean
from frbcli.rotor.port import ForceLaw, keys_of, own_laws
from frbcli.units import NUMBER, SPEED, ValueFault, quantity

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


Bases = Annotated[tuple[Base, ...], repeated(1), ONE_OR_MANY]


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


DIRECTIONS = (repeated(2), AlsoAs(lambda both: [both["prefixItems"][0], both]))
Stiffnesses = Annotated[tuple[Stiffness, Stiffness], *DIRECTIONS]
Dampings = Annotated[tuple[Damping, Damping], *DIRECTIONS]


class Support(Model):
    """A shell on springs and dampers, which moves in x and y without turning."""

    mass: ShellMass = Field(description="of the moving shell, per bearing")
    stiffness: Stiffnesses = Field(description="to ground or housing")
    damping: Dampings = Field(
        default=(0.0, 0.0), description="to ground or housing"
    )


NO_SPRING = (0.0, 0.0)


class Damper(RingFilm):
    """A squeeze film around a shell or an outer ring, which moves without turning."""

    mass: ShellMass = Field(description="of the moving shell, per bearing")
    spring: Stiffnesses = Field(
        default=NO_SPRING,
        description="stiffness of the centring spring",
    )
    centred: bool = Field(
        default=False,
        description="the spring centres the shell under static load; else it sinks by load over stiffness",
    )


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
