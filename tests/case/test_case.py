"""The case file: what is read, and what is said about what cannot be read."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from frbcli.case.bearing import FloatingRingBearing, SingleFilmBearing
from frbcli.case.reading.lines import key_lines
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.reading.shipped import shipped_cases, shipped_names
from frbcli.case.rotor import JeffcottRotor, TurbochargerRotor
from frbcli.case.schema import Case, json_schema
from frbcli.errors import Fault, InputError

SMALL = """
[rotor]
kind = "rigid"
mass = "6.1 kg"
[bearing]
kind = "single-film"
width = "20 mm"
diameter = "25 mm"
clearance = "35 um"
[oil]
viscosity = "12 mPa*s"
[speed]
from = "0 Hz"
to = "300 Hz"
duration = "10 s"
"""

TURBOCHARGER = """
title = "turbocharger"
[rotor]
kind = "turbocharger"
modes = 6
modal_damping = 0.002
[[shaft]]
length = "100 mm"
diameter = "20 mm"
[[shaft]]
length = "140 mm"
diameter = "28 mm"
[[disk]]
name = "turbine"
position = "224 mm"
mass = "4 kg"
polar_inertia = "4.5e-3 kg*m^2"
diametral_inertia = "4e-3 kg*m^2"
unbalance = "2 g*mm"
phase = "90 deg"
[[bearing]]
kind = "floating-ring"
name = "compressor"
position = "80 mm"
ring = { mass = "75 g", inertia = "20 kg*mm^2" }
[bearing.inner]
width = "20 mm"
diameter = "25 mm"
temperature = "95 degC"
supply = { kind = "bores", count = 6, diameter = "2.5 mm", pressure = "2 bar" }
[bearing.inner.clearance]
cold = "38 um"
shell_temperature = "85 degC"
journal_temperature = "95 degC"
shell_expansion = "1.85e-5 1/K"
journal_expansion = "1.18e-5 1/K"
[bearing.outer]
width = "16 mm"
diameter = "40 mm"
clearance = "50 um"
viscosity = "14 mPa*s"
[[bearing]]
kind = "single-film"
position = "185 mm"
width = "20 mm"
diameter = "25 mm"
clearance = "35 um"
supply = { kind = "pocket", position = "0 deg", opening_angle = "30 deg", width = "10 mm", pressure = "2 bar" }
[oil]
vogel = { eta_0 = "0.06 mPa*s", A = "1000 K", C = "-178 K" }
temperature = "100 degC"
[film]
cavitation = "two-phase"
two-phase = { steepness = 0.95, form = "published", diffusion = "consistent" }
[speed]
from = "0 Hz"
to = "72000 rpm"
duration = "4 s"
[motion]
eccentricity = 0.5
angle = "90 deg"
speed = "20 Hz"
frequency = "10 Hz"
periods = 3
[contact]
policy = "elastic"
stiffness = "1e8 N/m"
[accuracy]
mesh = [10, 20]
[start]
displacement = [0.1, -0.2]
"""


ASPERITIES = "[contact]\nmodel = 'asperities'\nsummit_radius = '20 um'\nsummit_density = '1e10 1/m^2'"


def test_a_model_of_contact_that_is_none_is_the_only_fault() -> None:
    with pytest.raises(InputError) as caught:
        load_case("rigid", ["contact.model=auto", "contact.policy=elastic", "contact.stiffness=1e8 N/m"])
    assert [fault.key for fault in caught.value.faults] == ["contact.model"]


def faults_of(text: str, *settings: str) -> dict[str, Fault]:
    """The faults of a case by their keys."""
    with pytest.raises(InputError) as caught:
        load_case_text(text, settings)
    return {fault.key: fault for fault in caught.value.faults}


def test_small_case_in_si_with_its_defaults() -> None:
    case = load_case_text(SMALL)
    bearing = case.bearings[0]
    assert isinstance(bearing, SingleFilmBearing)
    assert (bearing.width, bearing.clearance, bearing.supply.kind) == (0.02, 35e-6, "none")
    assert (case.rotor.kind, case.rotor.gravity) == ("rigid", 9.81)
    assert case.oil.viscosity == case.viscosity(bearing) == 0.012
    assert case.oil.cavitation_pressure == case.oil.ambient_pressure == 1e5
    assert (case.speed.start, case.speed.end, case.speed.duration) == (0.0, 300.0, 10.0)
    assert (case.speed.hold, case.speed.down_duration) == (0.5, 10.0)
    assert (case.film.theory, case.film.cavitation) == ("auto", "half-sommerfeld")
    assert (case.start.position, case.contact.policy, case.contact.eccentricity) == ("centre", "stop", 0.9999)
    assert (case.accuracy.target, case.accuracy.steps_per_revolution, case.output.step) == (1e-3, 40, 5e-5)


def test_defaults_that_follow_other_keys() -> None:
    case = load_case_text(SMALL, ["oil.ambient_pressure=0.9 bar", "speed.duration=4 s"])
    assert case.oil.cavitation_pressure == 0.9e5
    assert case.speed.down_duration == 4.0


def test_turbocharger_with_everything() -> None:
    case = load_case_text(TURBOCHARGER)
    assert isinstance(case.rotor, TurbochargerRotor)
    assert [section.length for section in case.shaft] == [0.1, 0.14]
    assert case.disks[0].phase == pytest.approx(math.pi / 2)
    first, second = case.bearings
    assert isinstance(first, FloatingRingBearing)
    assert (first.name, second.name) == ("compressor", "2")
    assert (first.ring_mass, first.inner.supply.kind) == (0.075, "bores")
    assert case.film.two_phase.steepness == 0.95
    assert case.motion is not None
    assert case.motion.speed == 20.0
    assert case.speed.end == 1200.0
    assert case.accuracy.mesh == (10, 20)
    assert case.start.displacement == (0.1, -0.2)


def test_warm_clearance_by_equation_4_24() -> None:
    """psi_i = C/R + alpha_F dT_F - alpha_J dT_R."""
    inner = load_case_text(TURBOCHARGER).bearings[0].inner  # type: ignore[union-attr]
    psi = 38e-6 / 12.5e-3 + 1.85e-5 * 65 - 1.18e-5 * 75
    assert inner.clearance == pytest.approx(psi * 12.5e-3, rel=1e-12)


def test_viscosity_of_a_film_is_its_own_or_by_its_own_temperature() -> None:
    case = load_case_text(TURBOCHARGER)
    ring, plain = case.bearings
    assert isinstance(ring, FloatingRingBearing)
    assert isinstance(plain, SingleFilmBearing)
    assert case.viscosity(ring.outer) == 0.014
    assert case.viscosity(ring.inner) == pytest.approx(0.06e-3 * math.exp(1000 / (368.15 - 178)), rel=1e-12)
    assert case.viscosity(plain) == pytest.approx(0.06e-3 * math.exp(1000 / (373.15 - 178)), rel=1e-12)


@pytest.mark.parametrize("text", [SMALL, TURBOCHARGER])
def test_source_text_gives_the_case_again(text: str) -> None:
    case = load_case_text(text, ["title='a \"quoted\" title \\u00e9'", "output.step=1e-4"], name="mine")
    again = load_case_text(case.source_text)
    assert again == case
    assert (again.name, again.title) == ("mine", 'a "quoted" title \\u00e9')
    assert again.source_text == case.source_text


def test_case_is_frozen() -> None:
    with pytest.raises(ValueError, match="frozen"):
        load_case_text(SMALL).oil.density = 1.0


# ---------------------------------------------------------------------------------------------- shipped cases


@pytest.mark.parametrize("name", shipped_names())
def test_shipped_cases_load_and_have_titles(name: str) -> None:
    case = load_case(name)
    assert case.name == name
    assert shipped_cases()[name] == case.title != ""
    if not case.given_bearings or case.motion is not None:  # thrust bearings alone, kinematic tests
        return
    if case.given_bearings[0].kind == "single-film" and case.rotor.kind != "turbocharger" and not case.speed.times:
        assert (case.speed.start, case.speed.end) == (0.0, 300.0)


def test_shipped_cases_are_what_their_names_say() -> None:
    cases = {name: load_case(name) for name in shipped_names()}
    films = {name: case.bearings[0] for name, case in cases.items() if case.bearings}
    assert set(cases) - set(films) == {"seal", "squeeze-film-damper", "thrust"}
    reference = films["jeffcott"]
    assert isinstance(reference, SingleFilmBearing)
    # table A.1 in place of table 4.1 stiffens the film by 1.57, which chapter 6's eccentricities need
    printed = films["jeffcott-table-4-1"]
    assert isinstance(printed, SingleFilmBearing)
    ratio = (cases["jeffcott"].oil.viscosity / reference.clearance**2) / (
        cases["jeffcott-table-4-1"].oil.viscosity / printed.clearance**2
    )
    assert ratio == pytest.approx(1.57, abs=0.005)
    rotor, soft = cases["jeffcott"].rotor, cases["soft-shaft"].rotor
    assert isinstance(rotor, JeffcottRotor)
    assert isinstance(soft, JeffcottRotor)
    assert math.sqrt(rotor.shaft_stiffness / rotor.mass) / (2 * math.pi) == pytest.approx(145.0, rel=0.005)
    assert soft.shaft_stiffness == rotor.shaft_stiffness / 5
    assert cases["rigid"].rotor.mass == rotor.mass + rotor.journal_mass  # type: ignore[union-attr]
    assert films["rigid"] == films["run-down"] == reference
    assert films["soft-shaft"] == films["axial-groove"]
    assert films["soft-shaft"].supply.kind == "axial-grooves"  # type: ignore[union-attr]
    assert films["jeffcott-supply-2bar"].supply.pressure == 2e5  # type: ignore[union-attr]


# ---------------------------------------------------------------------------------------------- settings


def test_settings_override_and_need_no_quotes() -> None:
    case = load_case_text(
        SMALL, ["bearing.clearance=40 um", "speed.to=12000 rpm", "film.theory=short", "bearing.supply={kind='none'}"]
    )
    assert isinstance(case.bearings[0], SingleFilmBearing)
    assert (case.bearings[0].clearance, case.speed.end, case.film.theory) == (40e-6, 200.0, "short")


def test_settings_reach_into_arrays_of_tables() -> None:
    case = load_case_text(TURBOCHARGER, ["bearing.1.width=22 mm", "disk.0.mass=3.5 kg", "bearing.0.outer.width=20 mm"])
    assert case.bearings[1].width == 0.022  # type: ignore[union-attr]
    assert case.disks[0].mass == 3.5
    assert load_case_text(SMALL, ["bearing.0.width=22 mm"]).bearings[0].width == 0.022  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("text", "setting", "key"),
    [
        (SMALL, "no equals sign", "--set"),
        (SMALL, "=3", "--set"),
        (SMALL, "a..b=3", "--set"),
        (SMALL, "a.b.c.d.e.f.g.h.i=3", "--set"),
        (SMALL, "title=\udcff", "--set"),
        (SMALL, "rotor.mass.x=3", "rotor.mass.x"),
        (SMALL, "rotor.mas=3 kg", "rotor.mas"),
        (SMALL, "rotor.mass=3 mm", "rotor.mass"),
        (SMALL, "bearing=[]", "bearing"),
        (TURBOCHARGER, "bearing.width=3 mm", "bearing.width"),
        (TURBOCHARGER, "bearing.7.width=3 mm", "bearing.7.width"),
        (TURBOCHARGER, "accuracy.mesh.0.x=3", "accuracy.mesh.0.x"),
    ],
)
def test_wrong_settings_are_faults_without_a_line(text: str, setting: str, key: str) -> None:
    fault = faults_of(text, setting)[key]
    assert fault.line is None
    assert fault.remedy


# ---------------------------------------------------------------------------------------------- faults


def test_every_fault_at_once_with_key_line_value_and_remedy() -> None:
    text = """title = "all wrong"
