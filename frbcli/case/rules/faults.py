"""Validation errors of the models, as faults with a remedy in the terms of the case file."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from frbcli.case.model import Model
from frbcli.case.quantities import Count, Quantity
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import at
from frbcli.case.rules.checks import Breach
from frbcli.case.schema import Case
from frbcli.nearest import did_you_mean, nearest
from frbcli.units import ValueFault

_FORMS = {
    "string_type": ("is not text.", "Write it in quotes."),
    "string_unicode": ("is not text.", "Write plain letters."),
    "model_type": ("is not a table.", "Write its keys below a header in brackets."),
    "model_attributes_type": ("is not a table.", "Write its keys below a header in brackets."),
    "tuple_type": ("is not a list.", "Write it in brackets: [ , ]."),
    "too_short": ("has too few entries.", "Add what is missing."),
    "too_long": ("has too many entries.", "Remove the surplus."),
}


# Keys that take names which are added from Python, and the functions that add them.
OWN: dict[Path, str] = {("film", "theory"): "frbcli.add_bearing", ("film", "cavitation"): "frbcli.add_law"}

BY_PLACE: tuple[Path, ...] = (("masses",), ("at",))  # tables by places, which are lists in the case


@dataclass(frozen=True)
class _Place:
    """Where an error belongs: the model that owns the key, and the field of the key if there is one."""

    models: tuple[type[Model], ...]
    field: FieldInfo | None


def objections(error: ValidationError, data: dict[str, Any]) -> Iterator[Breach]:
    """Each error of the models in `data`, with the path of its key in the file."""
    details = [(_path(detail["loc"], data), detail) for detail in error.errors(include_url=False)]
    # a value that was taken over from another key is not present, and that key has the same fault
    own = [(path, detail) for path, detail in details if detail["type"] == "missing" or at(data, path) is not None]
    for path, detail in own or details:
        yield _breach(path, detail["loc"], detail["type"], {"input": detail["input"], **detail.get("ctx", {})})


def with_nearest_kinds(error: ValidationError, data: dict[str, Any]) -> dict[str, Any]:
    """`data` with each misspelt `kind` replaced by the nearest known, so that the rest of its table is read, too."""
    guess = copy.deepcopy(data)
    for detail in error.errors(include_url=False):
        if detail["type"] != "union_tag_invalid":
            continue
        table: Any = guess
        for element in _path(detail["loc"], data):
            table = table[element]
        close = _close(str(detail["ctx"]["tag"]), _kinds(detail["loc"]))
        table["kind"] = close or table["kind"]
    return guess


def _path(loc: Sequence[str | int], data: Any) -> Path:
    """The path in the file; the models' own additions to it (the kind of a table, index 0 of a single one) left out."""
    path: Path = ()
    kind_seen = False
    for element in loc:
        if isinstance(element, str) and element.startswith("("):
            continue
        if isinstance(data, dict):
            if isinstance(element, int) and path[-1:] in BY_PLACE and element < len(data):
                path = (*path, list(data)[element])
                data = data[path[-1]]
                continue
            if isinstance(element, int):
                continue
            if not kind_seen and element == data.get("kind"):
                kind_seen = True
                continue
        if path[-2:-1] in BY_PLACE and isinstance(element, str) and not isinstance(data, dict):
            continue  # the value itself, which a table by places has without its name
        if isinstance(element, int) and isinstance(data, str | int | float):
            continue  # one quantity that stands for a matrix
        path = (*path, element)
        kind_seen = False
        data = at(data, (element,))
    return path


def _breach(path: Path, loc: Sequence[str | int], kind: str, context: dict[str, Any]) -> Breach:
    cause = context.get("error")
    if isinstance(cause, ValueFault):
        return Breach(path, cause.problem, cause.remedy)
    if kind == "missing":
        return Breach(path, "is missing.", _how_to_add(path, _place(loc).field))
    if kind == "extra_forbidden":
        return Breach(path, "is not known here.", _nearest(str(loc[-1]), _place(loc[:-1]).models))
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        problem = "is missing." if kind == "union_tag_not_found" else "is not known here."
        return Breach((*path, "kind"), problem, _one_of(str(context.get("tag", "")), _kinds(loc)))
    if kind == "literal_error":
        remedy = _one_of(str(context["input"]), _choices(_place(loc).field))
        if path in OWN:
            remedy += f" One of your own is added in this process before the case is read: {OWN[path]}."
        return Breach(path, "is not known here.", remedy)
    field = _place(loc).field
    if kind == "tuple_type" and field is not None and _parts(field.annotation, Model):
        kind = "model_type"
    return Breach(path, *_FORMS.get(kind, ("has the wrong form.", "`frb schema` prints what a case holds.")))


def _place(loc: Sequence[str | int]) -> _Place:
    models: tuple[type[Model], ...] = (Case,)
    field: FieldInfo | None = None
    for element in loc:
        if isinstance(element, int) or element.startswith("("):
            continue
        if len(models) > 1:  # a table of several kinds, and this is its kind
            models = tuple(model for model in models if element in _choices(model.model_fields.get("kind")))
            continue
        fields = {key: field for model in models for key, field in _fields(model).items()}
        field = fields.get(element)
        models = _parts(field.annotation, Model) if field else ()
    return _Place(models, field)


def _fields(model: type[Model]) -> dict[str, FieldInfo]:
    """The fields of `model` by their keys in the file."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def _parts(annotation: Any, base: type[Any]) -> tuple[Any, ...]:
    """The parts of an annotation that derive from `base`: subclasses of it, or instances of it."""
    if isinstance(annotation, base) or (isinstance(annotation, type) and issubclass(annotation, base)):
        return (annotation,)
    return tuple(part for argument in get_args(annotation) for part in _parts(argument, base))


def _choices(field: FieldInfo | None) -> list[str]:
    if field is None:
        return []
    annotation = field.annotation
    forms = [annotation] if get_origin(annotation) is Literal else list(get_args(annotation))
    literals = [get_args(form)[0] if get_origin(form) is Annotated else form for form in forms]
    return [str(name) for literal in literals if get_origin(literal) is Literal for name in get_args(literal)]


def _kinds(loc: Sequence[str | int]) -> list[str]:
    return [name for model in _place(loc).models for name in _choices(model.model_fields.get("kind"))]


def _example(field: FieldInfo | None) -> str:
    """An example of a value as it stands in a file, or nothing."""
    if field is None:
        return ""
    for kind in (Quantity, Count):
        for example in (*field.metadata, *_parts(field.annotation, kind)):
            if isinstance(example, kind):
                return example.written_example()
    choices = _choices(field)
    return f'"{choices[0]}"' if choices else ""


def _how_to_add(path: Path, field: FieldInfo | None) -> str:
    if isinstance(path[-1], int):
        return "Give as many values as it has directions."
    example = _example(field)
    if example:
        return f"Add e.g. {path[-1]} = {example}."
    header = ".".join(part for part in path if isinstance(part, str))
    return f"Add the table [{header}]."


def _nearest(key: str, models: Sequence[type[Model]]) -> str:
    known = [name for model in models for name in _fields(model)]
    return did_you_mean(key, known, f"Known are: {', '.join(known)}.")


def _one_of(found: str, choices: Sequence[str]) -> str:
    return did_you_mean(found, choices)


def _close(found: str, choices: Sequence[str]) -> str:
    """The choice nearest to what was found, or nothing."""
    return next(iter(nearest(found, choices)), "")
