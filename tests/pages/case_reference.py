"""Writes docs/case-file.md from the JSON Schema of a case: `cd tests && python -m pages.case_reference`."""

import re
from itertools import groupby
from typing import Any

from paths import DOCS

from frbcli.case.over_time import OVER_TIME
from frbcli.case.schema import json_schema
from frbcli.case.supplies import SUPPLIES, kind_of
from frbcli.film.cavitation.table import SHIPPED

PAGE = DOCS / "case-file.md"

HEAD = """# The case file

A case is one TOML file. `frb cases jeffcott` prints a complete one, `frb cases jeffcott -o my.toml` copies it, `frb
check my.toml` lists its faults with remedies, and `frb schema > case.schema.json` writes a schema for editors.

- A quantity is a text of number and unit, `"35 um"`; a bare number is in the unit in brackets below. Any unit of the
  same kind is accepted: `"12 mPa*s"`, `"18000 rpm"`, `"15 deg"`, `"100 degC"`.
- Pressures are absolute. [Conventions](conventions.md) has frames, angles and signs. Files are named from the folder
  of the case.
- `--set bearing.clearance="40 um"` sets one key for one call. `bearing.1.width` is a key of the second `[[bearing]]`,
  `bearing.support.stiffness.1` the second value of a list.
- The [matrix](matrix.md) shows which combinations are supported.

From Python, `frbcli.case_from_dict` takes the same tables as nested dicts, and `case.source_text` is the TOML text. A
case is frozen: `case.with_settings("oil.viscosity = 50 mPa*s", ...)`, or with a dict, gives a changed and checked copy.

A line has a key (*: required), its unit or values (none: a number, text or table), the default in `code`, and its
meaning. The first of several values is the default, unless the meaning names another. "[x, y]": a value for each
direction, or one for both. `cd tests && python -m pages.case_reference` writes this page.
"""

