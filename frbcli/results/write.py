"""The one way in which frb writes a file, and the kinds of files that it writes.

A file is written as a whole next to its place, then moved there in one step. Whoever reads the place finds either the
complete old or the complete new file, also if the process is interrupted or killed, or the disk becomes full. Files
that must not be replaced are checked before the work and again when it is written.

A result replaces only a file of its own kind. What marks a file as frb's own is a text in its metadata, in tables as
CSV a checksum. A table as CSV has no place for a text that other programs do not take for data. Its checksum follows
the digits of its last number, so far behind that the number stays the same to the last bit. A table that somebody has
changed does not fit its checksum any more, and is theirs.

Files that a user names, read without a wait or a surprise: regular ones alone, up to a size, text in UTF-8.
"""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import stat
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, BinaryIO

from frbcli.errors import InputError, input_error, printable

if TYPE_CHECKING:
    import pandas as pd


MARK = "frbcli: written by frb"
ENDS = 65_536  # bytes at both ends of a file in which the mark is looked for
ZEROS, DIGITS = 25, 10  # between the digits of the number and of the checksum; of the checksum
PIECE = 4 * 1024**2  # bytes of a file that are held at a time

# Numbers of fields, their digits and their exponents
_NUMBER = re.compile(rb"(?:^|(?<=,))(-?\d+\.\d+)(e[+-]?\d+)?(?=[,\r\n])")
_QUOTED = re.compile(rb'"[^"]*(?:"|$)')
_CHECKSUM = re.compile(rb"0{%d}(\d{%d})$" % (ZEROS, DIGITS))
PART = ".part"  # ends the names of files that are being written
TOKEN = 8  # letters between the name of a file and PART

Wrong = tuple[str, str]  # problem and remedy

REMEDY = "Choose another place with -o."
NOT_ALLOWED: Wrong = ("there is no permission to write it.", REMEDY)

# A spreadsheet takes what begins so for a formula, but for a number with a unit
FORMULA = re.compile(r"[=@]|[+-](?![\d.][\w.,%°µΩ·*/^ ]*$)")


def has_mark(path: Path) -> bool:
    """Whether the beginning or the end of a file has the mark. Raises OSError."""
    with path.open("rb") as file:
        head = file.read(ENDS)
        file.seek(max(len(head), os.fstat(file.fileno()).st_size - ENDS))
        return MARK.encode() in head or MARK.encode() in file.read(ENDS)


def mark_table(path: Path) -> None:
    """Put the checksum of a table as CSV into its last number with a point; a table without one stays as it is. Raises
    OSError."""
    with path.open("r+b") as file:
        begin, tail = _tail(file)
        for at, number in _numbers(tail):
            digits, exponent = number[1], number[2] or b""
            if float(digits + b"0" * ZEROS + b"9" * DIGITS + exponent) == float(digits + exponent):
                checksum, end = _checksum(file, begin + len(tail)), at + number.end(1)
                file.seek(begin + end)
                file.write(b"0" * ZEROS + b"%0*d" % (DIGITS, checksum) + tail[end:])
                return


def has_checksum(path: Path) -> bool:
    """Whether a table as CSV is as `mark_table` has left it. Raises OSError."""
    with path.open("rb") as file:
        begin, tail = _tail(file)
        for at, number in _numbers(tail):
            if match := _CHECKSUM.search(number[1]):
                before = _checksum(file, begin + at + number.start(1) + match.start())
                return zlib.crc32(tail[at + number.end(1) :], before) == int(match[1])
    return False


def _tail(file: BinaryIO) -> tuple[int, bytes]:
    """Where the last whole lines of a file begin, without its head, and these lines; empty if the last one does not
    end."""
    size = os.fstat(file.fileno()).st_size
    file.seek(max(0, size - ENDS))
    tail = file.read(ENDS)
    tail = tail[tail.find(b"\n") + 1 :] if tail.endswith(b"\n") else b""
    return size - len(tail), tail


def _numbers(tail: bytes) -> Iterator[tuple[int, re.Match[bytes]]]:
    """(where a line begins, a number with a point in it outside of quotes), from the last line upwards."""
    end = len(tail)
    while end > 0:
        begin = tail.rfind(b"\n", 0, end - 1) + 1
        for number in _NUMBER.finditer(_QUOTED.sub(lambda text: b'"' * len(text[0]), tail[begin:end])):
            yield begin, number
        end = begin


