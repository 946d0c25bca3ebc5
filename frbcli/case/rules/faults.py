"""Validation errors of the models, as faults with a remedy in the terms of the case file."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from frbcli.case.model import Count, Model, Quantity
from frbcli.case.reading.tables import Path, at
from frbcli.case.rules.checks import Breach
from frbcli.case.schema import Case
from frbcli.errors import did_you_mean, nearest
from frbcli.units import ValueFault, display, quantity

_FORMS = {
    "string_type": ("is not text.", "Write it in quotes."),
    "string_unicode": ("is not text.", "Write plain letters."),
    "model_type": ("is not a table.", "Write its keys below a header in brackets."),
    "model_attributes_type": ("is not a table.", "Write its keys below a header in brackets."),
    "tuple_type": ("is not a list.", "Write it in brackets: [ , ]."),
    "too_short": ("has too few entries.", "Add what is missing."),
    "too_long": ("has too many entries.", "Remove the surplus."),
}


CAVITATION: Path = ("film", "cavitation")  # which takes names that are added from Python

# Words that engineers know and a case does not have, with what takes their place: parts of the value of a key, by the
# key, or by the table whose kind it is.
VALUES_ELSEWHERE = {
    "bearing": {
        "semi": 'A ring that may not turn is kind = "floating-ring" with [bearing.pin], or with ring.spin = "blocked"; '
                'one ring over both journals is kind = "cartridge".',
        **dict.fromkeys(
            ("pad", "foil", "roller", "needle", "magnet"),
            'It is not modelled: kind = "coefficients" takes its stiffness and damping.',
        ),
        **dict.fromkeys(("sfd", "squeeze", "damper"), "Write [bearing.damper], the film around a bearing."),
        **dict.fromkeys(("plain", "journal", "hydrodynamic", "sleeve", "lemon"), 'Write kind = "single-film".'),
        **dict.fromkeys(("contact", "rolling", "deep"), 'Write kind = "ball".'),
        **dict.fromkeys(("spring", "linear", "rigid"), 'Write kind = "coefficients", with stiffness and damping.'),
    },
    "rotor": {
        "laval": 'Write kind = "jeffcott".',
        **dict.fromkeys(("flex", "elastic", "shaft", "beam"), 'Write kind = "turbocharger", with sections [[shaft]].'),
    },
    "cavitation": {
        **dict.fromkeys(("gumbel", "gümbel", "guembel", "pi-film"), 'Write "half-sommerfeld".'),
        **dict.fromkeys(("jfo", "jakobsson", "ausas", "conserv"), 'Write "elrod", which is this model.'),
        **dict.fromkeys(("swift", "stieber", "christopherson"), 'Write "reynolds".'),
        **dict.fromkeys(("full-sommerfeld", "none", "2pi"), 'Write "sommerfeld".'),
    },
    "theory": {
        **dict.fromkeys(("ocvirk", "dubois", "narrow"), 'Write "short".'),
        **dict.fromkeys(("long", "infinite"), 'The width counts always: write "finite".'),
        **dict.fromkeys(("fem", "fvm", "fdm", "element", "volume", "full", "2d"), 'Write "finite".'),
    },
    "supply": dict.fromkeys(("hole", "drill"), 'Write kind = "bores".'),
    "ends": {
        **dict.fromkeys(("open", "air", "ambient"), 'Write "free-to-air".'),
        **dict.fromkeys(("flood", "bath", "submerged"), 'Write "oil-bath".'),
    },
}  # fmt: skip
OF_POINTS = 'For another oil give density and { points = [["40 degC", "22 cSt"], ["100 degC", "4.3 cSt"]] }.'
OVER_RATE = "Write duration, the difference of the speeds over this rate."
OF_RATIO = "Write shaft_damping, 2 zeta times the root of stiffness times mass."
KEYS_ELSEWHERE = {  # (the key that takes its place, in whose table alone it is answered; the words)
    **dict.fromkeys(("radius", "R"), ("diameter", "Write diameter{twice}.")),
    "L_D": ("width", "Write width and diameter."),
    "length": ("width", "Write width."),
    "type": ("kind", "Write kind."),
    **dict.fromkeys(("grade", "vg"), ("viscosity", 'Write viscosity = "ISO VG 32", and temperature.')),
    "dynamic_viscosity": ("viscosity", 'Write viscosity = "12 mPa*s".'),
    **dict.fromkeys(("kinematic_viscosity", "nu"), ("viscosity", 'Write viscosity = "12 cSt", and density.')),
    **dict.fromkeys(("eta", "mu"), ("viscosity", 'Write viscosity = "12 mPa*s".')),
    **dict.fromkeys(("sae", "iso", "iso_vg"), ("viscosity", 'Write viscosity = "ISO VG 32", and temperature.')),
    **dict.fromkeys(("rho", "dichte"), ("density", "Write density.")),
    "weight": ("mass", "Write mass."),
    "gap": ("clearance", "Write clearance."),
    **dict.fromkeys(
        ("play", "diametral_play", "spiel", "Lagerspiel"),
        ("clearance", "Write clearance, half of a diametral play{half}."),
    ),
    **dict.fromkeys(("D", "d", "bore", "durchmesser"), ("diameter", "Write diameter.")),
    **dict.fromkeys(("B", "L", "breite"), ("width", "Write width.")),
    **dict.fromkeys(("damping_ratio", "zeta"), ("shaft_damping", OF_RATIO)),
    **dict.fromkeys(("fs", "sample_rate"), ("step", "Write step, the inverse of the rate.")),
    "dt": ("step", "Write step."),
    "preload": ("lobes", "Write preload in lobes."),
    "unwucht": ("unbalance", "Write unbalance."),
    "gravity": ("rotor", "Write gravity in [rotor]."),
    **dict.fromkeys(("eccentricity", "e"), ("unbalance", "Write unbalance, the mass times this eccentricity.")),
    **dict.fromkeys(("cp", "c_p", "specific_heat"), ("heat_capacity", "Write heat_capacity.")),
    "angle": ("phase", "Write phase."),
    **dict.fromkeys(("x", "z", "station", "axial_position"), ("position", "Write position.")),
    "E": ("youngs_modulus", "Write youngs_modulus."),
    "material": ("youngs_modulus", "Write density and youngs_modulus."),
    **dict.fromkeys(("od", "OD", "outer_diameter"), ("diameter", "Write diameter.")),
    **dict.fromkeys(("id", "ID"), ("inner_diameter", "Write inner_diameter.")),
    **dict.fromkeys(("Ip", "Jp", "I_p"), ("polar_inertia", "Write polar_inertia.")),
    **dict.fromkeys(("Id", "It", "Jd", "I_d", "I_t"), ("diametral_inertia", "Write diametral_inertia.")),
    **dict.fromkeys(("max", "end", "stop", "drehzahl"), ("to", "Write to.")),
    **dict.fromkeys(("min", "start"), ("from", "Write from.")),
    **dict.fromkeys(("ramp", "acceleration", "rate"), ("duration", OVER_RATE)),
    "rpm": ("to", 'Write the unit with the number, e.g. to = "18000 rpm".'),
    **dict.fromkeys(("radial_clearance", "C", "c", "Cr"), ("clearance", "Clearances are radial: write clearance.")),
    **dict.fromkeys(
        ("psi", "relative_clearance", "clearance_ratio"), ("clearance", "Write clearance, this times the radius.")
    ),
    **dict.fromkeys(
        ("diametral_clearance", "diametrical_clearance", "cd", "Cd", "C_d"),
        ("clearance", "Clearances are radial: write clearance, half of the diametral one{half}."),
    ),
}
UNKNOWN, MISSING = "is not known here.", "is missing."

BY_PLACE: tuple[Path, ...] = (("masses",), ("at",))  # tables by places, which are lists in the case


@dataclass(frozen=True)
class _Place:
    """Where an error belongs: the model that owns the key, and the field of the key if there is one."""

    models: tuple[type[Model], ...]
    field: FieldInfo | None


def objections(error: ValidationError, data: dict[str, Any]) -> Iterator[Breach]:
    """Each error of the models in `data`, with the path of its key in the file."""
    details = [(_path(detail["loc"], data), detail) for detail in error.errors(include_url=False)]
    # a value that was taken over from another key is not present, and that key has the same fault
    own = [(path, detail) for path, detail in details if detail["type"] == "missing" or at(data, path) is not None]
    for path, detail in own or details:
        yield _breach(path, detail["loc"], detail["type"], {"input": detail["input"], **detail.get("ctx", {})})


def with_nearest_kinds(error: ValidationError, data: dict[str, Any]) -> tuple[dict[str, Any], list[Path]]:
    """(`data` with each misspelt `kind` replaced by the nearest known, so that the rest of its table is read, too; the
    paths of these tables)."""
    guess, guessed = copy.deepcopy(data), list[Path]()
    for detail in error.errors(include_url=False):
        if detail["type"] != "union_tag_invalid":
            continue
        table: Any = guess
        guessed.append(_path(detail["loc"], data))
        for element in guessed[-1]:
            table = table[element]
        table["kind"] = next(iter(nearest(str(detail["ctx"]["tag"]), _kinds(detail["loc"]))), table["kind"])
    return guess, guessed


def _path(loc: Sequence[str | int], data: Any) -> Path:
    """The path in the file; the models' own additions to it (the kind of a table, index 0 of a single one) left out."""
    path: Path = ()
    kind_seen = False
    for element in loc:
        if str(element).startswith("("):
            continue
        if isinstance(data, dict):
            if isinstance(element, int):
                if path[-1:] in BY_PLACE and element < len(data):
                    path = (*path, list(data)[element])
                    data = data[path[-1]]
                continue
            if not kind_seen and element == data.get("kind"):
                kind_seen = True
                continue
        elif isinstance(element, int) and isinstance(data, str | int | float):
            continue  # one quantity instead of a matrix
        elif path[-2:-1] in BY_PLACE and isinstance(element, str):
            continue  # the value itself, which a table by places has without its name
        path = (*path, element)
        kind_seen = False
        data = at(data, (element,))
    return path


