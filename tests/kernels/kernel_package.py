"""A small package with kernels of its own and the program's compiler, in processes of their own."""

import os
import subprocess
import sys
from pathlib import Path

KERNEL = """
from frbcli.compiled import compiled
{imported}

@compiled()
def outer(x):
    return inner(x)
"""
IMPORTS = (
    "from frbcli.film.inner import inner",
    "from frbcli.film import inner as of\ninner = of.inner",
    "from frbcli.film.inner import (\n    inner,\n)",
)
INNER = """
from frbcli.compiled import compiled

@compiled()
def inner(x):
    return x + {added}
"""
ASK = "from frbcli.film.outer{number} import outer; print(outer(1.0), sum(outer.stats.cache_hits.values()))"


def package(folder: Path, *imported: str) -> Path:
    """A package of the program's name with its compiler of kernels, a kernel in a file, and others that call it from
    files of theirs, which import it so: outer, outer1 and so on."""
    from frbcli import caches, compiled, libraries

    room = folder / "frbcli" / "film"
    room.mkdir(parents=True)
    for place in (room.parent, room):
        (place / "__init__.py").touch()
    for module in (compiled, caches, libraries):
        place = Path(str(module.__file__))
        (room.parent / place.name).write_text(place.read_text())
    for number, each in enumerate(imported):
        (room / f"outer{number or ''}.py").write_text(KERNEL.format(imported=each))
    (room / "inner.py").write_text(INNER.format(added="1.0"))
    return room


def answers(folder: Path, kernels: int) -> list[tuple[float, int]]:
    """(value, machine code taken from the cache) of each kernel of a package, in a process of its own."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder / "cache")}
    ask = "; ".join(ASK.format(number=number or "") for number in range(kernels))
    done = subprocess.run(
        [sys.executable, "-c", ask], env=environment, cwd=folder, capture_output=True, text=True, check=True
    )
    return [(float(value), int(hits)) for value, hits in map(str.split, done.stdout.splitlines())]
