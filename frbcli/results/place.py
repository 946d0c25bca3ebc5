"""Whether a file can be written at a place, checked before the work."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from frbcli.errors import Fault, InputError


def wrong_place(path: Path) -> tuple[str, str] | None:
    """Problem and remedy of a file that is to be written; None if there is no problem.

    Its directory has to be there, its name possible, and both open for writing. Whether the disk has room for it is
    known when it is written.
    """
    folder = path.parent
    try:
        if not folder.is_dir():
            return f"the directory {folder} does not exist.", "Create it, or choose another with -o."
        exists = _exists(path)
        if path.is_dir():
            return "is not a file.", "Give -o the name of a file."
        if not os.access(folder, os.W_OK) or (exists and not os.access(path, os.W_OK)):
            return "there is no permission to write it.", "Choose another place with -o."
    except (OSError, ValueError) as error:
        return f"cannot be used: {getattr(error, 'strerror', None) or error}.", "Choose another name with -o."
    return None


def remove_part(path: Path) -> None:
    """Remove a file that was written in part only; devices stay."""
    with suppress(OSError):
        if path.is_file():
            path.unlink()


def require_place(*files: Path | None) -> None:
    """Raises InputError for the first file that cannot be written, before anything is computed; None is no file."""
    for file in files:
        if file is not None and (wrong := wrong_place(file)):
            raise InputError(f"file {file}", (Fault("file", "", None, *wrong),))


def _exists(path: Path) -> bool:
    """Unlike Path.exists this lets an impossible name raise its error."""
    try:
        path.stat()
    except FileNotFoundError:
        return False
    return True