def _breach(path: Path, loc: Sequence[str | int], kind: str, context: dict[str, Any]) -> Breach:
    cause = context.get("error")
    if isinstance(cause, ValueFault):
        return Breach(path, cause.problem, cause.remedy)
    if kind == "missing":
        return Breach(path, MISSING, _how_to_add(path, _place(loc).field))
    if kind == "extra_forbidden":
        return Breach(path, UNKNOWN, _nearest(str(loc[-1]), _place(loc[:-1]).models, context["input"]))
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        problem = MISSING if kind == "union_tag_not_found" else UNKNOWN
        tag = str(context.get("tag", ""))
        table = tuple(part for part in path if isinstance(part, str))[-1:]
        return Breach((*path, "kind"), problem, _elsewhere(table, tag) or did_you_mean(tag, _kinds(loc)))
    if kind == "literal_error":
        given = str(context["input"])
        elsewhere = _elsewhere(path[-1:], given)
        remedy = elsewhere or did_you_mean(given, _choices(_place(loc).field))
        if path == CAVITATION and not elsewhere:
            remedy += " A law of your own is added in this process before the case is read: frbcli.add_law."
        return Breach(path, UNKNOWN, f"{remedy} {OF_POINTS}" if path[-1] == "grade" else remedy)
    field = _place(loc).field
    if kind == "tuple_type" and field is not None and _parts(field.annotation, Model):
        kind = "model_type"
    return Breach(path, *_FORMS.get(kind, ("has the wrong form.", "`frb schema` prints what a case holds.")))


