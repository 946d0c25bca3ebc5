"""One process writes a run or a sweep at a time: by a lock that the system frees when its process ends, however."""

from __future__ import annotations

import errno
import os
import platform
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from frbcli.errors import InputError
from frbcli.results.files.write import PART, TOKEN, part_of, real, refused

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
