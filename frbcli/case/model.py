"""The base of all models of a case: frozen, without unknown keys."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Model(BaseModel):
    """One table of a case file."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=False, validate_default=False)


def with_default(data: object, key: str, source: str) -> object:
    """`data` with `key` taken from its key `source` if it has that one only; anything but a table as it is."""
    if isinstance(data, dict) and key not in data and source in data:
        return {**data, key: data[source]}
    return data