[rotor]
kind = "jefcott"
mass = "6 m"
journal_mass = -1
[bearing]
kind = "single-film"
width = "20 mm"
clearence = "35 um"
diameter = "25 mm"
clearance = "5 mm"
supply = { kind = "circumferential-groove", pressure = "0.5 bar" }
ends = "oilbath"
[oil]
viscosity = "12"
[film]
two-phase = { steepness = 2 }
[speed]
from = "0 Hz"
duration = "10 us"
[accuracy]
mesh = [1, 2.5]
"""
    faults = faults_of(text)
    lines = {key: fault.line for key, fault in faults.items()}
    assert lines == {
        "rotor.kind": 3,
        "rotor.mass": 4,
        "rotor.journal_mass": 5,
        "rotor.shaft_stiffness": None,  # missing for a Jeffcott rotor, which the misspelt kind means
        "bearing.clearence": 9,
        "bearing.clearance": 11,
        "bearing.supply.pressure": 12,
        "bearing.ends": 13,
        "oil.viscosity": 15,
        "film.two-phase.steepness": 17,
        "speed.to": None,
        "accuracy.mesh.1": 22,
        "output.step": None,
    }
    assert faults["rotor.kind"].value == '"jefcott"'
    assert faults["rotor.kind"].remedy == 'Did you mean "jeffcott"?'
    assert "5000 N/mm" in faults["rotor.shaft_stiffness"].remedy
    assert faults["bearing.clearence"].remedy == 'Did you mean "clearance"?'
    assert "oil-bath" in faults["bearing.ends"].remedy
    assert "12 mPa*s" in faults["oil.viscosity"].remedy
    for fault in faults.values():
        words = f"{fault.problem} {fault.remedy}".lower()
        assert not any(jargon in words for jargon in ("pydantic", "input", "validation", "union", "literal", "tuple"))


@pytest.mark.parametrize(
    ("old", "new", "key", "problem"),
    [
        ('viscosity = "12 mPa*s"', "", "oil.viscosity", "missing"),
        ('viscosity = "12 mPa*s"', "vogel = { eta_0 = 1e-4, A = 900, C = -178 }", "oil.temperature", "Vogel"),
        (
            'viscosity = "12 mPa*s"',
            'vogel = { eta_0 = 1e-4, A = 900, C = -178 }\ntemperature = "100 K"',
            "oil.temperature",
            "viscosity inf",
        ),
        ("[oil]", "[oil]\nvogel = { eta_0 = 1e-4, A = 900, C = -178 }\ntemperature=400", "oil.vogel", "second time"),
        ("[oil]", '[oil]\ntemperature = "95 degC"', "oil.temperature", "no effect: the viscosity is constant"),
        ("[oil]", '[oil]\ncavitation_pressure = "2 bar"', "oil.cavitation_pressure", "above the ambient"),
        ("[oil]", "[oil]\nambient_pressure = -1", "oil.ambient_pressure", "greater than"),
        ('clearance = "35 um"', "clearance = 35", "bearing.clearance", "too large for a film"),
        ('clearance = "35 um"', 'clearance = "1e-30 m"', "bearing.clearance", "out of range"),
        ('clearance = "35 um"', 'clearance = "35 um"\ntemperature = 350', "bearing.temperature", "no effect"),
        ('clearance = "35 um"', 'clearance = 35e-6\ntemperature = 350\nviscosity = 0.01', "bearing.temperature", "own"),
        ('kind = "single-film"', "", "bearing.kind", "missing"),
        ("[bearing]", "[contact]\npolicy = 'elastic'\n[bearing]", "contact.stiffness", "missing"),
        ("[bearing]", "[contact]\neccentricity = 1\n[bearing]", "contact.eccentricity", "at most 0.9999"),
        ("[bearing]", "[contact]\nroughness = '1 um'\n[bearing]", "contact.roughness", "on rough surfaces only"),
        ("[bearing]", "[contact]\nmodel = 'asperities'\n[bearing]", "contact.summit_radius", "is missing"),
        ("[bearing]", "[contact]\nmodel = 'asperities'\npolicy = 'stop'\n[bearing]", "contact.policy", "smooth surf"),
        ("[bearing]", f"{ASPERITIES}\nroughness = '-1 um'\n[bearing]", "contact.roughness", "greater than"),
        ("[bearing]", f"{ASPERITIES}\nroughness = '1 um'\nwear = 1e-7\n[bearing]", "contact.hardness", "is missing"),
        (
            "[bearing]", f"{ASPERITIES}\nroughness = '1 um'\njournal_roughness = '1 um'\n[bearing]",
            "contact.journal_roughness", "on flow factors only",
        ),
        (
            "[bearing]", f"{ASPERITIES}\nroughness = '1 um'\nflow_factors = true\njournal_roughness = 2e-6\n[bearing]",
            "contact.journal_roughness", "more than roughness",
        ),
        ("[bearing]", f"{ASPERITIES}\nroughness = '9 um'\n[bearing]", "contact.roughness", "summits are flat"),
        ("[bearing]", f"{ASPERITIES}\nroughness = '3 um'\n[bearing]", "contact.summit_density", "1.78 times the area"),
        ("[bearing]", f"{ASPERITIES}\nroughness = '1 um'\nfriction = 1.1\n[bearing]", "contact.friction", "at most 1"),
        ("[bearing]", "[start]\ndisplacement = [0.8, 0.8]\n[bearing]", "start.displacement", "outside"),
        ("[bearing]", "[start]\ndisplacement = [0, 0]\nposition = 'centre'\n[bearing]", "start.position", "beside"),
        ("[bearing]", "[accuracy]\ntarget = 0.2\n[bearing]", "accuracy.target", "at most"),
        ("[bearing]", "[accuracy]\nsteps_per_revolution = true\n[bearing]", "accuracy.steps_per_revolution", "whole"),
        ("[bearing]", "[output]\nstep = 1e-9\n[bearing]", "output.step", "samples"),
        ("[bearing]", "[motion]\nload = 1\neccentricity = 0.1\n[bearing]", "motion.load", "beside"),
        ("[bearing]", "[[shaft]]\nlength = 1\ndiameter = 1\n[bearing]", "shaft", "does not go with"),
        ("[bearing]", "[film]\ncavitation = 3\n[bearing]", "film.cavitation", "not known"),
        ("[rotor]", "rotor = 3\n[x]", "rotor", "not a table"),
        ("[rotor]", "title = 3\n[rotor]", "title", "not text"),
        ("[rotor]", 'title = "a\\u0000b"\n[rotor]', "title", "printable"),
        ("[rotor]", "source_text = ''\n[rotor]", "source_text", "not known"),
        ("[rotor]", "bearings = []\n[rotor]", "bearings", "not known"),
        ('to = "300 Hz"', 'to = "-1 Hz"', "speed.to", "at least"),
        ('duration = "10 s"', 'duration = "0 s"', "speed.duration", "greater than"),
        ('duration = "10 s"', "duration = 2000-01-01", "speed.duration", "not a quantity"),
    ],
)
def test_single_faults(old: str, new: str, key: str, problem: str) -> None:
    assert old in SMALL
    faults = faults_of(SMALL.replace(old, new, 1))
    assert problem in faults[key].problem


def test_film_of_an_oil_with_a_law_has_a_temperature_or_a_viscosity() -> None:
    faults = faults_of(TURBOCHARGER, "bearing.0.inner.viscosity=12 mPa*s")
    assert set(faults) == {"bearing.0.inner.temperature"}
    assert faults["bearing.0.inner.temperature"].value == '"95 degC"'
    assert "viscosity of its own" in faults["bearing.0.inner.temperature"].problem


@pytest.mark.parametrize(
    ("setting", "key", "problem"),
    [
        ("bearing.1.position=5 m", "bearing.1.position", "not on the shaft"),
        ("disk.0.position=-1 mm", "disk.0.position", "not on the shaft"),
        ("shaft=[]", "shaft", "missing"),
        ("bearing.1.name=compressor", "bearing.1.name", "another bearing"),
        ("bearing.1.name=a b", "bearing.1.name", "valid name"),
        ("bearing.0.outer.diameter=20 mm", "bearing.0.inner.diameter", "not below"),
        ("bearing.0.inner.clearance.cold=1 kg", "bearing.0.inner.clearance.cold", "cannot be turned into m"),
        ("bearing.1.supply.width=30 mm", "bearing.1.supply.width", "wider than the bearing"),
        ("bearing.0.inner.supply.count=2.5", "bearing.0.inner.supply.count", "whole number"),
    ],
)
def test_faults_of_a_turbocharger(setting: str, key: str, problem: str) -> None:
    assert problem in faults_of(TURBOCHARGER, setting)[key].problem


def test_shaft_that_grows_through_its_clearance() -> None:
    clearance = "bearing.0.inner.clearance"
    faults = faults_of(TURBOCHARGER, f"{clearance}.cold=8 um", f"{clearance}.shell_temperature=20 degC")
    assert "-3.06" in faults[clearance].problem  # 8 um less 12.5 mm * 1.18e-5 1/K * 75 K


@pytest.mark.parametrize(
    ("text", "line"),
    [("a =", 1), ("a = 1\na = 2\n", 2), ("[x\n", 1), ("x = " + "[" * 5000, None), ("a = 1" + "0" * 5000, None)],
)
def test_what_is_no_toml(text: str, line: int | None) -> None:
    assert faults_of(text)["text"].line == line


def test_only_keys_have_too_many_dots() -> None:
    dotted = f'title = "{"." * 150}"   # {"." * 150}'
    assert load_case_text(f"{dotted}\n{SMALL}").title == "." * 150
    with pytest.raises(InputError, match="too many dots"):
        load_case_text(f"{'a.' * 40}b = 1\n{SMALL}")


def test_of_very_many_faults_the_first_are_told() -> None:
    with pytest.raises(InputError) as caught:
        load_case_text(SMALL + "\n".join(f"b{i} = 1" for i in range(5000)))
    assert len(caught.value.faults) == 5000
    assert str(caught.value).endswith("and 4900 more")
    assert len(str(caught.value)) < 20_000


def test_files_that_cannot_be_cases(tmp_path: Path) -> None:
    binary, utf16, huge = tmp_path / "binary", tmp_path / "utf16.toml", tmp_path / "huge.toml"
    binary.write_bytes(bytes(range(256)))
    utf16.write_text(SMALL, encoding="utf-16")
    huge.write_text("# long\n" * 100_000)
    for source in (binary, utf16, huge, tmp_path, tmp_path / "missing.toml", "x\0y", "a" * 5000):
        with pytest.raises(InputError) as caught:
            load_case(source)
        assert caught.value.faults[0].key == "CASE"
        assert caught.value.exit_code == 2


def test_missing_file_suggests_the_nearest_shipped_case() -> None:
    with pytest.raises(InputError, match='Did you mean the shipped case "jeffcott"'):
        load_case("jefcott.toml")


def test_file_with_byte_order_mark_and_carriage_returns(tmp_path: Path) -> None:
    file = tmp_path / "from windows.toml"
    file.write_bytes(b"\xef\xbb\xbf" + SMALL.replace("\n", "\r\n").encode())
    assert load_case(file).name == "from windows"


def test_lines_of_keys() -> None:
    text = '''# comment [not.a.table]
a = """
b = 1
"""
"quoted key" = 'x = 1'
[t.u]   # comment
v.w = [ 1,
  { deep = 2,  other = "]" } ]
[[many]]
k = 1
[[many]]
k = "\\" # no comment"
[many.inner]
z = 3
'''
    lines = key_lines(text)
    expected: dict[tuple[str | int, ...], int] = {
        ("a",): 2,
        ("quoted key",): 5,
        ("t", "u"): 6,
        ("t", "u", "v", "w"): 7,
        ("t", "u", "v", "w", 1): 8,
        ("t", "u", "v", "w", 1, "other"): 8,
        ("many", 0, "k"): 10,
        ("many", 1, "k"): 12,
        ("many", 1, "inner"): 13,
        ("many", 1, "inner", "z"): 14,
    }
    assert {path: lines.get(path) for path in expected} == expected
    assert ("b",) not in lines


# ---------------------------------------------------------------------------------------------- listing and schema


def test_listing_shows_keys_as_the_file_has_them() -> None:
    listed = {value.key: value for value in values(load_case_text(TURBOCHARGER))}
    assert (listed["speed.to"].value, listed["speed.to"].unit) == (1200.0, "Hz")
    assert listed["bearing.0.inner.clearance.cold"].shown == "38 um"
    assert listed["film.two-phase.steepness"].value == 0.95
    assert not any(key.startswith("film.penalty") for key in listed)  # of a model that the case does not use
    assert "bearing.clearance" in {value.key for value in values(load_case_text(SMALL))}


def test_json_schema_describes_the_file() -> None:
    schema = json_schema()
    assert "required" not in schema  # [oil] where there is a film; [bearing], or [[thrust_bearing]] alone
    assert "source_text" not in schema["properties"]
    width = schema["$defs"]["SingleFilmBearing"]["properties"]["width"]
    assert {branch["type"] for branch in width["anyOf"]} == {"number", "string"}
    assert "in m" in width["anyOf"][0]["description"]
    assert len(schema["properties"]["bearing"]["anyOf"]) == 2
    assert set(schema["$defs"]["SpeedRamp"]["required"]) == {"from", "to", "duration"}


def test_examples_of_the_schema_are_valid() -> None:
    """What remedies tell people to write must itself be right."""
    import re

    from frbcli.case import quantities

    kinds = [getattr(quantities, name).__metadata__[0] for name in dir(quantities) if _is_quantity(quantities, name)]
    assert len(kinds) > 20
    for kind in kinds:
        assert math.isfinite(kind.read(kind.example))
        schema = kind.__get_pydantic_json_schema__(None, None)
        assert re.search(schema["anyOf"][1]["pattern"], kind.example)


def _is_quantity(module: object, name: str) -> bool:
    from frbcli.case.quantities import Quantity

    return isinstance(getattr(getattr(module, name), "__metadata__", (None,))[0], Quantity)


def test_case_needs_its_sections() -> None:
    assert set(faults_of("")) == {"rotor", "bearing", "oil", "speed"}
    assert isinstance(load_case_text(SMALL), Case)
