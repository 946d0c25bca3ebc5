"""What tells files that frb has written from those of others: a text in their metadata, a checksum in tables as CSV.

A table as CSV has no place for a text that other programs do not take for data. Its checksum stands behind the digits
of a number in its last line, so far behind that the number stays the same to the last bit. A table that somebody has
changed does not fit its checksum any more, and is theirs.
"""

from __future__ import annotations

import os
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

MARK = "frbcli: written by frb"
ENDS = 65_536  # bytes at both ends of a file in which the mark is looked for
ZEROS, DIGITS = 25, 10  # between the digits of the number and those of the checksum; of the checksum
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
    """Put the checksum of a table as CSV into its last line; a line without a number that takes it stays as it is.
    Raises OSError."""
    with path.open("r+b") as file:
        begin, line = _last_line(file)
        for number in _numbers(line):
            digits, exponent = number[1], number[2] or b""
            if float(digits + b"0" * ZEROS + b"9" * DIGITS + exponent) == float(digits + exponent):
                checksum = _checksum(file, begin + len(line))
                file.seek(begin + number.end(1))
                file.write(b"0" * ZEROS + b"%0*d" % (DIGITS, checksum) + line[number.end(1) :])
                return


def has_checksum(path: Path) -> bool:
    """Whether a table as CSV is as `mark_table` has left it. Raises OSError."""
    with path.open("rb") as file:
        begin, line = _last_line(file)
        for number in _numbers(line):
            if found := _CHECKSUM.search(number[1]):
                before = _checksum(file, begin + number.start(1) + found.start())
                return zlib.crc32(line[number.end(1) :], before) == int(found[1])
    return False


def _last_line(file: BinaryIO) -> tuple[int, bytes]:
    """Where the last line of a file begins, and the line; empty if it does not end, or is longer than ENDS."""
    size = os.fstat(file.fileno()).st_size
    file.seek(max(0, size - ENDS))
    tail = file.read(ENDS)
    begin = tail.rfind(b"\n", 0, -1) + 1
    line = tail[begin:]
    return size - len(line), line if begin and line.endswith(b"\n") else b""


def _numbers(line: bytes) -> Iterator[re.Match[bytes]]:
    """The numbers with a point in front of any text in quotes."""
    return _NUMBER.finditer(line.partition(b'"')[0])


def _checksum(file: BinaryIO, length: int) -> int:
    """Of the first bytes of a file."""
    checksum = 0
    file.seek(0)
    while length and (piece := file.read(min(PIECE, length))):
        checksum, length = zlib.crc32(piece, checksum), length - len(piece)
    return checksum
