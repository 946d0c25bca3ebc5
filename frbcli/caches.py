"""A place for what libraries keep from one start to the next, where neither the installation nor the home directory can
be written."""

from __future__ import annotations

import atexit
import os
import shutil
import stat
import tempfile
from functools import cache
from pathlib import Path


@cache
def temporary_cache() -> Path:
    """A directory of this user among the temporary ones, found again at the next start.

    What it holds is run as code: if the name belongs to somebody else, or others may write there, a new directory is
    made, which is removed when the process ends.
    """
    user = os.getuid() if hasattr(os, "getuid") else ""
    folder = Path(tempfile.gettempdir()) / f"frb-cache-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        if _is_own(folder):
            return folder
    except OSError:  # a file, or a link to nowhere
        pass
    own = Path(tempfile.mkdtemp(prefix="frb-cache-"))
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return own


def _is_own(folder: Path) -> bool:
    if not hasattr(os, "getuid"):  # Windows has temporary directories for each user
        return True
    status = folder.lstat()
    return stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid() and not status.st_mode & 0o077
