"""Wrong cases: every fault by its key, its line and its remedy; analyses that a case cannot have, as rows of
tests/data/wrong-cases.toml."""

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from case_texts import SMALL, TURBOCHARGER, faults_of
from paths import DATA

from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.case.reading.tables import key_lines
from frbcli.errors import Fault, InputError
from frbcli.scene.gate.gate import faults
from frbcli.scene.planning.plan import make_plan

ASPERITIES = "[contact]\nmodel = 'asperities'\nsummit_radius = '20 um'\nsummit_density = '1e10 1/m^2'"


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
        ('clearance = "35 um"', "clearance = 35", "bearing.clearance", "too large for a film"),
        ('clearance = "35 um"', 'clearance = "1e-30 m"', "bearing.clearance", "out of range"),
        ('clearance = "35 um"', 'clearance = "35 um"\ntemperature = 350', "bearing.temperature", "no effect"),
        ('clearance = "35 um"', 'clearance = 35e-6\ntemperature = 350\nviscosity = 0.01', "bearing.temperature", "own"),
        ('kind = "single-film"', "", "bearing.kind", "missing"),
        ("[bearing]", "[contact]\npolicy = 'elastic'\n[bearing]", "contact.stiffness", "missing"),
        ("[bearing]", "[contact]\neccentricity = 1\n[bearing]", "contact.eccentricity", "at most 0.9999"),
        ("[bearing]", "[contact]\nroughness = '1 um'\n[bearing]", "contact.roughness", "on rough surfaces only"),
        ("[bearing]", "[contact]\nmodel = 'asperities'\npolicy = 'stop'\n[bearing]", "contact.policy", "smooth surf"),
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
        ("[bearing]", "[start]\ndisplacement = [0.8, 0.8]\n[bearing]", "start.displacement", "outside"),
        ("[bearing]", "[start]\ndisplacement = [0, 0]\nposition = 'centre'\n[bearing]", "start.position", "given with"),
        ("[bearing]", "[accuracy]\nsteps_per_revolution = true\n[bearing]", "accuracy.steps_per_revolution", "whole"),
        ("[bearing]", "[output]\nstep = 1e-9\n[bearing]", "output.step", "samples"),
        ("[bearing]", "[motion]\nload = 1\neccentricity = 0.1\n[bearing]", "motion.load", "given with"),
        ("[bearing]", "[[shaft]]\nlength = 1\ndiameter = 1\n[bearing]", "shaft", "does not go with"),
        ("[bearing]", "[film]\ncavitation = 3\n[bearing]", "film.cavitation", "not known"),
        ("[rotor]", "rotor = 3\n[x]", "rotor", "not a table"),
        ("[rotor]", "title = 3\n[rotor]", "title", "not text"),
        ("[rotor]", 'title = "a\\u0000b"\n[rotor]', "title", "printable"),
        ("[rotor]", "source_text = ''\n[rotor]", "source_text", "not known"),
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
        ("shaft=[]", "shaft", "missing"),
        ("bearing.1.name=compressor", "bearing.1.name", "another bearing"),
        ("bearing.1.name=a b", "bearing.1.name", "valid name"),
        ("bearing.0.outer.diameter=20 mm", "bearing.0.inner.diameter", "not below"),
        ("bearing.0.inner.clearance.cold=1 kg", "bearing.0.inner.clearance.cold", "cannot be turned into m"),
        ("bearing.1.supply.width=30 mm", "bearing.1.supply.width", "wider than the bearing"),
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


TABLE = tomllib.loads((DATA / "wrong-cases.toml").read_text(encoding="utf-8"))
ROWS = [
    pytest.param(group, row, analysis, id=f"{group['case']}: {row[1]} {analysis or ''}".strip())
    for group in TABLE["group"]
    for analysis in group.get("analysis", (None,))
    for row in group["wrong"]
]


def found(group: dict[str, Any], settings: Sequence[str], analysis: str | None) -> Sequence[Fault]:
    """The faults of a case, when it is read, or those that its plan or an analysis has."""
    given = [*group.get("settings", ()), *settings]
    try:
        base = TABLE["bases"].get(group["case"])
        case = load_case(group["case"], given) if base is None else case_from_dict(base).with_settings(*given)
        if analysis == "plan":
            make_plan(case)
    except InputError as error:
        return error.faults
    return () if analysis in (None, "plan") else faults(case, analysis)


@pytest.mark.parametrize(("group", "row", "analysis"), ROWS)
def test_a_wrong_case_is_refused_by_its_keys_with_a_remedy(
    group: dict[str, Any], row: tuple[list[str], str | list[str], str], analysis: str | None
) -> None:
    settings, keys, words = row
    expected = [keys] if isinstance(keys, str) else keys
    faults_found = found(group, settings, analysis)
    assert sorted(fault.key for fault in faults_found) == sorted(expected)
    assert any(words in f"{fault.problem} {fault.remedy}" for fault in faults_found if fault.key == expected[0])
    assert all(fault.remedy for fault in faults_found)