def _checksum(file: BinaryIO, length: int) -> int:
    """Checksum of the first `length` bytes of a file."""
    checksum = 0
    file.seek(0)
    while length and (piece := file.read(min(PIECE, length))):
        checksum, length = zlib.crc32(piece, checksum), length - len(piece)
    return checksum


HEAD = 4096  # bytes by which a kind is recognised


@dataclass(frozen=True)
class Kind:
    """name: in errors, e.g. "a run of frb"; head: what its files begin with; marked: whether one of them, a file at a
    path, was written by frb; forced: whether a file that is none may be replaced where that is asked for."""

    name: str
    head: re.Pattern[bytes]
    marked: Callable[[Path], bool] = has_mark
    forced: bool = True

    def holds(self, path: Path) -> bool:
        """Whether an existing file is empty, or of this kind and written by frb. Raises OSError if it cannot be
        read."""
        with path.open("rb") as file:
            head = file.read(HEAD)
        return not head.strip() or (self.head.match(head) is not None and self.marked(path))


def kind(name: str, head: bytes, marked: Callable[[Path], bool] = has_mark, forced: bool = True) -> Kind:
    """The kind of files that begin with a regular expression."""
    return Kind(name, re.compile(head, re.IGNORECASE), marked, forced)


def _by_head(_: Path) -> bool:
    """True: no other program writes files of these kinds."""
    return True


RUN_BEGINS = b"frb-run "
RUN = kind("a run of frb", RUN_BEGINS, _by_head, forced=False)
NEW = kind("", rb"(?!)")  # of a case, which takes the place of nothing
PAGE = kind("a page of frb", rb"\s*<!doctype html>")
ROSS = kind("a bearing of frb for ROSS", rb"#")
SWEEP_LOG = kind("the log of a sweep", rb"\{\"", _by_head, forced=False)  # one that is read before
TABLES = {
    "csv": kind("a table of frb", rb"", has_checksum),
    "parquet": kind("a Parquet file of frb", rb"PAR1"),
    "mat": kind("a MAT file of frb", rb"MATLAB "),
    "xlsx": kind("an Excel file of frb", rb"PK"),
}
PICTURES = {
    ".png": kind("a PNG picture of frb", rb"\x89PNG"),
    ".pdf": kind("a PDF file of frb", rb"%PDF"),
    ".svg": kind("an SVG picture of frb", rb"<\?xml"),
    ".gif": kind("a GIF picture of frb", rb"GIF8"),
    ".mp4": kind("an MP4 film of frb", rb"....ftyp"),
}


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


MIB = 1024**2
LARGEST = 1024 * 1024 * MIB  # of a file of which the head alone is read


class Unreadable(Exception):
    """A file cannot be read; says why, as the end of a sentence about it."""


class NoFile(Unreadable):
    """There is none, or it is a directory, a pipe or a device."""


class NoText(Unreadable):
    """It is no text in UTF-8."""


def require_file(path: Path, largest: int) -> None:
    """Raises Unreadable if a path names no regular file of at most `largest` bytes: a pipe or device may never end."""
    try:
        status = path.stat()
    except FileNotFoundError:
        raise NoFile("does not exist.") from None
    except (OSError, ValueError) as error:
        raise _unreadable(error) from None
    if not stat.S_ISREG(status.st_mode):
        raise NoFile("is not a file.")
    if status.st_size > largest:
        raise _too_large(largest)


def content_of(path: Path, largest: int) -> bytes:
    """The bytes of a file. Raises Unreadable."""
    require_file(path, largest)
    try:
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except (OSError, ValueError) as error:
        raise _unreadable(error) from None
    if len(content) > largest:
        raise _too_large(largest)
    return content


def begins_with(path: Path, head: bytes) -> bool:
    """Whether a regular file begins with some bytes."""
    try:
        require_file(path, LARGEST)
        with path.open("rb") as file:
            return file.read(len(head)) == head
    except (Unreadable, OSError):
        return False


def text_of(path: Path, largest: int) -> str:
    """The text of a file. Raises Unreadable."""
    content = content_of(path, largest)
    if b"\0" in content:
        raise NoText("is no UTF-8 text: it holds bytes of zero.")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise NoText(f"is no UTF-8 text (at byte {error.start}).") from None


def _unreadable(error: OSError | ValueError) -> Unreadable:
    return Unreadable(f"cannot be read: {getattr(error, 'strerror', None) or error}.")


def _too_large(largest: int) -> Unreadable:
    size = f"{largest // MIB} MiB" if largest >= MIB else f"{largest // 1024} KiB"
    return Unreadable(f"is larger than {size}.")
