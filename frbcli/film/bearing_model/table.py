"""The bearing models of this process; a program that nobody has added one to has none."""

from __future__ import annotations

from frbcli.film.bearing_model.model import BearingModel

_own: dict[str, BearingModel] = {}


def models() -> tuple[BearingModel, ...]:
    """All models, in the order in which they were added."""
    return tuple(_own.values())


def model_named(name: str) -> BearingModel:
    """The model of this name. Raises KeyError if this process has none."""
    return _own[name]


def label_of(name: str) -> str:
    """The model as pictures call it; one that a run names and this process does not know by its name."""
    return _own[name].label if name in _own else name


def add(model: BearingModel) -> None:
    """Add a model that has been checked, or replace one that was added before."""
    _own[model.name] = model


def remove(name: str) -> None:
    """Take a model away. Raises KeyError for one that was not added."""
    del _own[name]
