"""Files that a user names, read without a wait or a surprise: regular ones alone, up to a size, text in UTF-8."""

from __future__ import annotations

import stat
from pathlib import Path

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
