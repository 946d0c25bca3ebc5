"""The base of all models of a case: frozen, without unknown keys."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from frbcli.errors import Fault, FrozenError

REMEDY = 'Write case.with_settings("oil.viscosity = 50 mPa*s"), with the key of a case file.'

Record = TypeVar("Record", bound="Model")


class Model(BaseModel):
    """One table of a case file.

    A part of a case cannot be changed by itself: its attributes are not all keys of the case file, and the rules that
    tie keys together would not be checked. `Case.with_settings` gives a case with other values.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=False, validate_default=False)

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


def altered(record: Record, values: Mapping[str, Any]) -> Record:
    """`record` with values that the program has computed, in SI, by their attributes. They are not checked; values of a
    user are set by `Case.with_settings`. Raises KeyError for an attribute that is no field."""
    if unknown := values.keys() - type(record).model_fields.keys():
        raise KeyError(f"{type(record).__name__} has no {', '.join(sorted(unknown))}")
    return BaseModel.model_copy(record, update=values)


def with_default(data: object, key: str, source: str) -> object:
    """`data` with `key` taken from its key `source` if it has that one only; anything but a table as it is."""
    if isinstance(data, dict) and key not in data and source in data:
        return {**data, key: data[source]}
    return data


def _frozen(model: Model | type[Model], *names: str) -> FrozenError:
    """The error of a change of a model, with the remedy."""
    kind = (model if isinstance(model, type) else type(model)).__name__
    problem = "cannot be set so: a case is frozen, and all of its keys are checked together."
    return FrozenError("case", tuple(Fault(f"{kind}.{name}", "", None, problem, REMEDY) for name in names or ("*",)))
