"""The container of a run file: an HDF5 file whose user block carries a checksum.

HDF5 allows a block in front of its own data that its readers skip. A run file puts one line of text there: that it is
a run of frb, how long the HDF5 part is, and its checksum. So a file that was cut short or damaged is recognised before
the HDF5 library, which trusts its input, looks at it; every other HDF5 program still opens the file.

One thing is asked of a file whose checksum is right. Its texts lie in collections (HDF5 file format 3.0, III.E), whose
objects the library walks one after the other: at an object of no size it never ends (seen with HDF5 2.0).

One process writes a run or a sweep at a time: by a lock that the system frees when its process ends, however.
"""

from __future__ import annotations

import errno
import os
import platform
import re
import stat
import struct
import sys
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from io import BufferedReader
from pathlib import Path
from typing import BinaryIO

from frbcli.errors import Fault, InputError, RunFileError
from frbcli.results.write import PART, RUN, RUN_BEGINS, TOKEN, part_of, real, refused, written, wrong_place

MAGIC = RUN_BEGINS + b"1 "
REMEDY = "Free some space and continue with --resume, or choose another place with -o."
USER_BLOCK = 512  # bytes; the smallest that HDF5 allows
SIGNATURE = b"\x89HDF\r\n\x1a\n"  # that every HDF5 file begins with
LARGEST = 8 * 1024**3  # bytes; the longest run that a case may ask for has about half of it
SUFFIXES = (".h5", ".hdf5")
OTHERS = (".png", ".pdf", ".svg", ".html", ".csv", ".json", ".toml", ".mat", ".parquet", ".xlsx", ".gif", ".mp4")
PIECE = 4 * 1024**2  # bytes of a file that are held at a time
# Of a collection: its first bytes, the size of its head and of an object's head.
COLLECTION, HEAD = b"GCOL\x01", 16
MOST_COLLECTIONS, MOST_IN_THEM = 10_000, 16 * 1024**2  # a run has a handful; bytes
SUPERBLOCK = 24  # bytes
SIZES = {0: slice(13, 15), 1: slice(13, 15), 2: slice(9, 11), 3: slice(9, 11)}  # by the version of the superblock


def refuse(path: Path, problem: str, remedy: str = "") -> RunFileError:
    """The error of a `path` that cannot be a run file."""
    return RunFileError(f"run file {path}", (Fault(key="file", value="", line=None, problem=problem, remedy=remedy),))


def seal(content: BinaryIO) -> None:
    """Give a whole HDF5 file, open for reading and writing, that was made with an empty user block the user block of a
    run file."""
    content.seek(USER_BLOCK)
    length, checksum = 0, 0
    while piece := content.read(PIECE):
        length, checksum = length + len(piece), zlib.crc32(piece, checksum)
    content.seek(0)
    content.write(_user_block(length, checksum))


@contextmanager
def replaced(path: Path) -> Iterator[BinaryIO]:
    """A file for an HDF5 file with an empty user block, which becomes the run file `path` in one step when the block
    ends: a reader of `path` finds either the complete old or new file.

    Raises InputError if the disk or the directory does not take it.
    """
    with written(path, RUN, REMEDY) as part, part.open("w+b") as content:
        yield content
        if content.seek(0, os.SEEK_END) > LARGEST:
            raise refuse(path, f"would be larger than {LARGEST // 1024**3} GiB.", "Lengthen output.step.")
        seal(content)


def open_whole(path: Path) -> BufferedReader:
    """A run file, open for reading, whose length and checksum are right. Raises RunFileError for anything else.

    The file is read once from end to end, a piece at a time. Whoever holds it open goes on reading this content, also
    when another run takes its place.
    """
    try:
        if not path.is_file():
            problem = "is not a file." if path.exists() else "does not exist."
            made = "`frb runup CASE -o RUN.h5` makes one of a case."
            remedy = "Name a run of frb runup." if path.suffix in SUFFIXES else f"Name a run; {made}"
            raise refuse(path, problem, remedy)
        file = path.open("rb")
    except (OSError, ValueError) as error:
        raise refuse(path, f"cannot be read: {error}.") from error
    try:
        _check_seal(path, file)
    except BaseException as error:
        file.close()
        if isinstance(error, OSError):
            raise refuse(path, f"cannot be read: {error}.") from error
        raise
    return file


def _check_seal(path: Path, file: BufferedReader) -> None:
    head, length = file.read(USER_BLOCK), os.fstat(file.fileno()).st_size - USER_BLOCK
    if not head.startswith(MAGIC):
        raise refuse(path, "is not a run of frb.", "Name a file that frb runup or frb rundown has written.")
    if length + USER_BLOCK > LARGEST:
        raise refuse(path, f"is larger than {LARGEST // 1024**3} GiB.", "Lengthen output.step and run the case again.")
    whole = head.startswith(_beginning(length)) and file.peek(len(SIGNATURE)).startswith(SIGNATURE)
    checksum, places = _checksum(file) if whole else (0, [])
    crowded = len(places) > MOST_COLLECTIONS
    if not whole or (head != _user_block(length, checksum) and not crowded):
        raise refuse(path, "was cut short or changed after frb wrote it.", "Run the case again.")
    if crowded or not _texts_end(file, USER_BLOCK + length, places):
        raise refuse(path, "is not a complete run: its texts cannot be found.", "Run the case again.")
    file.seek(0)


