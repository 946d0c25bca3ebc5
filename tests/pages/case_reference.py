"""Writes docs/case-file.md from the JSON Schema of a case: `cd tests && python -m pages.case_reference`."""

from __future__ import annotations

from typing import Any

from paths import DOCS

from frbcli.case.schema import json_schema
from frbcli.case.supplies.table import SUPPLIES, kind_of
from frbcli.case.surroundings.over_time import OVER_TIME
from frbcli.film.cavitation.table import SHIPPED

PAGE = DOCS / "case-file.md"

HEAD = """# The case file

A case is one TOML file: rotor, bearings, oil, solution of the films, speed profile. `frb cases jeffcott` prints
a complete one, `frb cases jeffcott -o my.toml` copies it, `frb check my.toml` lists its faults and what will be
modelled, and `frb schema > case.schema.json` writes a schema for editors.

- A quantity is a text of number and unit, `"35 um"`; a bare number is in the unit of the table below, and `frb check`
  lists the bare numbers. Any unit of the same kind is accepted: `"12 mPa*s"`, `"5000 N/mm"`, `"3 g*mm"`,
  `"18000 rpm"`, `"15 deg"`, `"100 degC"`.
- Values outside the usual range, mostly by a wrong unit, are refused unless the list `confirm` names them:
  `confirm = ["clearance"]` above all tables, or `--set confirm='["clearance"]'`.
- Rotor speeds and frequencies are in Hz, revolutions or periods per second. Pressures are absolute. Angles phi are 0 at
  the top and count counter-clockwise; angles of a displacement count from the x-axis (see
  [conventions](conventions.md)).
- `--set bearing.clearance="40 um"` sets one key for one call of any command that takes a case, and can be repeated.
  `bearing.1.width` is a key of the second `[[bearing]]`, `bearing.support.stiffness.1` the second value of a list.
- An unknown key is a fault. All faults of a file are reported together, each with its line and a remedy. Combinations
  that are not modelled are refused before anything is computed.

From Python, `frbcli.case_from_dict` takes the same tables as nested dicts with the same checks. `case.source_text` is
the TOML text of any case, also of one that was made or changed in Python; a run file contains it. A case is frozen:
`case.with_settings("oil.viscosity = 50 mPa*s", ...)`, or with a dict `{"oil.viscosity": "50 mPa*s"}`, gives another
case, checked as a file is.

This page is written from the schema by `cd tests && python -m pages.case_reference`; a test checks that it is up to
date.
"""

# table of the file: name of its model in the schema
TABLES = {
    "top level": "Case",
    '[rotor] kind = "rigid"': "RigidRotor",
    '[rotor] kind = "jeffcott"': "JeffcottRotor",
    '[rotor] kind = "turbocharger"': "TurbochargerRotor",
    "[[shaft]]": "ShaftSection",
    "[[disk]]": "Disk",
    '[bearing] kind = "single-film"': "SingleFilmBearing",
    '[bearing] kind = "floating-ring"': "FloatingRingBearing",
    '[bearing] kind = "cartridge"': "CartridgeBearing",
    '[bearing] kind = "coefficients"': "CoefficientsBearing",
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
    "[motion]": "KinematicMotion",
    "[start]": "Start",
    "[contact]": "Contact",
    "[accuracy]": "Accuracy",
    "[output]": "Output",
    "[output.films]": "FilmFrames",
}


def page() -> str:
    """The whole page."""
    schema = json_schema()
    models = schema["$defs"] | {"Case": schema}
    if left := set(models) - set(TABLES.values()):
        raise ValueError(f"no place on the page for {sorted(left)}")
    return "\n".join([HEAD, *(_section(title, models[name]) for title, name in TABLES.items())])


def _section(title: str, model: dict[str, Any]) -> str:
    rows = [_row(key, entry, key in model.get("required", ())) for key, entry in model["properties"].items()]
    text = " ".join(model["description"].split("\n\n")[0].split())
    head = ["| key | value | default | meaning |", "|" + " --- |" * 4]
    return "\n".join([f"## `{title}`", "", text, "", *head, *rows, ""])


def _row(key: str, entry: dict[str, Any], required: bool) -> str:
    meaning = entry.get("description", "")
    if meaning.startswith(("a quantity in", "a plain number")):
        meaning = ""
    return f"| `{key}` | {_value(entry)} | {_default(entry, required)} | {meaning} |"


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
        return "number" if unit == "without unit" else unit
    if forms:
        return " or ".join(dict.fromkeys(_value(form) for form in forms))
    names = {"integer": "whole number", "string": "text", "array": "tables", "boolean": "`true` or `false`"}
    return "table" if "$ref" in entry else names.get(entry.get("type", ""), "table")


def _default(entry: dict[str, Any], required: bool) -> str:
    if required:
        return "must be given"
    default = entry.get("default")
    if default in (None, "", []) or default != default:  # NaN: another key's value, see its meaning
        return ""
    if isinstance(default, dict):
        return "as its table"
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    return f"`{default:g}`" if isinstance(default, float) else f"`{default}`"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
