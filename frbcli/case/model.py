"""What all models of a case are made of: their base, frozen and without unknown keys, and the kinds of their values.

Each kind reads what the user wrote and holds SI. A value that does not fit raises ValueFault with problem and remedy.
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Self, TypeVar, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, core_schema

from frbcli.errors import Fault, FrozenError
from frbcli.units import (
    ANGLE,
    ANGULAR_RATE,
    KINEMATIC,
    NUMBER,
    SPEED,
    TEMPERATURE_DIFFERENCE,
    ValueFault,
    display,
    quantity,
    readable,
)

REMEDY = 'Write case.with_settings("oil.viscosity = 50 mPa*s"), with the key of a case file.'

Record = TypeVar("Record", bound="Model")


class Model(BaseModel):
    """One table of a case file.

    A part of a case cannot be changed by itself: its attributes are not all keys of the case file, and the rules that
    tie keys together would not be checked. `Case.with_settings` gives a case with other values.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=False, validate_default=False)

    @classmethod
    def completed(cls, table: dict[str, Any]) -> dict[str, Any]:
        """What a user wrote, with the keys that follow from others."""
        return table

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: object) -> object:
        return cls.completed(data) if isinstance(data, dict) else data

    def __setattr__(self, name: str, value: Any) -> None:
        """Raises FrozenError for every public name."""
        if not name.startswith("_"):
            raise _frozen(self, name)
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        """Raises FrozenError for every public name."""
        if not name.startswith("_"):
            raise _frozen(self, name)
        super().__delattr__(name)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy without changes. Raises FrozenError for an update, which pydantic would not check."""
        if update:
            raise _frozen(self, *update)
        return super().model_copy(deep=deep)

    def copy(self, **changes: Any) -> Self:  # still part of pydantic 2, which warns of it
        """A copy without changes. Raises FrozenError for any."""
        if changes:
            raise _frozen(self, *changes)
        return super().model_copy()

    @classmethod
    def model_construct(cls, _fields_set: set[str] | None = None, **values: Any) -> Self:
        """Raises FrozenError: pydantic would check nothing."""
        raise _frozen(cls, *values)


@dataclass(frozen=True)
class AlsoAs:
    """A value that is read from other forms, too: their schema for editors. forms: from the schema of the value."""

    forms: Callable[[dict[str, Any]], list[dict[str, Any]]]

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": self.forms(handler(schema))}


ONE_OR_MANY = AlsoAs(lambda many: [many["items"], many])  # [bearing] or [[bearing]]


def repeated(count: int) -> BeforeValidator:
    """One table or quantity, used so many times instead of a list."""

    def listed(given: object) -> object:
        return [given] * count if isinstance(given, dict | Model | str | int | float) else given

    return BeforeValidator(listed)


def altered(record: Record, values: Mapping[str, Any]) -> Record:
    """`record` with values that the program has computed, in SI, by their attributes. They are not checked; values of a
    user are set by `Case.with_settings`. Raises KeyError for an attribute that is no field."""
    if unknown := values.keys() - type(record).model_fields.keys():
        raise KeyError(f"{type(record).__name__} has no {', '.join(sorted(unknown))}")
    return BaseModel.model_copy(record, update=values)


def named(given: object, name: str) -> object:
    """A table or a model with a name, unless it has one."""
    match given:
        case dict():
            return {"name": name, **given}
        case Model() if not getattr(given, "name", "is not named"):
            return altered(given, {"name": name})
        case _:
            return given


def with_default(table: dict[str, Any], key: str, source: str) -> dict[str, Any]:
    """A table with `key` taken from its key `source` if it has that one only."""
    return {**table, key: table[source]} if key not in table and source in table else table


PLAIN = "(plain)"


def form_of(given: object, *tables: type[Model]) -> str:
    """The tag of the form in which a value is written: PLAIN, or the name of one of the tables in brackets, of the
    first one that has a key of what is written, else of the last."""
    if isinstance(given, dict):
        return f"({next((each for each in tables if given.keys() & each.model_fields.keys()), tables[-1]).__name__})"
    return f"({type(given).__name__})" if type(given) in tables else PLAIN


def _frozen(model: Model | type[Model], *names: str) -> FrozenError:
    """The error of a change of a model, with the remedy."""
    kind = (model if isinstance(model, type) else type(model)).__name__
    problem = "cannot be set so: a case is frozen, and all of its keys are checked together."
    return FrozenError("case", tuple(Fault(f"{kind}.{name}", "", None, problem, REMEDY) for name in names or ("*",)))


_NUMBER_AND_UNIT = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*\S.*$"
_NUMBER_ONLY = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*%?\s*$"
LABEL_LENGTH = 200
# Limit of any quantity in SI; larger values come from a wrong unit and would overflow.
LARGEST = 1e15
SMALLEST = 1e-15


class Reader(ABC):
    """Reads a value of a model as a user writes it, and holds SI."""

    @abstractmethod
    def read(self, given: object) -> Any:
        """The value. Raises ValueFault."""

    def __get_pydantic_core_schema__(self, _source: Any, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


@dataclass(frozen=True)
class Quantity(Reader):
    """A float in SI. unit: as in `frbcli.units.quantity`; above, below: exclusive; least, most: inclusive bounds."""

    unit: str
    example: str
    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None

    def read(self, given: object) -> float:
        """The SI value of `given`. Raises ValueFault if it is no such quantity or out of bounds."""
        value = quantity(given, self.unit, self.example)
        if value and not SMALLEST <= abs(value) <= max(LARGEST, self.most or 0.0):
            raise ValueFault(f"is {display(value, self.unit)}, which is out of range.", self.as_remedy())
        for bad, words, bound in (
            (self.above is not None and value <= self.above, "greater than", self.above),
            (self.least is not None and value < self.least, "at least", self.least),
            (self.below is not None and value >= self.below, "less than", self.below),
            (self.most is not None and value > self.most, "at most", self.most),
        ):
            if bad and bound is not None:
                limit = "0" if bound == 0.0 else display(bound, self.unit)
                raise ValueFault(f"is {self._beside(value, bound)}, but must be {words} {limit}.", self.as_remedy())
        return value

    def _beside(self, value: float, bound: float) -> str:
        """A value that violates a bound, in words: with all of its digits where both print alike."""
        shown = display(value, self.unit)
        if value == bound or shown != display(bound, self.unit):
            return shown
        return repr(value) if self.unit == NUMBER else f"{value!r} {readable(self.unit)}"

    def as_remedy(self) -> str:
        """The remedy, with an example."""
        return f"Write e.g. {self.written_example()}."

    def written_example(self) -> str:
        """The example as written in a case file."""
        return self.example if self.unit == NUMBER else f'"{self.example}"'

    def __get_pydantic_json_schema__(self, _schema: CoreSchema, _handler: GetJsonSchemaHandler) -> dict[str, Any]:
        bare = self.unit == NUMBER
        unit = "K" if self.unit == TEMPERATURE_DIFFERENCE else self.unit
        number: dict[str, Any] = {"type": "number", "description": "without unit" if bare else f"in {unit}"}
        bounds = {"exclusiveMinimum": self.above, "minimum": self.least,
                  "exclusiveMaximum": self.below, "maximum": self.most}  # fmt: skip
        number |= {key: _plain(bound) for key, bound in bounds.items() if bound is not None}
        text = {
            "type": "string",
            "description": "a number, or per cent" if bare else f"number and unit, taken to {unit}",
            "pattern": _NUMBER_ONLY if bare else _NUMBER_AND_UNIT,
            "examples": [self.example],
        }
        return {"description": "a plain number" if bare else f"a quantity in {unit}", "anyOf": [number, text]}


def unit_of(field: FieldInfo) -> str | None:
    """The SI unit of the quantities in a field, `NUMBER` for plain numbers; None if it holds none."""
    kinds = (part for part in (*field.metadata, *_annotated(field.annotation)) if isinstance(part, Quantity))
    first = next(kinds, None)
    return None if first is None else first.unit


def _annotated(annotation: Any) -> Iterator[Any]:
    for part in get_args(annotation):
        yield part
        yield from _annotated(part)


@dataclass(frozen=True)
class Count(Reader):
    """A whole number from `least` to `most`."""

    least: int
    most: int
    example: int

    def read(self, given: object) -> int:
        """The number. Raises ValueFault if it is none of these."""
        if isinstance(given, int) and not isinstance(given, bool) and self.least <= given <= self.most:
            return given
        raise ValueFault(f"is not a whole number from {self.least} to {self.most}.", f"Write e.g. {self.example}.")

    def written_example(self) -> str:
        """A value as written in a case file."""
        return str(self.example)

    def __get_pydantic_json_schema__(self, _schema: CoreSchema, _handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"type": "integer", "minimum": self.least, "maximum": self.most, "examples": [self.example]}


def _plain(bound: float) -> float:
    """A bound as people write it: 0, not 0.0."""
    return int(bound) if float(bound).is_integer() else bound


def _printable(text: str) -> str:
    if len(text) > LABEL_LENGTH or not text.isprintable():
        raise ValueFault(f"is not one line of at most {LABEL_LENGTH} printable characters.", "Shorten it.")
    return text


def _identifier(text: str) -> str:
    if not re.fullmatch(r"[A-Za-z0-9_-]{0,40}", text):
        raise ValueFault("is not a valid name.", "Use letters, digits, - and _, 40 at most.")
    return text


Label = Annotated[str, AfterValidator(_printable)]
Identifier = Annotated[str, AfterValidator(_identifier)]

# Limits of sizes and masses, well above the largest machines: rotors of 500 t and 80 m.
LONGEST, HEAVIEST = 1e3, 1e7  # m, kg
MOST_INERTIA, MOST_UNBALANCE = 1e9, 1e5  # kg m^2, kg m

Length = Annotated[float, Quantity("m", "20 mm", above=0, most=LONGEST)]
Play = Annotated[float, Quantity("m", "0.1 mm", least=0, most=LONGEST)]
Offset = Annotated[float, Quantity("m", "10 um", least=0, most=LONGEST)]
Clearance = Annotated[float, Quantity("m", "35 um", above=0, most=LONGEST)]
Position = Annotated[float, Quantity("m", "80 mm", least=-LONGEST, most=LONGEST)]
InnerDiameter = Annotated[float, Quantity("m", "8 mm", least=0, most=LONGEST)]
Mass = Annotated[float, Quantity("kg", "6 kg", above=0, most=HEAVIEST)]
ShellMass = Annotated[float, Quantity("kg", "2 kg", least=0, most=HEAVIEST)]
RingMass = Annotated[float, Quantity("kg", "30 g", above=0, most=HEAVIEST)]
JournalMass = Annotated[float, Quantity("kg", "100 g", above=0, most=HEAVIEST)]
Inertia = Annotated[float, Quantity("kg*m^2", "20 kg*mm^2", least=0, most=MOST_INERTIA)]
RotorInertia = Annotated[float, Quantity("kg*m^2", "2e-4 kg*m^2", above=0, most=MOST_INERTIA)]
RingInertia = Annotated[float, Quantity("kg*m^2", "20 kg*mm^2", above=0, most=MOST_INERTIA)]
Unbalance = Annotated[float, Quantity("kg*m", "3 g*mm", least=0, most=MOST_UNBALANCE)]
Stiffness = Annotated[float, Quantity("N/m", "5000 N/mm", above=0)]
Damping = Annotated[float, Quantity("N*s/m", "1 N*s/m", least=0)]
Acceleration = Annotated[float, Quantity("m/s^2", "9.81 m/s^2", least=0)]
Force = Annotated[float, Quantity("N", "29.9 N", above=0)]
Modulus = Annotated[float, Quantity("Pa", "210 GPa", least=1e6)]  # 210 is no GPa
Viscosity = Annotated[float, Quantity("Pa*s", "12 mPa*s", above=0, most=10.0)]  # neither MPa*s nor a bare 12
KinematicViscosity = Annotated[float, Quantity(KINEMATIC, "46 cSt", above=0)]
Flow = Annotated[float, Quantity("m^3/s", "0.2 l/min", above=0)]
Density = Annotated[float, Quantity("kg/m^3", "850 kg/m^3", above=0)]
OilDensity = Annotated[float, Quantity("kg/m^3", "850 kg/m^3", least=10, most=2e4)]  # 0.85 was meant in g/cm^3
Temperature = Annotated[float, Quantity("K", "100 degC", above=0)]
VogelOffset = Annotated[float, Quantity(TEMPERATURE_DIFFERENCE, "-180 K")]
TemperatureDifference = Annotated[float, Quantity(TEMPERATURE_DIFFERENCE, "900 K")]
HeatCapacity = Annotated[float, Quantity("J/K", "100 J/K", above=0)]
Conductance = Annotated[float, Quantity("W/K", "5 W/K", least=0)]
SpecificHeat = Annotated[float, Quantity("J/(kg*K)", "2000 J/(kg*K)", above=0)]
ThermalConductivity = Annotated[float, Quantity("W/(m*K)", "0.14 W/(m*K)", above=0)]
Expansion = Annotated[float, Quantity("1/K", "1.2e-5 1/K", least=0, below=1e-2)]
_TURN = 2.0 * math.pi * (1.0 + 1e-9)
Angle = Annotated[float, Quantity(ANGLE, "15 deg", least=-_TURN, most=_TURN)]  # 90 is no 90 deg
OpeningAngle = Annotated[float, Quantity(ANGLE, "15 deg", above=0, below=6.28)]
Speed = Annotated[float, Quantity(SPEED, "300 Hz", least=0)]
TopSpeed = Annotated[float, Quantity(SPEED, "1000 Hz", above=0)]
FirstSpeed = Annotated[float, Quantity(SPEED, "0 Hz")]
SignedSpeed = Annotated[float, Quantity(SPEED, "20 Hz")]
Duration = Annotated[float, Quantity("s", "10 s", above=0)]
DampingTime = Annotated[float, Quantity("s", "1e-5 s", least=0)]
DampingRate = Annotated[float, Quantity("1/s", "20 1/s", least=0)]
Hold = Annotated[float, Quantity("s", "0.5 s", least=0)]
Eccentricity = Annotated[float, Quantity(NUMBER, "0.5", least=0, below=1)]
Displacement = Annotated[float, Quantity(NUMBER, "-0.5", above=-1, below=1)]
Fraction = Annotated[float, Quantity(NUMBER, "0.5", least=0, most=1)]
Tilt = Annotated[float, Quantity(ANGLE, "0.1 mrad")]
TiltRate = Annotated[float, Quantity(ANGULAR_RATE, "0.5 rad/s")]
Velocity = Annotated[float, Quantity("m/s", "0.01 m/s")]
Rate = Annotated[float, Quantity("1/s", "25 1/s")]
GrooveCurvature = Annotated[float, Quantity(NUMBER, "0.52", above=0.5, most=0.7)]
ContactAngle = Annotated[float, Quantity(ANGLE, "15 deg", above=0, below=1.4)]
PreloadForce = Annotated[float, Quantity("N", "50 N", least=0)]
FrictionFactor = Annotated[float, Quantity(NUMBER, "0.001", least=0)]
PoissonRatio = Annotated[float, Quantity(NUMBER, "0.3", least=0, below=0.5)]
Preload = Annotated[float, Quantity(NUMBER, "0.5", least=0, below=1)]
RiseTime = Annotated[float, Quantity("s", "10 ms", least=0)]
Roughness = Annotated[float, Quantity("m", "0.5 um", above=0, most=1e-4)]
SummitHeight = Annotated[float, Quantity("m", "0.6 um", least=0, most=1e-4)]
SummitDensity = Annotated[float, Quantity("1/m^2", "1e10 1/m^2", above=0)]
BoundaryFriction = Annotated[float, Quantity(NUMBER, "0.1", least=0, most=1)]
WearCoefficient = Annotated[float, Quantity(NUMBER, "1e-7", above=0, most=1)]
Ratio = Annotated[float, Quantity(NUMBER, "0.1", least=0)]
