"""The rule where frb writes: what a file may not take the place of, checked before the work and again when it is
written (`write.py`)."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterable
from pathlib import Path

from frbcli.errors import InputError, input_error
from frbcli.results.files.kinds import Kind

PART = ".part"  # ends the names of files that are being written
TOKEN = 8  # letters between the name of a file and PART

Wrong = tuple[str, str]  # problem and remedy


def wrong_place(path: Path, kind: Kind, reads: Iterable[Path] = (), force: bool = False) -> Wrong | None:
    """Problem and remedy of a file that is to be written; None if there is no problem.

    Its directory has to be there, its name possible, and both open for writing. It takes the place of an empty file or
    of one of its kind that frb has written, with `force` of any, and of none that the command reads (`reads`); links
    are followed. Whether the disk has room for it is known when it is written.
    """
    try:
        found = _status(path)
        if found is not None and stat.S_ISDIR(found.st_mode):
            return "is not a file.", "Give -o the name of a file."
        if found is not None and any(os.path.samestat(found, other) for other in map(_status, reads) if other):
            return "is read by this command, and would be lost.", "Choose another name."
        if found is not None and not stat.S_ISREG(found.st_mode):  # a device or a pipe takes what is written
            return None if os.access(path, os.W_OK) else NOT_ALLOWED
        return _wrong_file(real(path), kind, found is not None, force and kind.forced)
    except (OSError, ValueError) as error:
        return f"cannot be used: {getattr(error, 'strerror', None) or error}.", "Choose another name with -o."


NOT_ALLOWED = ("there is no permission to write it.", "Choose another place with -o.")


def _wrong_file(path: Path, kind: Kind, exists: bool, force: bool) -> Wrong | None:
    """The check of a place for a regular file, or one that does not exist. Raises OSError."""
    if not path.parent.is_dir():
        return f"the directory {path.parent} does not exist.", "Create it, or choose another with -o."
    _status(part_of(path, "x" * TOKEN))  # its name may be too long, too
    if not os.access(path.parent, os.W_OK) or (exists and not os.access(path, os.W_OK)):
        return NOT_ALLOWED
    if exists and not force and not kind.holds(path):
        other = f" and is not {kind.name}" if kind.name else ""
        instead = "replace it with --force" if kind.forced else "remove it first"
        return f"is there already{other}; it is not replaced.", f"Choose another name, or {instead}."
    return None


def require_places(
    files: Iterable[tuple[Path, Kind]], reads: Iterable[Path] = (), force: bool = False
) -> None:
    """Raises InputError for the first file that cannot be written, or for two that are the same, before anything is
    computed. reads: files that the command reads; force: see wrong_place."""
    known, reads = set[Path](), tuple(reads)
    for file, kind in files:
        if wrong := wrong_place(file, kind, reads, force):
            raise refused(file, *wrong)
        if real(file) in known:
            raise refused(file, "is to hold two results.", "Give each its own name.")
        known.add(real(file))


def refused(path: Path, problem: str, remedy: str) -> InputError:
    """The error of a file that cannot be written."""
    return input_error(f"file {path}", "output", "", problem, remedy)


def real(path: Path) -> Path:
    """The file itself that a path names, behind links. Raises OSError or ValueError."""
    return Path(os.path.realpath(path))


def part_of(path: Path, token: str) -> Path:
    """Where the next content of a file is written before it takes its place."""
    return path.with_name(f"{path.name}.{token}{PART}")


def _status(path: Path) -> os.stat_result | None:
    """None if there is no such file; unlike Path.exists this lets an impossible name raise its error."""
    try:
        return path.stat()
    except FileNotFoundError:
        return None
