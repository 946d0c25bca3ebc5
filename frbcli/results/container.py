"""The container of a run file: an HDF5 file whose user block carries a checksum.

HDF5 allows a block in front of its own data that its readers skip. A run file puts one line of text there: that it is
a run of frb, how long the HDF5 part is, and its checksum. So a file that was cut short or damaged is recognised before
the HDF5 library, which trusts its input, looks at it; every other HDF5 program still opens the file.
"""

from __future__ import annotations

import contextlib
import os
import zlib
from pathlib import Path

from frbcli.errors import Fault, RunFileError
from frbcli.results.place import wrong_place

MAGIC = b"frb-run 1 "
USER_BLOCK = 512  # bytes; the smallest that HDF5 allows


def refuse(path: Path, problem: str, remedy: str = "") -> RunFileError:
    """The error that says why `path` is no use as a run file."""
    return RunFileError(f"run file {path}", (Fault(key="file", value="", line=None, problem=problem, remedy=remedy),))


def seal(content: memoryview) -> bytes:
    """The user block, (512,) bytes, for `content`: a whole HDF5 file that was made with an empty user block."""
    body = content[USER_BLOCK:]
    return (MAGIC + b"length=%d crc32=%08x\n" % (len(body), zlib.crc32(body))).ljust(USER_BLOCK, b"\0")


def write_whole(path: Path, content: memoryview) -> None:
    """Put `content` in place of `path` in one step: whoever opens `path` finds the old file or the new one, whole.

    Raises RunFileError if the disk or the directory does not take it.
    """
    part = part_file(path)
    try:
        with part.open("wb") as file:
            file.write(seal(content))
            file.write(content[USER_BLOCK:])
        os.replace(part, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        remedy = "Make room, and go on with --resume; or choose another place with -o."
        raise refuse(path, f"cannot be written: {error.strerror}.", remedy) from error


def read_whole(path: Path) -> bytes:
    """The checked content of a run file, user block included. Raises RunFileError for anything else."""
    try:
        if not path.is_file():
            raise refuse(path, "is not a file." if path.exists() else "does not exist.", "Name a run of frb runup.")
        content = path.read_bytes()
    except (OSError, ValueError) as error:
        raise refuse(path, f"cannot be read: {error}.") from error
    if not content.startswith(MAGIC):
        raise refuse(path, "is not a run of frb.", "Name a file that frb runup or frb rundown has written.")
    if len(content) < USER_BLOCK or content[:USER_BLOCK] != seal(memoryview(content)):
        raise refuse(path, "was cut short or changed after frb wrote it.", "Run the case again.")
    return content


def check_output(path: Path) -> None:
    """See that a run can be written to `path`: a new file, or in place of an older run of frb.

    Raises RunFileError for a file that is something else, a missing directory or one without permission to write, a
    name that is too long, or a directory where the next state of the run is to be written.
    """
    if wrong := wrong_place(path):
        raise refuse(path, *wrong)
    part = part_file(path)
    if wrong := wrong_place(part):
        raise refuse(path, f"{part.name}, where it is written first, {wrong[0]}", "Choose another name with -o.")
    try:
        if path.exists() and not path.is_file():
            raise refuse(path, "is not a file.", "Give -o the name of a file.")
        if path.exists() and not is_run(path):
            raise refuse(path, "exists and is not a run of frb; it is left alone.", "Choose another name.")
    except OSError as error:
        raise refuse(path, f"cannot be used: {error.strerror}.", "Choose another name with -o.") from error


def is_run(path: Path) -> bool:
    """Whether a file begins as the runs of frb do. Raises OSError if it cannot be read."""
    with path.open("rb") as file:
        return file.read(len(MAGIC)) == MAGIC


def part_file(path: Path) -> Path:
    """Where the next state of `path` is written before it takes its place."""
    return path.with_name(path.name + ".part")
