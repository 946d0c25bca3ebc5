"""What libraries keep from one start to the next: kernels that an installed wheel has brought along, and a place where
neither the installation nor the home directory can be written."""

from __future__ import annotations

import atexit
import json
import os
import shutil
import stat
import sys
import tempfile
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


def take_shipped_kernels(package: Path) -> None:
    """Let numba compile for the best kind of processor that this machine has of those that a wheel has kernels for: so
    it finds these. Nothing happens without such a wheel, with another version of numba or Python, where NUMBA_CPU_NAME
    says otherwise, or where numba has been used before and has chosen."""
    file = package / KERNELS
    if "NUMBA_CPU_NAME" in os.environ or not file.exists():
        return
    import numba
    from llvmlite import binding
    from numba.core import config, registry

    shipped = json.loads(file.read_text(encoding="utf-8"))
    known = (shipped["python"], shipped["numba"]) == (sys.implementation.cache_tag, numba.__version__)
    if not known or "_toplevel_target_context" in vars(registry.cpu_target):
        return
    has = binding.get_host_cpu_features()
    fits = [target for target in shipped["targets"] if all(has.get(feature) for feature in NEEDED[target])]
    if fits:
        os.environ["NUMBA_CPU_NAME"], os.environ["NUMBA_CPU_FEATURES"] = fits[0], FEATURES[fits[0]]
        settings: Any = config  # numba tells no types of it
        settings.reload_config()


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
