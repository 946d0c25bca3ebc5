"""The coefficients of bearings over speed as a file that ROSS reads (`BearingElement.load`)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = {f"{name}{axes}": f"{name}_{axes}_{unit}" for name, unit in (("k", "N_m"), ("c", "Ns_m"))
           for axes in ("xx", "xy", "yx", "yy")}  # fmt: skip


def write_ross(table: pd.DataFrame, path: Path) -> None:
    """A TOML table of each film: node n (to be set there), kxx to cyy in N/m and N s/m over the frequency in rad/s.

    table: of BearingSheet.to_pandas over speed; states that were not found are left out.
    """
    found = table[table["status"] == "resting"]
    blocks = []
    for node, film in enumerate(found["film"].unique()):
        own = found[found["film"] == film]
        lines = [f'["BearingElement_{film or "bearing"}"]', f"n = {node}", f'tag = "{film or "bearing"}"']
        lines += [f"{name} = {_numbers(own[column])}" for name, column in COLUMNS.items()]
        lines.append(f"frequency = {_numbers(2.0 * math.pi * own['speed_Hz'])}")
        blocks.append("\n".join(lines))
    path.write_text("\n\n".join(blocks) + "\n", encoding="utf-8")


def _numbers(values: pd.Series) -> str:
    return f"[{', '.join(repr(float(value)) for value in values)}]"
