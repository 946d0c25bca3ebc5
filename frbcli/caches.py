"""What is kept on disk from one start to the next: files with checksums, folders in which they are trusted, and kernels
that an installed wheel has brought along."""

from __future__ import annotations

import atexit
import hashlib
import json
import os
import shutil
import stat
import sys
import tempfile
import uuid
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

# Kinds of processors that a wheel may have kernels for, the best one first, and what a machine of each has
V3 = ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave")
NEEDED = {"x86-64-v4": (*V3, "avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"), "x86-64-v3": V3}
# LLVM has kernels for x86-64-v4 work in halves of a vector, as the first processors with AVX-512 wanted it: a film on
# cells takes a tenth longer then.
FEATURES = {"x86-64-v4": "-prefer-256-bit", "x86-64-v3": ""}
KERNELS = "kernels.json"  # in the package of a wheel with kernels: what these were compiled for
CHECKSUM = 32  # bytes before the content of a file
GROUP, OTHERS = stat.S_IWGRP, stat.S_IWOTH


def stored(path: Path, made_for: str = "") -> bytes | None:
    """What `store` wrote for the same purpose; None if there is nothing, or it is damaged, or cannot be read.

    Only plain files are opened: a FIFO would be waited for.
    """
    try:
        written = path.read_bytes() if path.is_file() else b""
    except OSError:
        return None
    content = written[CHECKSUM:]
    return content if written[:CHECKSUM] == _checksum(content, made_for) else None


def store(path: Path, content: bytes, made_for: str = "") -> None:
    """Write a file with its checksum at once, so that no process reads half of it. Raises OSError."""
    part = path.with_name(f"{path.name}.{uuid.uuid4().hex}")
    try:
        part.write_bytes(_checksum(content, made_for) + content)
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        part.replace(path)
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def _checksum(content: bytes, made_for: str) -> bytes:
    digest = hashlib.sha256(made_for.encode())
    digest.update(content)
    return digest.digest()


def is_trusted(folder: Path) -> bool:
    """Whether nobody but this user and root can change what a folder holds, or put another folder in its place.

    Others may write in a parent that is sticky, as /tmp is. Windows keeps such folders apart for each user.
    """
    if not hasattr(os, "getuid"):
        return True
    try:
        place = folder.resolve(strict=True)
        owners = {os.getuid(), 0, os.stat("/").st_uid}  # in a container root may have another number
        for each in (place, *place.parents):
            status = each.stat()
            safe = not _others_write(status) or (each != place and status.st_mode & stat.S_ISVTX)
            if status.st_uid not in owners or not safe:
                return False
        return place.is_dir()
    except OSError:
        return False


def _others_write(status: os.stat_result) -> bool:
    """Whether a user other than the owner may write. The group of its owner alone, as many systems have it, does not
    count."""
    if not status.st_mode & GROUP or status.st_mode & OTHERS:
        return bool(status.st_mode & OTHERS)
    import grp
    import pwd

    try:
        group, owner = grp.getgrgid(status.st_gid), pwd.getpwuid(status.st_uid)
    except KeyError:
        return True
    return owner.pw_gid != status.st_gid or group.gr_name != owner.pw_name or bool({*group.gr_mem} - {owner.pw_name})


def take_shipped_kernels(package: Path) -> None:
    """Let numba compile for the best kind of processor that this machine has of those that a wheel has kernels for: so
    it finds these. Nothing happens without such a wheel, with another version of numba or Python, where NUMBA_CPU_NAME
    says otherwise, where numba has been used before and has chosen, or where the file of the wheel is damaged."""
    file = package / KERNELS
    if "NUMBA_CPU_NAME" in os.environ or not file.is_file():
        return
    import numba
    from llvmlite import binding
    from numba.core import config, registry

    try:
        shipped = json.loads(file.read_text(encoding="utf-8"))
        known = (shipped["python"], shipped["numba"]) == (sys.implementation.cache_tag, numba.__version__)
        targets = [target for target in NEEDED if target in shipped["targets"]]
    except (OSError, ValueError, LookupError, TypeError):
        return
    if not known or "_toplevel_target_context" in vars(registry.cpu_target):
        return
    has = binding.get_host_cpu_features()
    fits = [target for target in targets if all(has.get(feature) for feature in NEEDED[target])]
    if fits:
        os.environ["NUMBA_CPU_NAME"], os.environ["NUMBA_CPU_FEATURES"] = fits[0], FEATURES[fits[0]]
        settings: Any = config  # numba gives no types of it
        settings.reload_config()


@cache
def temporary_cache() -> Path:
    """A directory of this user among the temporary ones, found again at the next start.

    What it holds is run as code: if the name belongs to somebody else, others may write there, or it lies in the
    current folder, a new directory is made, which is removed when the process ends. Raises OSError if none can be.
    """
    user = os.getuid() if hasattr(os, "getuid") else ""
    folder = Path(tempfile.gettempdir()) / f"frb-cache-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        safe = is_trusted(folder) and not folder.is_symlink() and not folder.parent.samefile(Path.cwd())
        if safe and os.access(folder, os.W_OK | os.X_OK):
            return folder
    except OSError:  # a file, or a link to nowhere
        pass
    own = Path(tempfile.mkdtemp(prefix="frb-cache-"))
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return own
