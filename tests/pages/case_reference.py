"""Writes docs/case-file.md from the JSON Schema of a case: `cd tests && python -m pages.case_reference`."""

from __future__ import annotations

from typing import Any

from paths import DOCS

from frbcli.case.schema import json_schema
from frbcli.case.supplies import SUPPLIES, kind_of
from frbcli.case.surroundings.over_time import OVER_TIME
from frbcli.film.cavitation.table import SHIPPED

PAGE = DOCS / "case-file.md"

HEAD = """# The case file

A case is one TOML file: rotor, bearings, oil, films, speed. `frb cases jeffcott` prints a complete one, `frb cases
jeffcott -o my.toml` copies it, `frb check my.toml` lists its faults, and `frb schema > case.schema.json` writes a
schema for editors.

- A quantity is a text of number and unit, `"35 um"`; a bare number is in the unit in brackets below. Any unit of the
  same kind is accepted: `"12 mPa*s"`, `"5000 N/mm"`, `"3 g*mm"`, `"18000 rpm"`, `"15 deg"`, `"100 degC"`.
- Values outside the usual range need a confirmation: `confirm = ["clearance"]` above all tables, or `--set
  confirm='["clearance"]'`.
- Pressures are absolute. [Conventions](conventions.md) has frames, angles and signs. Files are named from the folder
  of the case.
- `--set bearing.clearance="40 um"` sets one key for one call and can be repeated. `bearing.1.width` is a key of the
  second `[[bearing]]`, `bearing.support.stiffness.1` the second value of a list.
- All faults of a file are reported together, each with its line and a remedy. The [matrix](matrix.md) shows which
  combinations are supported.

From Python, `frbcli.case_from_dict` takes the same tables as nested dicts. `case.source_text` is the TOML text of any
case. A case is frozen: `case.with_settings("oil.viscosity = 50 mPa*s", ...)`, or with a dict, gives another case,
checked as a file is.

Each line has a key, its unit or values with the default, and its meaning. Keys marked * must be given. `cd tests &&
python -m pages.case_reference` writes this page from the schema.
"""

# table of the file: name of its model in the schema
TABLES = {
    "top level": "Case",
    '[rotor] kind = "rigid"': "RigidRotor",
    '[rotor] kind = "jeffcott"': "JeffcottRotor",
    '[rotor] kind = "turbocharger"': "TurbochargerRotor",
    "[[shaft]]": "ShaftSection",
    "[[disk]]": "Disk",
    "loss = { ... }": "Loss",
    "[[bow]]": "Bow",
    '[bearing] kind = "single-film"': "SingleFilmBearing",
    '[bearing] kind = "floating-ring"': "FloatingRingBearing",
    '[bearing] kind = "cartridge"': "CartridgeBearing",
    '[bearing] kind = "coefficients"': "CoefficientsBearing",
    '[bearing] kind = "ball"': "BallBearingKeys",
    "ball_material, ring_material = { ... }": "RollingMaterial",
    "preload = { offset = ... }": "AxialOffset",
    "[[thrust_bearing]]": "ThrustBearing",
    "[axial]": "Axial",
    "load = { ... } of [axial]": "LoadAtSpeed",
    "over_speed = { ... }": "CoefficientsOverSpeed",
    "[bearing.damper]": "Damper",
    "[bearing.support]": "Support",
    "[housing]": "Housing",
    "mounts = [{ ... }]": "Mount",
    "modes = [{ ... }]": "HousingMode",
    "at = [{ ... }]": "ModeAt",
    "masses = [{ ... }]": "MassAt",
    "[[force]]": "AppliedForce",
    "[[magnetic_pull]]": "MagneticPull",
    "[[spring]]": "Spring",
    "[base]": "Base",
    "over_time = { ... }": "OverTime",
    "[bearing.ring]": "Ring",
    "[bearing.pin]": "Pin",
    "[bearing.inner], [bearing.outer]": "RingFilm",
    "clearance = { cold = ... }": "ColdClearance",
    "ends = { sealed = ... }": "SealedEnds",
    "ends = { bath_level = ... }": "PartBath",
    "clearance_steps = [{ ... }]": "ClearanceStep",
    "lobes = { ... }": "Lobes",
    **{f'supply = {{ kind = "{kind_of(supply)}" }}': supply.__name__ for supply in SUPPLIES},
    "[oil]": "Oil",
    "[oil.vogel]": "Vogel",
    "viscosity = { grade = ... }": "Grade",
    "viscosity = { points = ... }": "ViscosityPoints",
    "[thermal]": "Thermal",
    "shaft, housing = { ... }": "WallNode",
    "[film]": "FilmModel",
    **{f"[film.{law.name}]": law.__name__ for law in SHIPPED if law.keys},
    "[speed]": "SpeedRamp",
    "[drive]": "Drive",
    "[motion]": "KinematicMotion",
    "[start]": "Start",
    "[contact]": "Contact",
    "[accuracy]": "Accuracy",
    "[output]": "Output",
    "[output.films]": "FilmFrames",
}


