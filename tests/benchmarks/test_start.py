"""CPU time of short commands over that of importing what they cannot do without: `pytest -m timing -s`."""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

pytestmark = [pytest.mark.nightly, pytest.mark.timing]

LIBRARIES, CLICK = "import numpy, numba, h5py", "import click"
RUN = ("runup", "jeffcott", "--force", "-o", "x.h5")
PAIRS = 5
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def cpu_s(place: Path, words: Sequence[str]) -> float:
    """CPU time of a process of Python in user and system."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *words], cwd=place, env=ENVIRONMENT, capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


@pytest.mark.parametrize(
    ("words", "imports", "most"),
    [((*RUN, "--no-picture"), LIBRARIES, 3.0), (RUN, LIBRARIES, 4.6), (("--help",), CLICK, 1.3)],
)
def test_a_warm_command_takes_few_times_the_imports_of_its_libraries(
    words: tuple[str, ...], imports: str, most: float, tmp_path: Path
) -> None:
    """Medians of pairs, one after the other, with kernels and compiled modules on the disk."""
    command = ["-m", "frbcli", *words]
    for once in (command, ["-c", imports]):
        cpu_s(tmp_path, once)
    ratios = [cpu_s(tmp_path, command) / cpu_s(tmp_path, ["-c", imports]) for _ in range(PAIRS)]
    ratio = statistics.median(ratios)
    sys.stdout.write(f"\n{' '.join(words)}: {ratio:.2f} times {imports}, from {min(ratios):.2f} to {max(ratios):.2f}\n")
    assert ratio <= most
