"""The coefficients of bearings over speed as a file that ROSS reads (`BearingElement.load`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from frbcli.results.files.kinds import ROSS
from frbcli.results.files.write import write

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = {f"{letter}{axes}": f"{name}_{axes}_{unit}"
           for letter, name, unit in (("k", "stiffness", "N_m"), ("c", "damping", "N_s_m"))
           for axes in ("xx", "xy", "yx", "yy")}  # fmt: skip


def ross_files(path: Path, films: Sequence[str]) -> dict[str, Path]:
    """The file of each film: `path` for one alone; for several its name with that of the film, since ROSS loads one
    bearing from a file and passes over any other."""
    if len(films) == 1:
        return {films[0]: path}
    return {film: path.with_name(f"{path.stem}-{film}{path.suffix}") for film in films}


def write_ross(table: pd.DataFrame, path: Path) -> None:
    """A TOML table of one film: node n (to be set there), kxx to cyy in N/m and N s/m over the frequency in rad/s.

    table: the rows of the film in BearingSheet.to_pandas over speed; states that were not found are left out. Raises
    InputError if the file cannot be written.
    """
    found = table[table["status"] == "resting"].sort_values("speed_Hz")
    name = table["film"].iloc[0] or "bearing"
    lines = [f'["BearingElement_{name}"]', "n = 0", f'tag = "{name}"']
    lines += [f"{name} = {_numbers(found[column])}" for name, column in COLUMNS.items()]
    lines.append(f"frequency = {_numbers(2.0 * math.pi * found['speed_Hz'])}")
    write(path, ROSS, "\n".join(lines) + "\n")


def _numbers(values: pd.Series) -> str:
    return f"[{', '.join(repr(float(value)) for value in values)}]"
