"""The one way in which frb writes a file: as a whole next to its place, then moved there in one step. Files that must
not be replaced are checked before the work and again when it is written.

Whoever reads the place finds either the complete old or the complete new file, also if the process is interrupted or
killed, or the disk becomes full.
"""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from frbcli.errors import InputError, input_error, printable
from frbcli.results.files.kinds import TABLES, Kind, mark_table

if TYPE_CHECKING:
    import pandas as pd

PART = ".part"  # ends the names of files that are being written
TOKEN = 8  # letters between the name of a file and PART

Wrong = tuple[str, str]  # problem and remedy

REMEDY = "Choose another place with -o."
NOT_ALLOWED: Wrong = ("there is no permission to write it.", REMEDY)

# A spreadsheet takes what begins so for a formula, but for a number with a unit
FORMULA = re.compile(r"[=@]|[+-](?![\d.][\w.,%°µΩ·*/^ ]*$)")


def wrong_place(path: Path, kind: Kind, reads: Iterable[Path] = (), force: bool = False) -> Wrong | None:
    """Problem and remedy of a file that is to be written; None if there is no problem.

    Its directory has to be there, its name possible, and both open for writing. It takes the place of an empty file or
    of one of its kind that frb has written, with `force` of any, and of none that the command reads (`reads`); links
    are followed. Whether the disk has room for it is known when it is written.
    """
    try:
        status = _status(path)
        if status is not None and stat.S_ISDIR(status.st_mode):
            return "is not a file.", "Give -o the name of a file."
        if status is not None and any(os.path.samestat(status, other) for other in map(_status, reads) if other):
            return "is read by this command, and would be lost.", "Choose another name."
        if status is not None and not stat.S_ISREG(status.st_mode):  # a device or a pipe takes what is written
            return None if os.access(path, os.W_OK) else NOT_ALLOWED
        return _wrong_file(real(path), kind, status is not None, force and kind.forced)
    except (OSError, ValueError) as error:
        return f"cannot be used: {getattr(error, 'strerror', None) or error}.", "Choose another name with -o."


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


@contextmanager
def written(path: Path, kind: Kind, remedy: str = REMEDY, force: bool = False) -> Iterator[Path]:
    """Where to write the content of `path`, which takes its place when the block ends.

    If the block raises an error, `path` stays as it was. A device or a pipe is given the content at the end. remedy:
    for a disk that does not take it; force: see wrong_place. Raises InputError if `path` is not of this kind or cannot
    be written.
    """
    if wrong := wrong_place(path, kind, force=force):
        raise refused(path, *wrong)
    try:
        if path.exists() and not path.is_file():
            with TemporaryDirectory(prefix="frb-") as folder:
                yield (content := Path(folder) / path.name)
                _pour(content, path)
            return
        with _part(real(path)) as part:
            yield part
    except OSError as error:
        raise refused(path, f"cannot be written: {error.strerror or error}.", remedy) from error


def write(path: Path, kind: Kind, content: bytes | str, force: bool = False) -> None:
    """Write `content` as a whole file, text in UTF-8. Raises InputError as `written` does."""
    with written(path, kind, force=force) as part:
        part.write_bytes(content.encode() if isinstance(content, str) else content)


@contextmanager
def _part(path: Path) -> Iterator[Path]:
    """A new file next to `path` with its permissions, which replaces it, or is removed after an error."""
    part = part_of(path, secrets.token_hex(TOKEN // 2))
    try:
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        with suppress(FileNotFoundError):
            part.chmod(stat.S_IMODE(path.stat().st_mode))
        yield part
        os.replace(part, path)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def _pour(content: Path, target: Path) -> None:
    """Copy a file into a device or a pipe; one that nobody reads would take it only when somebody does."""
    try:
        descriptor = os.open(target, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0))
    except OSError as error:
        reason = "nobody reads this pipe" if error.errno == errno.ENXIO else error.strerror
        raise OSError(error.errno, reason) from error
    if hasattr(os, "O_NONBLOCK"):
        os.set_blocking(descriptor, True)
    with content.open("rb") as source, open(descriptor, "wb") as stream:
        shutil.copyfileobj(source, stream)


def write_table(table: pd.DataFrame, path: Path, force: bool = False) -> None:
    """Write a table as CSV, with texts that do nothing in a spreadsheet or a terminal. Raises InputError as `written`
    does."""
    harmless = table.rename(columns=harmless_text)
    for place, kind in enumerate(harmless.dtypes):
        if kind.kind not in "fiub":
            harmless.isetitem(place, harmless.iloc[:, place].map(harmless_text))
    with written(path, TABLES["csv"], force=force) as part:
        harmless.to_csv(part, index=False, lineterminator="\n")
        mark_table(part)


def harmless_text(cell: Any) -> Any:
    """A cell without control characters; a text that a spreadsheet would compute begins with an apostrophe."""
    if not isinstance(cell, str):
        return cell
    text = printable(cell)
    return f"'{text}" if FORMULA.match(text.lstrip()) else text
