"""The cavitation laws in a case file: film.cavitation takes their names, [film.NAME] the keys that they declare."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, create_model
from pydantic.fields import FieldInfo

from frbcli.case.model import Model
from frbcli.case.quantities import Quantity
from frbcli.film.cavitation import table
from frbcli.film.cavitation.law import Key, Law
from frbcli.units import NUMBER

if TYPE_CHECKING:
    Cavitation = str
else:
    Cavitation = Literal[table.names()]

CAVITATION = "cavitation"  # the key that takes the name of a law


class LawTable(Model):
    """A table [film.NAME], made from the keys of a law."""


def attribute(law: type[Law]) -> str:
    """The attribute of a FilmModel that holds the table of a law."""
    return law.name.replace("-", "_")


def adopt(film: type[Model], others: Iterable[type[Model]] = ()) -> None:
    """Give the model of [film] the table of every law that has keys and of no other, and its `cavitation`, and that of
    `others`, the names of all laws. Models that hold one of these have to be rebuilt by the caller."""
    fields = film.__pydantic_fields__
    for name in [name for name, field in fields.items() if isinstance(field.default, LawTable)]:
        del fields[name]
    fields |= {attribute(law): _table_field(law) for law in table.laws() if law.keys}
    for model in (film, *others):
        its = model.__pydantic_fields__[CAVITATION]
        names: Any = Literal[table.names()]
        its.annotation = names if its.default is not None else names | None
        model.model_rebuild(force=True)


def __getattr__(name: str) -> Any:
    """The model of the table of the law whose class has this name: where copies of a case find it."""
    law: Any
    for law in table.laws():
        if law.__name__ == name and law.keys:
            return _table(law)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@cache
def _table(law: Any) -> type[LawTable]:
    entries = declared(law.keys)
    return create_model(law.__name__, __base__=LawTable, __doc__=law.meaning, __module__=__name__, **entries)


def _table_field(law: type[Law]) -> FieldInfo:
    its: Any = law
    model = _table(its)
    alias = None if attribute(law) == law.name else law.name
    told = f"keys of the model {law.label}"
    return FieldInfo.from_annotated_attribute(model, Field(default=model(), alias=alias, description=told))


def declared(keys: Iterable[Key]) -> dict[str, Any]:
    """Type and default of each key by its name, as a model takes them."""
    return {key.name: _entry(key) for key in keys}


def _entry(key: Key) -> Any:
    """Type and default of a key, as a model takes them."""
    kind: Any = Literal[key.choices]
    if not key.choices:
        unit = key.unit or NUMBER
        kind = Annotated[float, Quantity(unit, key.example, key.above, key.least, key.below, key.most)]
    if key.default is None:
        kind = kind | None
    return kind, Field(default=key.default, description=key.meaning or None)
