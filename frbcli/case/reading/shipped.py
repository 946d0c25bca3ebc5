"""The shipped cases."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path

from frbcli.errors import Fault, InputError, did_you_mean


def shipped_cases() -> dict[str, str]:
    """List the shipped cases.

    Returns
    -------
    dict of str to str
        Their names, sorted, with their titles.

    Examples
    --------
    >>> import frbcli
    >>> "jeffcott" in frbcli.shipped_cases()
    True
    """
    return {name: str(tomllib.loads(_text(name)).get("title", "")) for name in shipped_names()}


def find_shipped(name: str) -> str:
    """The text of the shipped case `name`. Raises InputError, which suggests the nearest name, if there is none."""
    if name not in shipped_names():
        raise InputError(name, (Fault("CASE", name, None, "is not a shipped case.", nearest(name)),))
    return _text(name)


def shipped_names() -> tuple[str, ...]:
    """The names of the shipped cases, sorted."""
    files_there = (entry.name for entry in shipped_folder().iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in files_there if name.endswith(".toml")))


def nearest(name: str) -> str:
    """A remedy for an unknown name."""
    close = did_you_mean(name, shipped_names(), "`frb cases` lists the shipped cases.")
    return close.replace("Did you mean", "Did you mean the shipped case")


def _text(name: str) -> str:
    return shipped_folder().joinpath(f"{name}.toml").read_text(encoding="utf-8")


def shipped_folder() -> Traversable:
    """Their directory: inside an installed package; next to the package in a checkout or an editable installation."""
    package = files("frbcli")
    installed = package.joinpath("shipped_cases")
    return installed if installed.is_dir() else Path(str(package)).parent / "cases"
