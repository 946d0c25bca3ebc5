"""Whether the films of a case can take a bearing model of this process, and the values that they give its keys."""

from __future__ import annotations

import math
import re
from typing import Any

from frbcli.case.film_tables import THEORIES, FilmTable, attribute
from frbcli.case.model import Model
from frbcli.errors import Fault, InputError
from frbcli.film.bearing_model.model import DIMENSIONS, BearingModel, wrong
from frbcli.film.cavitation.law import Key
from frbcli.film.cavitation.table import names as law_names

_NAME = re.compile("[a-z][a-z-]{0,39}")  # as pictures of a run read it
_PARAMETER = re.compile("[a-z][a-z0-9_]{0,39}")


def check_model(model: BearingModel, film: type[Model]) -> None:
    """Raises InputError unless a bearing model can be added; its functions are compiled here."""
    if not isinstance(model, BearingModel):
        fault = Fault("model", repr(model)[:80], None, "is not a BearingModel.", "Make one of frbcli.BearingModel.")
        raise InputError("bearing model", (fault,))
    if not (isinstance(model.name, str) and _NAME.fullmatch(model.name)):
        raise wrong(
            model, "name", "has other characters than small letters and -.", 'Write e.g. name = "squeeze-film-damper".'
        )
    others = {
        name: field
        for name, field in film.model_fields.items()
        if not isinstance(field.default, FilmTable)
    }  # fmt: skip
    reserved = {*THEORIES, *law_names(), *others, *(field.alias for field in others.values())}
    if {model.name, attribute(model)} & reserved:
        raise wrong(model, "name", "is already a key or model of the program.", "Choose another one.")
    if not isinstance(model.label, str) or not model.label.isprintable():
        raise wrong(model, "label", "is not text.", "Write the name of the model in pictures.")
    if not (isinstance(model.sheared, float | int) and 0.0 <= model.sheared <= 1.0):
        raise wrong(model, "sheared", "is no share of the gap.", "Write 1.0, or 0.0 for a journal that does not spin.")
    _check_keys(model)
    from frbcli.film.bearing_model.compiled import (  # numba takes longer to import than a case to read
        compiled_flow,
        compiled_model,
    )

    compiled_model(model)
    if model.flow is not None:
        compiled_flow(model)


def _check_keys(model: BearingModel) -> None:
    seen = set(DIMENSIONS)
    for key in model.keys:
        if not (isinstance(key, Key) and _PARAMETER.fullmatch(key.name)):
            raise wrong(model, "keys", "are not BearingKeys with names.", 'Write e.g. BearingKey("depth", 1.0).')
        if key.name in seen:
            remedy = "Choose another one: the record of the bearing has one field for each name."
            raise wrong(model, f"keys.{key.name}", "is already the name of another field.", remedy)
        seen.add(key.name)


def values_of(model: BearingModel, film: Any) -> tuple[float, ...]:
    """The values of the keys of a model in a FilmModel; a choice as its number from 0, NaN for what is not given.
    Raises InputError for a FilmModel that was made before the model was added."""
    if not model.keys:
        return ()
    try:
        given = getattr(film, attribute(model))
        return tuple(_number(key, getattr(given, key.name)) for key in model.keys)
    except (AttributeError, ValueError):
        problem = "does not have the keys of the bearing model: the case was read before the model was added."
        raise InputError("case", (Fault(f"film.{model.name}", "", None, problem, "Read the case again."),)) from None


def _number(key: Key, value: float | str | None) -> float:
    if value is None:
        return math.nan
    return float(key.choices.index(str(value)) if key.choices else value)
