"""The kinds of files that frb writes, and what marks them as its own: a text in their metadata, a checksum in tables
as CSV. A result replaces only a file of its own kind.

A table as CSV has no place for a text that other programs do not take for data. Its checksum follows the digits of its
last number, so far behind that the number stays the same to the last bit. A table that somebody has changed does
not fit its checksum any more, and is theirs.
"""

from __future__ import annotations

import os
import re
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

MARK = "frbcli: written by frb"
ENDS = 65_536  # bytes at both ends of a file in which the mark is looked for
ZEROS, DIGITS = 25, 10  # between the digits of the number and of the checksum; of the checksum
PIECE = 4 * 1024**2  # bytes of a file that are held at a time

# Numbers of fields, their digits and their exponents
_NUMBER = re.compile(rb"(?:^|(?<=,))(-?\d+\.\d+)(e[+-]?\d+)?(?=[,\r\n])")
_CHECKSUM = re.compile(rb"0{%d}(\d{%d})$" % (ZEROS, DIGITS))


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
    """(where a line begins, a number with a point in it in front of any text in quotes), from the last line upwards."""
    end = len(tail)
    while end > 0:
        begin = tail.rfind(b"\n", 0, end - 1) + 1
        for number in _NUMBER.finditer(tail[begin:end].partition(b'"')[0]):
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
}
PICTURES = {
    ".png": kind("a PNG picture of frb", rb"\x89PNG"),
    ".pdf": kind("a PDF file of frb", rb"%PDF"),
    ".svg": kind("an SVG picture of frb", rb"<\?xml"),
    ".gif": kind("a GIF picture of frb", rb"GIF8"),
    ".mp4": kind("an MP4 film of frb", rb"....ftyp"),
}
