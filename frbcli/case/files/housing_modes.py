"""The modes of a housing out of a file: a table, as a finite element program lists them, with a row for each mode, or a
rotor of ROSS.

The case gets the modes instead of the key `file`, so that a run has all that it was made of. """

from __future__ import annotations

from pathlib import Path
from typing import Any

from frbcli.case.files.number_table import Columns, Refused, number_table, text_of, with_file
from frbcli.case.reading.tables import Breach, number, table, tables
from frbcli.case.rotor import OF_SECTIONS

FREQUENCY, DAMPING = "frequency_Hz", "damping"
AXES = ("_x", "_y")
MOST_MODES = 200
ROSS = (".toml", ".json")
COLUMNS = (
    f"Give the columns {FREQUENCY}, {DAMPING}, and for each bearing and place NAME_x and NAME_y in 1/sqrt(kg), e.g. "
    "left_x, left_y."
)
FILE = "a table of modes"


def with_housing_file(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with the modes of housing.file instead of that key, and the faults.

    folder: that a relative path counts from. With faults the tables are returned unchanged.
    """

    def joined(name: str, kept: dict[str, Any]) -> dict[str, Any]:
        if Path(name).suffix.lower() in ROSS:
            return {**_of_ross(data, folder / name), **kept}
        return {"modes": _modes(number_table(text_of(folder / name, FILE, COLUMNS), COLUMNS)), **kept}

    return with_file(data, ("housing",), joined, ("modes",))


def _of_ross(data: dict[str, Any], path: Path) -> dict[str, Any]:
    """Modes and masses of a rotor of ROSS, as a case file has them. Raises Refused."""
    from frbcli.case.files.ross_housing import ross_housing  # which takes linear algebra

    if table(data, "rotor").get("kind") not in OF_SECTIONS:
        raise Refused("is of a shaft of sections, which the rotor of this case has not.", "Give a rigid housing.")
    bearings = []
    for place, (_, bearing) in enumerate(tables(data, "bearing"), start=1):
        position = number(bearing, "position", "m")
        if position is not None:  # else a fault of its own
            bearings.append((str(bearing.get("name") or place), position))
    return ross_housing(path, bearings)


def _modes(columns: Columns) -> list[dict[str, Any]]:
    """The modes as a case file has them. Raises Refused."""
    places = list(dict.fromkeys(name[:-2] for name in columns if name.endswith(AXES)))
    wanted = [FREQUENCY, *(f"{place}{axis}" for place in places for axis in AXES)]
    if missing := [name for name in wanted if name not in columns]:
        raise Refused(f"lacks {', '.join(missing)}.", COLUMNS)
    if unknown := [name for name in columns if name not in (*wanted, DAMPING)]:
        raise Refused(f'has the column "{unknown[0]}", which is not known here.', COLUMNS)
    count = len(columns[FREQUENCY])
    if not 1 <= count <= MOST_MODES:
        raise Refused(f"has {count} modes.", f"Give 1 to {MOST_MODES}, a row each.")
    return [
        {
            "frequency": f"{columns[FREQUENCY][row]!r} Hz",
            "damping": columns.get(DAMPING, [0.0] * count)[row],
            "at": {place: [columns[f"{place}{axis}"][row] for axis in AXES] for place in places},
        }
        for row in range(count)
    ]
