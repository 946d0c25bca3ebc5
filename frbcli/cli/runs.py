"""What the commands share that read runs: RUN.h5, where a result goes."""

from __future__ import annotations

import re
from pathlib import Path

import click

RUN = click.Path(path_type=Path)
OUTPUT = click.Path(path_type=Path)


def beside(run: Path, what: str) -> Path:
    """The default place of a result: beside its run."""
    return run.parent / (run.stem + what)


def here(case_name: str, what: str) -> Path:
    """The default place of the result of a case: this directory, under the name of the case."""
    return Path((re.sub(r"[^\w.-]+", "-", case_name) or "run") + what)
