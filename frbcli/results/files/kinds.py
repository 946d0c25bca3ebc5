"""The kinds of files that frb writes, by what they begin with: a result takes the place of one of its kind alone."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

HEAD = 65_536  # bytes from which a file is recognised; the names of the columns of a table are among them


@dataclass(frozen=True)
class Kind:
    """name: in errors, e.g. "a run of frb"; head: what its files begin with."""

    name: str
    head: re.Pattern[bytes]

    def holds(self, path: Path) -> bool:
        """Whether an existing file is empty or of this kind. Raises OSError if it cannot be read."""
        with path.open("rb") as file:
            head = file.read(HEAD)
        return not head.strip() or self.head.match(head) is not None


def kind(name: str, head: bytes) -> Kind:
    """The kind of files that begin with a regular expression."""
    return Kind(name, re.compile(head, re.IGNORECASE))


RUN_BEGINS = b"frb-run "
RUN = kind("a run of frb", RUN_BEGINS)
NEW = kind("", rb"(?!)")  # of a case, which takes the place of nothing
PAGE = kind("a page of frb", rb"\s*<!doctype html>")
ROSS = kind("a bearing of frb for ROSS", rb'\["BearingElement_')
SWEEP_LOG = kind("the log of a sweep", rb"\{\"")
# What the first line of a table says, which distinguishes those of frb from others
COLUMNS = (
    rb"film,|bearing,speed_Hz,|speed_Hz,(point|status|synchronous_x_m_computed),|time_s,speed_Hz"
    rb"|cavitation,theory,(status|coupling),|theory,cavitation,mesh,|frequency_Hz,direction,|stiffness_N_m,forward_"
    rb"|([^\n]*,)?branch,speed_Hz,|[^\n]*,unit,curve,kind,|point,[^\n]*status,|key,unit,start,|changed,onset_Hz,"
    rb"|name,topic,expected"
)
TABLES = {
    "csv": kind("a table of frb", COLUMNS),
    "parquet": kind("a Parquet file", rb"PAR1"),
    "mat": kind("a MAT file", rb"MATLAB "),
}
PICTURES = {
    ".png": kind("a PNG picture", rb"\x89PNG"),
    ".pdf": kind("a PDF file", rb"%PDF"),
    ".svg": kind("an SVG picture", rb"<\?xml"),
    ".gif": kind("a GIF picture", rb"GIF8"),
    ".mp4": kind("an MP4 film", rb"....ftyp"),
}
