"""From a file to a Case, or to all faults of the file."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from frbcli.case.model import Model
from frbcli.case.oil import with_grade
from frbcli.case.over_time import machine_breaches
from frbcli.case.reading.files import with_coefficient_files, with_housing_file
from frbcli.case.reading.ross import with_rotor_file
from frbcli.case.reading.settings import DEEPEST, TomlFault, as_tables, parse, to_toml, with_setting, with_value
from frbcli.case.reading.shipped import find_shipped, nearest, shipped_names
from frbcli.case.reading.tables import Path as KeyPath
from frbcli.case.reading.tables import at, has_table, key_lines
from frbcli.case.reading.time_tables import with_input_files, with_speed_points, with_time_tables
from frbcli.case.rules.checks import Breach, breaches
from frbcli.case.rules.faults import MISSING, UNKNOWN, objections, with_nearest_kinds
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.results.write import RUN_BEGINS, NoFile, NoText, Unreadable, begins_with, text_of

_Set = Callable[[Mapping[str, Any]], tuple[dict[str, Any], KeyPath]]  # sets one key; raises TomlFault

LARGEST_FILE = 262_144  # bytes; a case has some thousand
LONGEST_SHOWN = 150  # characters of a value or a path in a fault
LARGEST_SHOWN = 200  # bits of a whole number in a fault


def load_case(source: str | Path, settings: Sequence[str] = ()) -> Case:
    """Load the case in a file, or a shipped case by its name.

    Parameters
    ----------
    source : str or Path
        Path of a case file, or name of a shipped case, see `shipped_cases`.
    settings : sequence of str
        "key.path=value", as --set takes them; units are allowed.

    Returns
    -------
    Case
        The case, frozen, in SI.

    Raises
    ------
    InputError
        With every fault of file and settings.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["bearing.clearance=40 um"])
    >>> case.bearings[0].clearance
    4e-05
    """
    path = Path(source)
    text = _read(path)
    if text is None:
        text = _shipped(str(source))
    return load_case_text(text, settings, path.name.removesuffix(".toml"), str(source), path.parent)


def load_case_text(
    text: str, settings: Sequence[str] = (), name: str = "case", source: str = "", folder: str | Path = "."
) -> Case:
    """Make a case of the text of a case file.

    Parameters
    ----------
    text : str
        TOML with the keys of a case file.
    settings : sequence of str
        "key.path=value", as --set takes them.
    name : str
        Name of the case, if the text has none.
    source : str
        Name of the text in errors, `name` if not given.
    folder : str or Path
        Folder of rotor files and files of coefficients.

    Returns
    -------
    Case
        The case, frozen, in SI.

    Raises
    ------
    InputError
        With every fault of text and settings.

    Examples
    --------
    >>> import frbcli
    >>> text = frbcli.load_case("jeffcott").source_text
    >>> frbcli.load_case_text(text).name
    'jeffcott'
    """
    source = source or name
    try:
        data = parse(text)
    except TomlFault as error:
        raise InputError(source, (error.fault,)) from None
    data, overridden, faults = _apply(data, [functools.partial(with_setting, setting=setting) for setting in settings])
    case, data, flaws = _checked(data, name, folder)
    if flaws:
        faults += _located(flaws, data, overridden, text)
    if faults or case is None:
        raise _refused(source, faults)
    return case.with_source_text(to_toml(data))


def with_settings(case: Case, settings: Iterable[str | Mapping[str, object]]) -> Case:
    """As Case.with_settings, which is the way to call it."""
    applied: list[_Set] = []
    for given in settings:
        match given:
            case str():
                applied.append(functools.partial(with_setting, setting=given))
            case Mapping():
                applied += [functools.partial(_with_value, key=key, value=value) for key, value in given.items()]
            case _:
                problem, remedy = "is no setting.", 'Write "key = value" or {"key": value}.'
                raise case.refused(Fault("settings", str(type(given)), None, problem, remedy))
    data, overridden, faults = _apply(parse(case.source_text), applied)
    changed, data, flaws = _checked(data, case.name or "case", ".")
    faults += _located(flaws, data, overridden, "")
    if faults or changed is None:
        raise _refused(case.name or "case", faults)
    return changed.with_source_text(to_toml(data))


def case_from_dict(data: Mapping[str, Any], name: str = "case", folder: str | Path = ".") -> Case:
    """Make a case of tables that have the keys of a case file, checked as a file is.

    Parameters
    ----------
    data : mapping
        Nested mappings and sequences. Quantities are numbers in SI or text with a unit; a table may also be a model of
        `frbcli.case`; None: a key that is not given.
    name : str
        Name of the case, if the data have none.
    folder : str or Path
        Folder of rotor files and files of coefficients.

    Returns
    -------
    Case
        The case, frozen, in SI.

    Raises
    ------
    InputError
        With every fault of the data.

    Examples
    --------
    >>> import frbcli, tomllib
    >>> text = frbcli.load_case("jeffcott").source_text
    >>> case = frbcli.case_from_dict(tomllib.loads(text))
    >>> case.name
    'jeffcott'
    """
    try:
        tables = _plain(data)
    except TomlFault as error:
        raise InputError(name, (error.fault,)) from None
    if not isinstance(tables, dict):
        raise InputError(name, (Fault("data", "", None, "is not a dict.", "Give a table of the case's tables."),))
    case, tables, flaws = _checked(tables, name, folder)
    if flaws or case is None:
        raise _refused(name, _located(flaws, tables, (), ""))
    return case


def describes(text: str, case: Case) -> bool:
    """Whether `text`, perhaps of an older version, is of the machine and the run of `case`, however it is written."""
    try:
        return case.same_run(Case.model_validate(parse(text)))
    except (TomlFault, ValidationError):
        return False


def _checked(data: dict[str, Any], name: str, folder: str | Path) -> tuple[Case | None, dict[str, Any], list[Breach]]:
    """The case in `data`, None if there is none; its tables, with name and rotor file; all faults."""
    data, folder = data if "name" in data else {"name": _printable(name), **data}, Path(folder)
    data, unread = with_rotor_file(data, folder)
    data, unknown = with_coefficient_files(data, folder)
    data, unfit = with_time_tables(data, folder)
    data, no_modes = with_housing_file(data, folder)
    data, wrong = with_speed_points(data, folder)
    data, unread_inputs = with_input_files(data, folder)
    unfit += [*wrong, *unread_inputs, *no_modes]
    case, flaws = _validate(data)
    files = {breach.path[:-1] for breach in unread_inputs}
    flaws = [breach for breach in flaws if breach.path not in files]
    if wrong:  # from, to and duration would follow
        flaws = [breach for breach in flaws if breach.path[0] != "speed"]
    if case is not None and not (flaws or unfit):
        flaws = list(machine_breaches(case))
    if unread:  # what the file would have completed is no fault of the case
        flaws = [*unread, *(breach for breach in flaws if breach.path[0] != "disk")]
    return case, data, [*unknown, *unfit, *flaws]


def _refused(source: str, faults: Sequence[Fault]) -> InputError:
    return InputError(source, tuple(sorted(faults, key=lambda fault: (fault.line or LARGEST_FILE, fault.key))))


def _plain(value: Any, path: KeyPath = ()) -> Any:
    """`value` as a file would give it: tables, lists, text and numbers. Raises TomlFault."""
    if len(path) > DEEPEST:
        raise TomlFault(Fault(_dotted(path[:3]), "", None, "is nested too deeply.", "Write it as in a case file."))
    match value:
        case Model():
            return as_tables(value)
        case Mapping():
            return {str(key): _plain(item, (*path, str(key))) for key, item in value.items() if item is not None}
        case list() | tuple():
            return [_plain(item, (*path, number)) for number, item in enumerate(value)]
    return value.tolist() if hasattr(value, "tolist") else value  # numbers and arrays of numpy


def _read(path: Path) -> str | None:
    """The text of the regular file `path`, None if there is none. Raises InputError if it cannot be a case."""
    try:
        return text_of(path, LARGEST_FILE)
    except NoFile:
        return None
    except Unreadable as error:
        if begins_with(path, RUN_BEGINS):
            problem = "is a run file: `frb plot`, `frb waterfall` and `frb report` show it."
            raise _unreadable(path, problem, "Name a case.") from None
        remedy = "Name a case file, or save it as UTF-8." if isinstance(error, NoText) else "Name a case file."
        raise _unreadable(path, str(error), remedy) from None


def _shipped(source: str) -> str:
    name = source.removesuffix(".toml")
    if name in shipped_names():
        return find_shipped(name)
    if Path(source).exists():
        raise _unreadable(source, "is not a file.", f"Name a case file. {nearest(name)}")
    raise _unreadable(source, "is neither a file nor a shipped case.", nearest(name))


def _unreadable(source: str | Path, problem: str, remedy: str) -> InputError:
    shown = _printable(str(source))
    return InputError(shown, (Fault("CASE", shown, None, problem, remedy),))


def _with_value(data: Mapping[str, Any], key: object, value: object) -> tuple[dict[str, Any], KeyPath]:
    return with_value(data, str(key), _plain(value))


def _apply(data: dict[str, Any], settings: Iterable[_Set]) -> tuple[dict[str, Any], list[KeyPath], list[Fault]]:
    """`data` with the settings, their paths, and their faults."""
    overridden: list[KeyPath] = []
    faults: list[Fault] = []
    for setting in settings:
        try:
            data, path = setting(data)
            overridden.append(path)
        except TomlFault as error:
            faults.append(error.fault)
    return data, overridden, faults


def _validate(data: dict[str, Any]) -> tuple[Case | None, list[Breach]]:
    """The case in `data`, None if the models reject it, and all faults."""
    if has_table(data, "oil"):
        data = {**data, "oil": with_grade(data["oil"])}
    case, guess = None, data
    guessed: list[KeyPath] = []
    faults: dict[KeyPath, Breach] = {}  # one per key: the first says why the value cannot be taken at all
    try:
        case = Case.model_validate(data)
    except ValidationError as error:
        guess, guessed = with_nearest_kinds(error, data)
        faults |= {breach.path: breach for breach in objections(error, data)}
    if guess != data:
        try:
            Case.model_validate(guess)
        except ValidationError as error:
            faults = {breach.path: breach for breach in objections(error, guess)} | faults
    faults = {breach.path: breach for breach in breaches(guess)} | faults
    return case, [breach for breach in faults.values() if not _follows(breach, faults.values(), guessed)]


def _follows(breach: Breach, others: Iterable[Breach], guessed: Sequence[KeyPath]) -> bool:
    """Whether a fault is of the form of a table whose kind was guessed, and whose other keys belong to another kind."""
    for path in guessed:
        of_form = [each for each in others if each.path[: len(path)] == path and each.path[len(path) :] != ("kind",)]
        if breach in of_form and breach.problem in (UNKNOWN, MISSING):
            return any(each.problem == UNKNOWN and len(each.path) == len(path) + 1 for each in of_form)
    return False


def _located(flaws: Sequence[Breach], data: dict[str, Any], overridden: Sequence[KeyPath], text: str) -> list[Fault]:
    """The breaches as faults with the lines of their keys; what came from a setting has no line."""
    known = key_lines(text)
    faults = []
    for breach in flaws:
        from_setting = any(breach.path[: len(path)] == path for path in overridden)
        line = None if from_setting else known.get(breach.path)
        faults.append(Fault(_dotted(breach.path), _shown(data, breach.path), line, breach.problem, breach.remedy))
    return faults


def _dotted(path: KeyPath) -> str:
    return _printable(".".join(map(str, path)))


def _shown(data: Any, path: KeyPath) -> str:
    """The value at `path` as text for a fault; nothing for what is absent, a table or a list."""
    match at(data, path):
        case None | dict() | list():
            return ""
        case bool() as switch:
            return str(switch).lower()
        case int() as whole if whole.bit_length() > LARGEST_SHOWN:
            return ""
        case str() as text:
            return _printable(f'"{text}"')
        case value:
            return _printable(str(value))


def _printable(text: str) -> str:
    """`text` on one line, and not longer than a screen."""
    shown = "".join(character if character.isprintable() else "?" for character in text[: LONGEST_SHOWN + 1])
    return shown if len(shown) <= LONGEST_SHOWN else f"{shown[:LONGEST_SHOWN]}..."