# table of the file: name of its model in the schema
TABLES = {
    "top level": "Case",
    '[rotor] kind = "rigid"': "RigidRotor",
    '[rotor] kind = "jeffcott"': "JeffcottRotor",
    '[rotor] kind = "turbocharger"': "TurbochargerRotor",
    "[[shaft]]": "ShaftSection",
    "[[disk]]": "Disk",
    "loss = {...}": "Loss",
    "[[bow]]": "Bow",
    '[bearing] kind = "single-film"': "SingleFilmBearing",
    '[bearing] kind = "floating-ring"': "FloatingRingBearing",
    '[bearing] kind = "cartridge"': "CartridgeBearing",
    '[bearing] kind = "coefficients"': "CoefficientsBearing",
    '[bearing] kind = "ball"': "BallBearingKeys",
    "ball_material, ring_material = {...}": "RollingMaterial",
    "preload = {offset}": "AxialOffset",
    "friction = {...}": "BallFriction",
    "[[thrust_bearing]]": "ThrustBearing",
    "[axial]": "Axial",
    "load = {...} of [axial]": "LoadAtSpeed",
    "over_speed = {...}": "CoefficientsOverSpeed",
    "[bearing.damper]": "Damper",
    "[bearing.support]": "Support",
    "[housing]": "Housing",
    "mounts = [{...}]": "Mount",
    "modes = [{...}]": "HousingMode",
    "at = [{...}]": "ModeAt",
    "masses = [{...}]": "MassAt",
    "[[force]]": "AppliedForce",
    "[[magnetic_pull]]": "MagneticPull",
    "[[spring]]": "Spring",
    "[base]": "Base",
    "over_time = {...}": "OverTime",
    "[bearing.ring]": "Ring",
    "[bearing.pin]": "Pin",
    "[bearing.inner], [bearing.outer]": "RingFilm",
    "clearance = {cold}": "ColdClearance",
    "ends = {sealed}": "SealedEnds",
    "ends = {bath_level}": "PartBath",
    "clearance_steps = [{...}]": "ClearanceStep",
    "lobes = {...}": "Lobes",
    **{f'supply.kind = "{kind_of(supply)}"': supply.__name__ for supply in SUPPLIES},
    "[oil]": "Oil",
    "[oil.vogel]": "Vogel",
    "viscosity = {grade}": "Grade",
    "viscosity = {points}": "ViscosityPoints",
    "[thermal]": "Thermal",
    "shaft, housing = {...}": "WallNode",
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


# keys that several tables have, once on the page: title, a model that has them, and the keys
FILM_KEYS = "width diameter clearance clearance_steps ends supply lobes profile viscosity temperature side_flow_factor"
SHARED = (
    ("Rotor keys", "RigidRotor", "unbalance loss external_damping polar_inertia gravity"),
    ("Bearing keys", "BallBearingKeys", "name position damper support"),
    ("Film keys", "RingFilm", FILM_KEYS),
    ("Wall keys", "SingleFilmBearing", "shaft housing supply_temperature"),
    ("Ring keys", "CartridgeBearing", "centrifugal_pressure channels pin"),
    ("Supply keys", "Pocket", "pressure ramp flow"),
)
PLAIN = ("number", "text", "table", "tables")  # values that the meaning or the title of a section shows
LONG = 4  # values of a key that are named at their first place only

Rows = dict[str, tuple[str, str]]


def page() -> str:
    """The whole page."""
    schema = json_schema()
    models = schema["$defs"] | {"Case": schema}
    if left := set(models) - set(TABLES.values()):
        raise ValueError(f"no place on the page for {sorted(left)}")
    shared = {title: _of(_rows(models[model]), keys.split()) for title, model, keys in SHARED}
    sections = [_section(f"`{title}`", models[name], shared) for title, name in TABLES.items()]
    text = "\n".join([HEAD, *sections, *(_text(title, "", rows) for title, rows in shared.items())])
    return _named_once(text)


def _section(title: str, model: dict[str, Any], shared: dict[str, Rows]) -> str:
    rows = _rows(model)
    links = []
    for name, common in shared.items():
        if all(rows.get(key) == row for key, row in common.items()):
            rows = {key: row for key, row in rows.items() if key not in common}
            links.append(f"[{name.lower()}](#{name.lower().replace(' ', '-')})")
    inline = "{" in title and not model["description"].startswith("Values")
    words = [] if inline else [" ".join(model["description"].split("\n\n")[0].split())]
    return _text(title, " ".join([*words, *([f"Also: {', '.join(links)}."] if links else [])]), rows)


def _text(title: str, words: str, rows: Rows) -> str:
    """A section; neighbours of one meaning share a line."""
    lines = []
    for meaning, of_meaning in groupby(rows.items(), lambda item: item[1][1]):
        by_value = groupby(of_meaning, lambda item: item[1][0])
        keys = [f"{', '.join(key for key, _ in some)}{value and f' ({value})'}" for value, some in by_value]
        lines.append(f"- {', '.join(keys)}: {meaning}")
    items = "\n".join(lines)
    return "\n\n".join(filter(None, (f"## {title}", words, items))) + "\n"


def _rows(model: dict[str, Any]) -> Rows:
    """Value and meaning of every key but the kind, which the title has."""
    required = model.get("required", ())
    entries = {key: entry for key, entry in model["properties"].items() if key != "kind"}
    return {f"`{key}`{'*' * (key in required)}": _row(entry, key in required) for key, entry in entries.items()}


def _of(rows: Rows, keys: list[str]) -> Rows:
    """The rows of some keys."""
    return {key: row for key, row in rows.items() if key.strip("`*") in keys}


def _named_once(text: str) -> str:
    """The page with long lists of values at their first place; later ones name the key of the first and the default."""
    seen: dict[frozenset[str], tuple[str, str]] = {}

    def one(line: re.Match[str]) -> str:
        key, values = line[1], line[2].split(", ")
        if len(values) < LONG:
            return line[0]
        first, default = seen.setdefault(frozenset(values), (key, ""))
        if not default:
            seen[frozenset(values)] = first, values[0]
            return line[0]
        return f"- {key} (as {first}{f', {values[0]}' if values[0] != default else ''})"

    return re.sub(r"^- (`\w+`)\*? \((`[^`()]+`(?:, `[^`()]+`)+)\)", one, text, flags=re.MULTILINE)


def _row(entry: dict[str, Any], required: bool) -> tuple[str, str]:
    meaning = entry.get("description", "")
    if meaning.startswith(("a quantity in", "a plain number")):
        meaning = ""
    default = "" if required else _default(entry)
    value = " or ".join(form for form in _value(entry).split(" or ") if form not in PLAIN)
    if default and default in value.split(", "):  # the first of the values
        return ", ".join([default, *(each for each in value.split(", ") if each != default)]), meaning
    return ", ".join(filter(None, (value, "" if default == value.split(" or ")[0] else default))), meaning


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
        cells = [_value(cell) for row in entry["prefixItems"] for cell in row.get("prefixItems", ())]
        if len(cells) > 1 and len(set(cells)) == 1:
            return "matrix"
        return f"[{', '.join(_value(item) for item in entry['prefixItems'])}]"
    if entry.get("description") == OVER_TIME:
        return OVER_TIME
    forms = entry.get("anyOf", entry.get("oneOf", []))
    forms = [form for form in forms if form.get("type") != "null"]
    if len(forms) == 2 and forms[0].get("type") == "number" and forms[1].get("type") == "string":
        unit = forms[0]["description"].removeprefix("in ")
        return "number" if unit == "without unit" else f"`{unit}`" if "*" in unit else unit  # "*" would be emphasis
    if forms:
        values = list(dict.fromkeys(_value(form) for form in forms))
        pair = f"[{values[0]}, {values[0]}]"
        return " or ".join("[x, y]" if value == pair != "[table, table]" else value for value in values)
    names = {"integer": "integer", "string": "text", "array": "tables", "boolean": "`true`, `false`"}
    return "table" if "$ref" in entry else names.get(entry.get("type", ""), "table")


def _default(entry: dict[str, Any]) -> str:
    default = entry.get("default")
    if isinstance(default, list) and default and default == default[:1] * len(default):
        default = default[0]  # of both directions
    if (
        default in (None, "", []) or isinstance(default, dict) or default != default
    ):  # NaN: another key's value, see its meaning
        return ""
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    return f"`{default:g}`" if isinstance(default, float) else f"`{default}`"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