def _checksum(file: BufferedReader) -> tuple[int, list[int]]:
    """The checksum of what follows, and where a collection of texts may begin in it."""
    checksum, before = 0, b""
    places: list[int] = []
    while len(places) <= MOST_COLLECTIONS and (piece := file.read(PIECE)):
        checksum = zlib.crc32(piece, checksum)
        seen = before + piece
        first = file.tell() - len(seen)
        places += [first + match.start() for match in re.finditer(COLLECTION, seen)]
        before = seen[1 - len(COLLECTION) :]
    return checksum, places


def _texts_end(file: BufferedReader, end: int, places: Iterable[int]) -> bool:
    """Whether the collections at some places of a file can be walked to their ends. One whose size leads beyond the end
    of the file is none, and the library refuses it."""
    file.seek(USER_BLOCK)
    superblock = file.read(SUPERBLOCK)
    if superblock[SIZES.get(superblock[8], slice(0))] != b"\x08\x08":  # addresses and sizes of 8 bytes
        return False
    left = MOST_IN_THEM
    for place in places:
        file.seek(place + 8)
        (size,) = struct.unpack("<Q", file.read(8).ljust(8, b"\xff"))
        if place + size <= end:
            left -= size
            file.seek(place)
            if left < 0 or not _ends(file.read(size)):
                return False
    return True


def _ends(collection: bytes) -> bool:
    """Whether a walk from object to object leaves the collection at its end."""
    at = HEAD
    while at + HEAD <= len(collection):
        index, _, size = struct.unpack_from("<HH4xQ", collection, at)
        span = size if index == 0 else HEAD + -(-size // 8) * 8
        if span < HEAD:
            return False
        at += span
    return at <= len(collection)


def _beginning(length: int) -> bytes:
    return MAGIC + b"length=%d " % length


def _user_block(length: int, checksum: int) -> bytes:
    return (_beginning(length) + b"crc32=%08x\n" % checksum).ljust(USER_BLOCK, b"\0")


def check_output(path: Path) -> None:
    """See that a run can be written to `path`: a new file, or one that replaces an older run of frb.

    Raises RunFileError for a file that is something else, a missing directory or one without permission to write, or a
    name that is too long.
    """
    if wrong := wrong_place(path, RUN):
        raise refuse(path, *wrong)
    if path.suffix.lower() in OTHERS:
        raise refuse(path, f"ends with {path.suffix}, and a run is an HDF5 file.", f"Write -o {path.stem}.h5.")
    if path.exists() and not path.is_file():  # runs are written again and again
        raise refuse(path, "is not a file.", "Give -o the name of a file.")


LOCK = ".lock"
MARK = "frb "  # begins the text of a lock, which is followed by process and machine
LONGEST = 200  # bytes of that text
HELD = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES, errno.EDEADLK)  # by another one
BEYOND = 1 << 20  # the byte that Windows locks: what is before can be read

if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int) -> None:
        os.lseek(descriptor, BEYOND, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        os.lseek(descriptor, 0, os.SEEK_SET)
else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Within it no other process, and no other caller in this one, writes the run or the sweep at `path`.

    Raises InputError, which names the process, if another one writes there. A file system without locks has none.
    """
    path = real(path)
    lock = path.with_name(path.name + LOCK)
    try:
        descriptor = _acquired(path, lock)
    except OSError as error:
        raise refused(lock, f"cannot be used: {error.strerror}.", "Choose another name with -o.") from error
    try:
        yield
    finally:
        _release(descriptor, lock)


def _acquired(path: Path, lock: Path) -> int:
    """The descriptor of the lock, which is held now; a killed holder's half-written files are removed. Raises
    InputError and OSError."""
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _require_own(descriptor, lock)
            try:
                _lock(descriptor)
            except OSError as error:
                if error.errno in HELD:
                    raise _busy(path, descriptor) from None
            if _is_at(descriptor, lock):  # else its holder has just removed it
                if _text(descriptor):
                    _remove_parts(path)
                with suppress(OSError):  # a full disk is reported where the run is written
                    os.ftruncate(descriptor, 0)
                    os.write(descriptor, f"{MARK}{os.getpid()} {platform.node()}\n".encode())
                return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)


def _remove_parts(path: Path) -> None:
    for part in path.parent.glob(f"*{PART}"):
        if part == part_of(path, part.name[-len(PART) - TOKEN : -len(PART)]):
            with suppress(OSError):
                part.unlink()


def _require_own(descriptor: int, lock: Path) -> None:
    """Raises InputError if a file of the user has the name of the lock."""
    status = os.fstat(descriptor)
    if not stat.S_ISREG(status.st_mode) or (status.st_size and not _text(descriptor).startswith(MARK)):
        raise refused(lock, "is in the way: frb keeps a lock there.", "Rename it, or choose another name with -o.")


def _busy(path: Path, descriptor: int) -> InputError:
    words = _text(descriptor).removeprefix(MARK).split()
    who = f"process {words[0]}" if words else "another process"
    if len(words) > 1 and words[1] != platform.node():
        who += f" of {words[1]}"
    return refused(path, f"is being written by {who}.", "Wait for its end, or choose another name with -o.")


def _text(descriptor: int) -> str:
    os.lseek(descriptor, 0, os.SEEK_SET)
    text = os.read(descriptor, LONGEST).decode(errors="replace")
    os.lseek(descriptor, 0, os.SEEK_SET)
    return text


def _is_at(descriptor: int, lock: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), lock.stat())
    except FileNotFoundError:
        return False


def _release(descriptor: int, lock: Path) -> None:
    if sys.platform != "win32":  # as long as it is held: the next one may have a new one afterwards
        with suppress(OSError):
            lock.unlink()
    os.close(descriptor)
    if sys.platform == "win32":  # does not remove what is open, also not by another one
        with suppress(OSError):
            lock.unlink()
