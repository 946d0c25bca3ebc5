"""The one way in which frb writes a file: as a whole beside its place, then moved there in one step.

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
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from frbcli.errors import printable
from frbcli.results.files.kinds import TABLES, Kind, mark_table
from frbcli.results.files.place import TOKEN, part_of, real, refused, wrong_place

if TYPE_CHECKING:
    import pandas as pd

REMEDY = "Choose another place with -o."

# A spreadsheet takes what begins so for a formula, but for a number with a unit
FORMULA = re.compile(r"[=@]|[+-](?![\d.][\w.,%°µΩ·*/^ ]*$)")


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
    """Make `content` that of a file, text in UTF-8. Raises InputError as `written` does."""
    with written(path, kind, force=force) as part:
        part.write_bytes(content.encode() if isinstance(content, str) else content)


@contextmanager
def _part(path: Path) -> Iterator[Path]:
    """A new file beside `path` with its permissions, which replaces it, or is removed after an error."""
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
