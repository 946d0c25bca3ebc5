"""The cache of compiled kernels for the tests.

A cached kernel is made anew when its own file changes, but not when a kernel that it calls does. The tests therefore
keep a cache for each state of all source files.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path

SOURCES = Path(__file__).parents[1] / "frbcli"

digest = hashlib.sha256()
for source in sorted(SOURCES.rglob("*.py")):
    digest.update(source.read_bytes())
# Before numba is imported; processes that the tests start find it in their environment.
os.environ.setdefault("NUMBA_CACHE_DIR", str(Path(tempfile.gettempdir()) / f"frb-kernels-{digest.hexdigest()[:16]}"))
