"""The shipped cases, and the hard ones: shipped cases with settings at the limits of models and numerics."""

from __future__ import annotations

import shlex
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TYPE_CHECKING

from frbcli.errors import Fault, InputError, did_you_mean

if TYPE_CHECKING:
    from frbcli.case.schema import Case


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


LIST = "hard-cases.toml"
WITHIN_s = 600.0  # compilation included, where nothing is compiled yet


@dataclass(frozen=True)
class HardCase:
    """One hard case and how it ends.

    topic: the group that it belongs to; hard: its difficulty; command: "runup", "rundown", "rotation", "squeeze"
    or "whirl"; base: a shipped case; settings: KEY=VALUE each. end: expected status, "input-error" for a
    case that is refused; why: the cause of an early end; says: words that its message must have;
    events: the kinds of all events in their order, with the film's name if there are several, None if they do not
    matter; fine: settings of the reference, () for none; quick: whether it takes a second or so; within_s:
    limit of the wall time.
    """

    name: str
    topic: str
    hard: str
    base: str
    end: str
    command: str = "runup"
    settings: tuple[str, ...] = ()
    why: str = ""
    says: str = ""
    events: tuple[str, ...] | None = None
    fine: tuple[str, ...] = ()
    quick: bool = False
    within_s: float = WITHIN_s

    @property
    def words(self) -> str:
        """The equivalent command line."""
        return shlex.join(["frb", self.command, self.base, *(w for text in self.settings for w in ("--set", text))])

    def case(self, fine: bool = False) -> Case:
        """Its case, or the case of its reference. Raises InputError if it is refused."""
        from frbcli.case.reading.load import load_case  # which finds shipped cases here

        return load_case(self.base, (*self.settings, *(self.fine if fine else ())))


def hard_cases(names: Sequence[str] = ()) -> tuple[HardCase, ...]:
    """The hard cases of these names, all of them for (). Raises InputError for unknown names."""
    entries = tomllib.loads(hard_folder().joinpath(LIST).read_text(encoding="utf-8"))["case"]
    listed = ("settings", "events", "fine")
    cases = {
        entry["name"]: HardCase(**entry | {key: tuple(entry[key]) for key in listed if key in entry})
        for entry in entries
    }
    if unknown := [name for name in names if name not in cases]:
        remedies = ((name, did_you_mean(name, cases, "`frb cases --hard` lists them.")) for name in unknown)
        raise InputError("hard cases", tuple(Fault("NAME", name, None, "is no hard case.", r) for name, r in remedies))
    return tuple(cases[name] for name in names) if names else tuple(cases.values())


def hard_folder() -> Traversable:
    """Where the hard cases lie."""
    return shipped_folder().joinpath("hard")