# keys that several tables have, once on the page: title, a model that has them, the first and the last one
SHARED = (
    ("Keys of every film", "RingFilm", ("width", "side_flow_factor")),
    ("Keys of every bearing with a film", "SingleFilmBearing", ("shaft", "supply_temperature")),
    ("Keys of rings", "CartridgeBearing", ("centrifugal_pressure", "pin")),
    ("Keys of every supply", "Pocket", ("pressure", "flow")),
)

Rows = dict[str, tuple[str, str]]


def page() -> str:
    """The whole page."""
    schema = json_schema()
    models = schema["$defs"] | {"Case": schema}
    if left := set(models) - set(TABLES.values()):
        raise ValueError(f"no place on the page for {sorted(left)}")
    shared = {title: _between(_rows(models[model]), *ends) for title, model, ends in SHARED}
    sections = [_section(f"`{title}`", models[name], shared) for title, name in TABLES.items()]
    return "\n".join([HEAD, *sections, *(_text(title, "", rows) for title, rows in shared.items())])


def _section(title: str, model: dict[str, Any], shared: dict[str, Rows]) -> str:
    rows = _rows(model)
    links = []
    for name, common in shared.items():
        if all(rows.get(key) == row for key, row in common.items()):
            rows = {key: row for key, row in rows.items() if key not in common}
            links.append(f"[{name[0].lower()}{name[1:]}](#{name.lower().replace(' ', '-')})")
    words = [" ".join(model["description"].split("\n\n")[0].split())]
    return _text(title, " ".join([*words, *([f"It also has the {' and the '.join(links)}."] if links else [])]), rows)


def _text(title: str, words: str, rows: Rows) -> str:
    """A section; neighbours of one value and meaning share a line."""
    lines: list[tuple[list[str], tuple[str, str]]] = []
    for key, row in rows.items():
        if lines and lines[-1][1] == row:
            lines[-1][0].append(key)
        else:
            lines.append(([key], row))
    items = "\n".join(f"- {', '.join(keys)} ({value}): {meaning}" for keys, (value, meaning) in lines)
    return "\n\n".join(filter(None, (f"## {title}", words, items))) + "\n"


def _rows(model: dict[str, Any]) -> Rows:
    """Value and meaning of every key but the kind, which the title has."""
    required = model.get("required", ())
    entries = {key: entry for key, entry in model["properties"].items() if key != "kind"}
    return {f"`{key}`{' *' * (key in required)}": _row(entry, key in required) for key, entry in entries.items()}


def _between(rows: Rows, first: str, last: str) -> Rows:
    """The rows from one key to another."""
    names = [key.strip("`* ") for key in rows]
    return dict(list(rows.items())[names.index(first) : names.index(last) + 1])


def _row(entry: dict[str, Any], required: bool) -> tuple[str, str]:
    meaning = entry.get("description", "")
    if meaning.startswith(("a quantity in", "a plain number")):
        meaning = ""
    default = "" if required else _default(entry)
    return f"{_value(entry)} = {default}" if default else _value(entry), meaning


def _value(entry: dict[str, Any]) -> str:
    """What a key takes, in words."""
    if "const" in entry:
        return f"`{entry['const']}`"
    if "enum" in entry:
        return ", ".join(f"`{choice}`" for choice in entry["enum"])
    if "anyOf" in entry.get("items", {}) and "$ref" not in str(entry["items"]):
        return f"list of {_value(entry['items'])}"
    if "enum" in entry.get("items", {}):
        return f"list of {_value(entry['items'])}"
    if "prefixItems" in entry.get("items", {}):
        return f"list of {_value(entry['items'])}"
    if "prefixItems" in entry:
        return f"[{', '.join(_value(item) for item in entry['prefixItems'])}]"
    if entry.get("description") == OVER_TIME:
        return OVER_TIME
    forms = entry.get("anyOf", entry.get("oneOf", []))
    forms = [form for form in forms if form.get("type") != "null"]
    if len(forms) == 2 and forms[0].get("type") == "number" and forms[1].get("type") == "string":
        unit = forms[0]["description"].removeprefix("in ")
        return "number" if unit == "without unit" else f"`{unit}`" if "*" in unit else unit  # "*" would be emphasis
    if forms:
        return " or ".join(dict.fromkeys(_value(form) for form in forms))
    names = {"integer": "integer", "string": "text", "array": "tables", "boolean": "`true`, `false`"}
    return "table" if "$ref" in entry else names.get(entry.get("type", ""), "table")


def _default(entry: dict[str, Any]) -> str:
    default = entry.get("default")
    if (
        default in (None, "", []) or isinstance(default, dict) or default != default
    ):  # NaN: another key's value, see its meaning
        return ""
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    return f"`{default:g}`" if isinstance(default, float) else f"`{default}`"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
