"""The cavitation laws that the films of a case file name, and the tables [film.NAME] of their keys."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, create_model
from pydantic.fields import FieldInfo

from frbcli.case.model import Model
from frbcli.case.quantities import Quantity
from frbcli.film.cavitation.law import Key, Law
from frbcli.film.cavitation.table import laws, names
from frbcli.units import NUMBER

THEORIES = ("auto", "short", "finite")
if TYPE_CHECKING:
    Cavitation = str
    Theory = str
else:
    Cavitation = Literal[names()]
    Theory = Literal[THEORIES]

CAVITATION = "cavitation"  # the key that takes the name of a law


class FilmTable(Model):
    """A table [film.NAME], made from the keys of a law."""


def attribute(of: type[Law]) -> str:
    """The attribute of a FilmModel that holds the table of a law."""
    return of.name.replace("-", "_")


def adopt(film: type[Model], others: Iterable[type[Model]] = ()) -> None:
    """Give the model of [film] the table of every law that has keys and of no other, and its `cavitation` and that of
    `others` the names of all laws. Models that hold one of these have to be rebuilt by the caller."""
    fields = film.model_fields
    for name in [name for name, field in fields.items() if isinstance(field.default, FilmTable)]:
        del fields[name]
    for of in _with_keys():
        alias = None if attribute(of) == of.name else of.name
        made = Field(default=_table(of)(), alias=alias, description="keys of this model")
        fields[attribute(of)] = FieldInfo.from_annotated_attribute(_table(of), made)
    for model in (film, *others):
        its = model.model_fields[CAVITATION]
        all_laws: Any = Literal[names()]
        its.annotation = all_laws if its.default is not None else all_laws | None
        model.model_rebuild(force=True)


def __getattr__(name: str) -> Any:
    """The model of the table of this name: where copies of a case find it."""
    for of in _with_keys():
        if _table(of).__name__ == name:
            return _table(of)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def _with_keys() -> Iterator[Any]:
    return (law for law in laws() if law.keys)


@cache
def _table(of: Any) -> type[FilmTable]:
    entries: dict[str, Any] = {key.name: _entry(key) for key in of.keys}
    return create_model(of.__name__, __base__=FilmTable, __doc__=of.meaning, __module__=__name__, **entries)


def _entry(key: Key) -> Any:
    """Type and default of a key, as a model takes them."""
    kind: Any = Literal[key.choices]
    if not key.choices:
        unit = key.unit or NUMBER
        kind = Annotated[float, Quantity(unit, key.example, key.above, key.least, key.below, key.most)]
    if key.default is None:
        kind = kind | None
    return kind, Field(default=key.default, description=key.meaning or None)
