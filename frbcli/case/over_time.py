"""Values over time: tables that were read from a file, and inputs, which are one value or such a table.

Places of a machine that forces can act on, and tables of a case with the rules that tie them to its machine.
"""

from __future__ import annotations

import itertools
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from frbcli.case.model import LABEL_LENGTH, Label, Model, Quantity, Reader
from frbcli.case.reading.tables import Breach, Path, pairs
from frbcli.errors import did_you_mean
from frbcli.units import NUMBER, ValueFault, quantity

if TYPE_CHECKING:
    from frbcli.case.schema import Case


OVER_TIME = "over time"  # a form of an input in the schema
Entry = Annotated[float, Quantity(NUMBER, "0.5")]


class OverTime(Model):
    """Values over time in SI, linear in between."""

    source: Label = Field(default="", description="file they were read from")
    time: tuple[Entry, ...] = Field(description="in s, ascending")
    x: tuple[Entry, ...] = Field(description="in x, or of the one quantity")
    y: tuple[Entry, ...] = Field(default=(), description="in y; default: as x")

    @property
    def both(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The values in x and in y."""
        return self.x, self.y or self.x

    @property
    def origin(self) -> str:
        """Where it is from, in words."""
        return f"{len(self.time)} rows of {self.source}" if self.source else f"{len(self.time)} rows"


def over_time_problem(time: Sequence[float], *columns: Sequence[float], over: str = "time", unit: str = "s") -> str:
    """What is wrong with the numbers of a table over time, or over something else in another unit; "" if nothing."""
    if any(len(column) not in (0, len(time)) for column in columns) or len(time) < 2:
        return f"needs at least two {over}s, and a value at each of them."
    for row, (earlier, later) in enumerate(itertools.pairwise(time), start=2):
        if later <= earlier:
            return f"has {over}s that do not rise: {later:.9g} {unit} in row {row} after {earlier:.9g} {unit}."
    return ""


def largest(value: float | OverTime) -> float:
    """The value of an input, or the largest one of its table, which all analyses but runs use."""
    return max(value.x) if isinstance(value, OverTime) else value


def first(value: float | OverTime) -> float:
    """The value of an input, or the first one of its table, with which a run starts."""
    return value.x[0] if isinstance(value, OverTime) else value


def is_over_time(given: object) -> bool:
    """Whether an input, as it was written, is a table over time."""
    return isinstance(given, list) or (isinstance(given, dict) and bool(given.keys() & {"file", "time", "x"}))


def values_of(given: object, unit: str) -> tuple[float, ...]:
    """SI values of an input as it was written, of a table all; none where it cannot be read."""
    try:
        if isinstance(given, dict):
            return tuple(_numbers(given.get("x", ())))
        return tuple(quantity(each[1], unit) for each in given) if isinstance(given, list) else (quantity(given, unit),)
    except (ValueFault, TypeError, IndexError, KeyError):
        return ()


@dataclass(frozen=True)
class Input(Reader):
    """An input of a machine: a quantity, or times with quantities, or the numbers of a file as an OverTime."""

    quantity: Quantity

    @property
    def remedy(self) -> str:
        """An example of a table."""
        value = self.quantity.written_example()
        return f'Write e.g. [["0 s", {value}], ["1 s", {value}]], or {{ file = "input.csv" }}.'

    def read(self, given: object) -> float | OverTime:
        """The SI value or table. Raises ValueFault."""
        match given:
            case OverTime():
                return self._checked(given.source, given.time, given.x)
            case dict():
                if not {"time", "x"} <= given.keys() <= {"time", "x", "source"}:
                    raise ValueFault("is neither a quantity nor a table over time.", self.remedy)
                return self._checked(str(given.get("source", "")), *(_numbers(given[key]) for key in ("time", "x")))
            case list() | tuple():
                if (columns := pairs(given)) is None:
                    raise ValueFault("is no list of times with values.", self.remedy)
                return self._checked("", [quantity(time, "s") for time in columns[0]], [*map(self._one, columns[1])])
            case _:
                return self.quantity.read(given)

    def _one(self, given: object) -> float:
        try:
            return self.quantity.read(given)
        except ValueFault as fault:
            raise ValueFault(f"has a value that {fault.problem}", self.remedy) from None

    def _checked(self, source: str, time: Sequence[float], x: Sequence[float]) -> OverTime:
        if problem := over_time_problem(time, x) or ("" if x else over_time_problem(())):
            raise ValueFault(problem, self.remedy)
        if not source.isprintable() or len(source) > LABEL_LENGTH:
            raise ValueFault("has a source that is not one line of text.", "Name the file that it was read from.")
        return OverTime(source=source, time=tuple(time), x=tuple(map(self._one, x)))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        one = self.quantity.__get_pydantic_json_schema__(schema, handler)
        pair = {"type": "array", "minItems": 2, "maxItems": 2}
        points = {"type": "array", "items": pair, "minItems": 2, "description": "times with values"}
        file = {"type": "object", "description": "a file with the columns time and value: { file = ... }"}
        table = {"description": OVER_TIME, "anyOf": [points, file]}
        description, examples = f"{one['description']}, or {OVER_TIME}", [self.quantity.example]
        return {"description": description, "examples": examples, "anyOf": [one, table]}


def _numbers(given: object) -> list[float]:
    if not isinstance(given, list | tuple):
        raise ValueFault("is no list of numbers.", "Write the numbers of the table in SI.")
    return [quantity(each, NUMBER) for each in given]


PRESSURE = Quantity("Pa", "1 bar", above=0)
TEMPERATURE = Quantity("K", "100 degC", above=0)
InputPressure = Annotated[float | OverTime, PRESSURE, Input(PRESSURE)]
InputTemperature = Annotated[float | OverTime, TEMPERATURE, Input(TEMPERATURE)]


def places(case: Case) -> tuple[str, ...]:
    """The nodes of the machine of a case, as its runs name them."""
    rotor, nodes = case.rotor, []
    if rotor.symmetric:
        nodes += ["journal"] if rotor.kind == "rigid" else ["journal", "disk"]
    else:
        nodes += [f"journal_{bearing.name}" for bearing in case.placed_bearings]
        nodes += [f"disk_{disk.name or number}" for number, disk in enumerate(case.disks, start=1)]
    for bearing in case.placed_bearings:
        if bearing.kind == "floating-ring":
            nodes.append(f"ring_{bearing.name}".rstrip("_"))
        if bearing.damper is not None:
            nodes.append(f"shell_{bearing.name}".rstrip("_"))
        if bearing.support is not None:
            nodes.append(f"support_{bearing.name}".rstrip("_"))
    if case.housing is not None:
        nodes += () if case.housing.modes and not rotor.symmetric else ("housing",)
        nodes += () if rotor.symmetric else [f"housing_{bearing.name}" for bearing in case.placed_bearings]
    return tuple(nodes)


def node_at(case: Case, at: str) -> str:
    """The node of a place: a node itself, or the journal of a bearing or the disk of a name; "" if there is none, or if
    both a bearing and a disk have the name."""
    known = places(case)
    if at in known:
        return at
    named = [node for node in (f"journal_{at}", f"disk_{at}") if node in known]
    return named[0] if len(named) == 1 else ""


def no_place(case: Case, at: str) -> tuple[str, str]:
    """Problem and remedy of a place that the machine does not have."""
    both = f"journal_{at}" in places(case)
    return "is both a bearing and a disk." if both else "is no place of the machine.", did_you_mean(at, places(case))


def table_breaches(path: Path, given: Model, table: OverTime, others: tuple[str, ...]) -> Iterator[Breach]:
    """Rules of a table over time together with other keys that say how a load changes."""
    extra = [key for key in others if key in given.model_fields_set]
    if extra:
        yield Breach((*path, extra[0]), "is given with file.", "Keep one of the two.")
    problem = over_time_problem(table.time, *table.both)
    if problem:
        yield Breach((*path, "over_time"), problem, "Order its rows by rising times.")


class MachineTable(Model):
    """A table of a case, or one of several with the same key, that has no effect without a rotor."""

    alone: ClassVar[bool] = False  # a single one has no number in its key

    @abstractmethod
    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        """Every rule that it breaks in a case with a rotor. path: its key in the case file, with its number."""


def machine_breaches(case: Case) -> Iterator[Breach]:
    """Every rule that tables of this kind break in a case."""
    for name, field in type(case).model_fields.items():
        given, key = getattr(case, name), field.alias or name
        for number, table in enumerate(given if isinstance(given, tuple) else (given,)):
            if isinstance(table, MachineTable):
                single = table is given or (table.alone and len(given) == 1)
                path: Path = (key,) if single else (key, number)
                if case.given_rotor is None:
                    yield Breach(path, "has no effect: a kinematic test moves its journal.", "Remove it.")
                else:
                    yield from table.breaches(case, path)
