"""The case file: what is read, and what is said about what cannot be read."""

import json
import math
import re

import pytest
from case_texts import SMALL, TURBOCHARGER, faults_of

from frbcli.case.bearing import FloatingRingBearing, SingleFilmBearing
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.reading.shipped import shipped_cases, shipped_names
from frbcli.case.rotor import JeffcottRotor, TurbochargerRotor
from frbcli.case.schema import Case, json_schema
from frbcli.errors import InputError


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
    assert set(cases) - set(films) == {"ball-bearing", "seal", "squeeze-film-damper", "thrust", "turbocharger-ball"}
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


def test_bounds_of_the_schema_are_written_alike() -> None:
    """0 where a row of a law has 0.0, as an editor shows it."""
    written = re.findall(r'"(?:exclusiveM|m)(?:in|ax)imum": ([^,}\s]+)', json.dumps(json_schema()))
    assert len(written) > 200
    assert not [bound for bound in written if bound.endswith(".0")]


def test_examples_of_the_schema_are_valid() -> None:
    """What remedies tell people to write must itself be right."""
    from frbcli.case import model

    kinds = [getattr(model, name).__metadata__[0] for name in dir(model) if _is_quantity(model, name)]
    assert len(kinds) > 20
    for kind in kinds:
        assert math.isfinite(kind.read(kind.example))
        schema = kind.__get_pydantic_json_schema__(None, None)
        assert re.search(schema["anyOf"][1]["pattern"], kind.example)


def _is_quantity(module: object, name: str) -> bool:
    from frbcli.case.model import Quantity

    return isinstance(getattr(getattr(module, name), "__metadata__", (None,))[0], Quantity)


def test_case_needs_its_sections() -> None:
    assert set(faults_of("")) == {"rotor", "bearing", "oil", "speed"}
    assert isinstance(load_case_text(SMALL), Case)


def test_a_table_that_says_that_there_is_no_heat_needs_no_more() -> None:
    case = load_case("jeffcott", ["thermal.model=none"])
    assert case.heat is None
    assert load_case_text(case.source_text, name="again").heat is None
    oil = 'oil.viscosity={grade="ISO VG 32"}'
    warm = case.with_settings("thermal.model=lumped", "thermal.supply_temperature=70 degC", oil)
    assert warm.heat is not None
    with pytest.raises(InputError, match="supply_temperature: is missing"):
        load_case("jeffcott", ["thermal={model='none', mixing=0.6}"])