def _elsewhere(key: Path, given: str) -> str:
    """What takes the place of a value of a key, or of the kind of a table; empty if it is not known."""
    known = VALUES_ELSEWHERE.get(str(key[0]), {}) if key else {}
    return next((words for part, words in known.items() if part in given.lower()), "")


def _place(loc: Sequence[str | int]) -> _Place:
    models: tuple[type[Model], ...] = (Case,)
    field: FieldInfo | None = None
    for element in loc:
        if isinstance(element, int) or element.startswith("("):
            continue
        if len(models) > 1 and all("kind" in model.model_fields for model in models):  # and this is its kind
            models = tuple(model for model in models if element in _choices(model.model_fields.get("kind")))
            continue
        fields = {key: field for model in models for key, field in _fields(model).items()}
        field = fields.get(element)
        models = _parts(field.annotation, Model) if field else ()
    return _Place(models, field)


def _fields(model: type[Model]) -> dict[str, FieldInfo]:
    """The fields of `model` by their keys in the file."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def _parts(annotation: Any, base: type[Any]) -> tuple[Any, ...]:
    """The parts of an annotation that derive from `base`: subclasses of it, or instances of it."""
    if isinstance(annotation, base) or (isinstance(annotation, type) and issubclass(annotation, base)):
        return (annotation,)
    return tuple(part for argument in get_args(annotation) for part in _parts(argument, base))


def _choices(field: FieldInfo | None) -> list[str]:
    if field is None:
        return []
    annotation = field.annotation
    forms = [annotation] if get_origin(annotation) is Literal else list(get_args(annotation))
    literals = [get_args(form)[0] if get_origin(form) is Annotated else form for form in forms]
    return [str(name) for literal in literals if get_origin(literal) is Literal for name in get_args(literal)]


def _kinds(loc: Sequence[str | int]) -> list[str]:
    return [name for model in _place(loc).models for name in _choices(model.model_fields.get("kind"))]


def _example(field: FieldInfo | None) -> str:
    """An example of a value as written in a file, or nothing."""
    if field is None:
        return ""
    for kind in (Quantity, Count):
        for example in (*field.metadata, *_parts(field.annotation, kind)):
            if isinstance(example, kind):
                return example.written_example()
    choices = _choices(field)
    return f'"{choices[0]}"' if choices else ""


def _how_to_add(path: Path, field: FieldInfo | None) -> str:
    if isinstance(path[-1], int):
        return "Give as many values as it has directions."
    example = _example(field)
    if example:
        return f"Add e.g. {path[-1]} = {example}."
    header = ".".join(part for part in path if isinstance(part, str))
    return f"Add the table [{header}]."


def _nearest(key: str, models: Sequence[type[Model]], value: object) -> str:
    known = [name for model in models for name in _fields(model)]
    instead, words = KEYS_ELSEWHERE.get(key, ("", ""))
    if instead in known and key not in known:
        return words.format(half=_times(0.5, value), twice=_times(2.0, value))
    return did_you_mean(key, known, f"Known are: {', '.join(known)}.")


def _times(factor: float, value: object) -> str:
    """A length times a factor in words, nothing if it cannot be read."""
    try:
        return f": {display(factor * quantity(value, 'm'), 'm')}"
    except ValueFault:
        return ""
