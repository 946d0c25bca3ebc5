"""The kinds of files that frb writes, by what they begin with: a result takes the place of one of its kind alone."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from frbcli.results.files.mark import has_checksum, has_mark

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
    """Of kinds that no other program writes."""
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
