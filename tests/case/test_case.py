"""Case files: what is read of them, also rings, supplies, and rotor speeds through points."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_texts import SMALL, TURBOCHARGER, faults_of

import frbcli
from frbcli import make_plan
from frbcli.analysis.measured import Measurement, measured_run
from frbcli.analysis.order_tracking import order_track
from frbcli.case.bearing import FloatingRingBearing, SingleFilmBearing
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.case.reading.shipped import shipped_cases, shipped_names
from frbcli.case.rotor import JeffcottRotor, TurbochargerRotor
from frbcli.case.schema import Case, json_schema
from frbcli.case.supplies import SUPPLIES, OilSupply, kind_of
from frbcli.errors import InputError
from frbcli.film.gap import Hole
from frbcli.runs.run import rundown, runup
from frbcli.scene.course import default_speeds
from frbcli.scene.films import film_places, film_section, is_plain
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.studies.accuracy import accuracy
from frbcli.studies.warm_up import moment_of_run


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


BRASS = 8860.0  # kg/m^3


def without(*keys: str) -> Case:
    case = load_case("floating-ring")
    return case.with_settings({f"bearing.ring.{key}": None for key in keys}, {"bearing.ring.material": "brass"})


def ring_of(case: Case) -> FloatingRingBearing:
    (bearing,) = case.bearings
    assert isinstance(bearing, FloatingRingBearing)
    return bearing


def test_a_hollow_cylinder_has_its_mass_and_inertia() -> None:
    """By the sum over thin shells of mass 2 pi rho B r dr, and r^2 times it."""
    bearing = ring_of(without("mass", "inertia"))
    inner, outer, width = 0.5 * bearing.inner.diameter, 0.5 * bearing.outer.diameter, bearing.inner.width
    edges = np.linspace(inner, outer, 20_001)
    middle = 0.5 * (edges[1:] + edges[:-1])
    shells = 2.0 * math.pi * BRASS * width * middle * np.diff(edges)
    assert bearing.ring_mass == pytest.approx(shells.sum(), rel=1e-9)
    assert bearing.ring_inertia == pytest.approx((shells * middle**2).sum(), rel=1e-8)
    wide = ring_of(without("mass", "inertia").with_settings({"bearing.ring.width": 2.0 * width}))
    assert wide.ring_mass == pytest.approx(2.0 * bearing.ring_mass)


def test_what_is_given_is_kept_and_what_follows_is_said() -> None:
    given = ring_of(load_case("floating-ring"))
    assert (given.ring_mass, given.ring_inertia) == (given.ring.given_mass, given.ring.given_inertia)
    half = without("inertia")
    bearing = ring_of(half)
    squares = bearing.inner.diameter**2 + bearing.outer.diameter**2
    assert bearing.ring_inertia == pytest.approx(given.ring_mass * squares / 8.0)
    (said,) = (one for one in make_plan(half).decisions if one.choice == "ring")
    assert said.value == f"inertia {1e6 * bearing.ring_inertia:.4g} kg*mm^2"
    (said,) = (one for one in make_plan(without("mass", "inertia")).decisions if one.choice == "ring")
    assert said.value.startswith("mass ")
    assert "a cylinder of brass" in said.reason
    assert [one for one in make_plan(load_case("floating-ring")).decisions if one.choice == "ring"] == []


def test_the_machine_has_the_mass_of_the_ring() -> None:
    case = without("mass")
    heavier = np.trace(make_rotor(case).mass) - np.trace(make_rotor(load_case("floating-ring")).mass)
    more = ring_of(case).ring_mass - ring_of(load_case("floating-ring")).ring_mass
    assert heavier == pytest.approx(4.0 * more, rel=1e-9)  # two rings, each in x and y


def test_a_ring_needs_a_mass_or_a_material() -> None:
    with pytest.raises(InputError, match=r'bearing.ring.mass: is missing. Add e.g. mass = "30 g", or material'):
        load_case("floating-ring").with_settings({"bearing.ring.mass": None})
    with pytest.raises(InputError, match=r'bearing.ring.width = "10 mm": has no effect'):
        load_case("floating-ring").with_settings({"bearing.ring.width": "10 mm"})


AMBIENT = 1e5
each_supply = pytest.mark.parametrize("row", SUPPLIES, ids=kind_of)


def film_of(row: type[OilSupply]) -> tuple[frbcli.Case, SingleFilmBearing]:
    """A bearing with this supply at 3.5 bar, and its case."""
    entry = json_schema()["$defs"][row.__name__]
    given = {key: _example(entry["properties"][key]) for key in entry.get("required", ()) if key != "kind"}
    given = {"kind": kind_of(row), **given, **({"pressure": "3.5 bar"} if row.feeds else {})}
    table = ", ".join(f"{key} = {value if isinstance(value, int) else repr(value)}" for key, value in given.items())
    case = load_case("jeffcott", ["bearing.diameter=60 mm", f"bearing.supply={{ {table} }}"])  # with room for all
    (film,) = (place.geometry for place in film_places(case))
    assert isinstance(film, SingleFilmBearing)
    return case, film


def _example(entry: dict[str, Any]) -> object:
    return entry["examples"][0] if "examples" in entry else entry["anyOf"][1]["examples"][0]


@each_supply
def test_all_openings_have_the_gauge_pressure_of_the_supply(row: type[OilSupply]) -> None:
    case, film = film_of(row)
    section = film_section(case, film)
    pressures = [*(groove.pressure for groove in section.grooves), *(hole.pressure for hole in section.holes)]
    if section.far == "groove":
        pressures.append(section.far_pressure)
    assert len(pressures) == (len(film.supply.outlines(section.radius, film.width)) if row.feeds else 0)
    assert set(pressures) <= {film.supply.gauge(AMBIENT)}
    assert film.supply.gauge(AMBIENT) == (2.5e5 if row.feeds else 0.0)
    assert film.supply.absolute(AMBIENT) == (3.5e5 if row.feeds else AMBIENT)


@each_supply
def test_what_a_supply_says_of_the_gap_is_what_its_section_has(row: type[OilSupply]) -> None:
    case, film = film_of(row)
    section = film_section(case, film)
    assert is_plain(film) is not bool(section.grooves or section.holes)
    assert film.supply.divides is bool(section.grooves)
    assert film.supply.rectangular is not bool(section.holes)
    assert film.supply.splits is (section.far == "groove" and section.copies == 2)


@pytest.mark.parametrize(("places", "copies"), [((10e-3,), 2), ((6e-3,), 1), ((6e-3, 14e-3), 1)])
def test_half_of_the_width_is_solved_where_all_openings_lie_in_its_middle(
    places: tuple[float, ...], copies: int
) -> None:
    class Rows(OilSupply):
        kind: str = "rows"

        def outlines(self, radius: float, width: float) -> tuple[Hole, ...]:
            return tuple(Hole(0.0, axial, 1e-3 / radius, 0.05 * width) for axial in places)

    found = Rows().openings(12.5e-3, 20e-3, "free-to-air", AMBIENT)
    assert (found.copies, found.far) == (copies, "symmetry" if copies == 2 else "free-to-air")
    assert tuple(hole.axial for hole in found.holes) == places


MACHINE = {
    "rotor": {"kind": "rigid", "mass": "6 kg", "gravity": 0.0, "unbalance": "3 g*mm"},
    "bearing": {"kind": "coefficients", "stiffness": "1e6 N/m", "damping": "300 N*s/m"},
}
POINTS = [["0 s", "0 Hz"], ["0.1 s", "1800 rpm"], ["0.2 s", "30 Hz"], ["300 ms", "10 Hz"]]


def machine(folder: Path | str = ".", **speed: object) -> frbcli.Case:
    return case_from_dict(MACHINE | {"speed": speed}, "points", folder=folder)


def test_the_speed_goes_through_its_points() -> None:
    """Range and duration follow; the angle is the area under the lines."""
    case = machine(points=POINTS)
    assert (case.speed.start, case.speed.end, case.speed.duration) == (0.0, 30.0, 0.3)
    profile = run_up_profile(case)
    between = profile.speed(np.array([0.05, 0.15, 0.25])) / (2.0 * math.pi)
    np.testing.assert_allclose(between, [15.0, 30.0, 20.0])
    assert profile.angles[-1] == pytest.approx(2.0 * math.pi * (1.5 + 3.0 + 2.0), rel=1e-12)
    assert load_case_text(case.source_text, name="points") == case
    assert not [value.key for value in values(case) if value.bare and value.key.startswith("speed")]
    assert case.with_settings("rotor.unbalance=1 g*mm").speed == case.speed
    assert default_speeds(case)[-1] == 30.0
    moment = moment_of_run(case)
    assert moment.speed.times == ()
    assert moment.speed.start == moment.speed.end == 30.0


def test_a_ramp_as_two_points_is_the_ramp(tmp_path: Path) -> None:
    ramp = runup(machine(**{"from": "5 Hz", "to": "25 Hz", "duration": "0.2 s"}), tmp_path / "ramp.h5")
    points = runup(machine(points=[["0 s", "5 Hz"], ["0.2 s", "25 Hz"]]), tmp_path / "points.h5")
    for name in ramp.signals:
        np.testing.assert_array_equal(points[name], ramp[name], strict=True)


def test_orders_of_a_run_lie_on_those_of_the_measurement_with_the_tacho(tmp_path: Path) -> None:
    """A machine that speeds up, slows down and speeds up again, measured with four pulses in a revolution: the computed
    synchronous motion follows the same speeds, and its line in spectra is the measured one."""
    time = np.arange(0.0, 2.0, 1e-4)
    speed = 40.0 + 2.0 * np.sin(3.0 * time) + time
    angle = 2.0 * math.pi * np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * 1e-4)])
    tacho = (np.sin(4.0 * angle) > 0.9).astype(float)
    columns = np.column_stack([time, 1e-5 * np.cos(angle), 1e-5 * np.sin(angle), tacho])
    np.savetxt(tmp_path / "measured.csv", columns, delimiter=",", header="t,x,y,tacho", comments="", fmt="%.9g")
    case = machine(tmp_path, file="measured.csv", tacho="tacho", pulses=4)
    assert len(case.speed.times) < 2.2 * angle[-1] / (2.0 * math.pi)  # a point for each revolution
    run = runup(case, tmp_path / "run.h5")
    assert run.t_end_s == pytest.approx(time[-1])
    inside = (run["time_s"] > 0.2) & (run["time_s"] < 1.8)
    there = np.interp(run["time_s"][inside], time, speed)
    # The speed of a tacho is the mean over T = 8 revolutions, 0.2 s: it is off by T^2 / 24 of the second derivative,
    # 0.03 Hz, and by a sample of 0.1 ms in T, 0.02 Hz.
    np.testing.assert_allclose(run["speed_Hz"][inside], there, rtol=0.0, atol=0.05)
    given = Measurement("x", clearance=35e-6, y="y", time="t", tacho="tacho", pulses=4, unit_m=1.0)
    measured = measured_run(tmp_path / "measured.csv", given)
    mine, other = (order_track(each, 1.0, "journal") for each in (run, measured))
    both = np.interp(mine.time_s, other.time_s, other.speed_Hz)
    within = (mine.time_s > 0.3) & (mine.time_s < 1.7)
    # Both begin and end of T are known to a sample: by 0.04 Hz the speed jitters from pulse to pulse.
    np.testing.assert_allclose(mine.speed_Hz[within], both[within], rtol=0.0, atol=0.05)


def test_a_file_of_speeds_has_units(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "speed.csv", [[0.0, 0.0], [100.0, 1800.0], [300.0, 600.0]], delimiter=",",
               header="time [ms],speed [rpm]", comments="")  # fmt: skip
    case = machine(tmp_path, file="speed.csv")
    np.testing.assert_allclose(case.speed.times, (0.0, 0.1, 0.3))
    np.testing.assert_allclose(case.speed.speeds, (0.0, 30.0, 10.0))


def test_what_needs_a_ramp_refuses_points(tmp_path: Path) -> None:
    case = machine(points=POINTS)
    with pytest.raises(InputError, match="how the speed goes down"):
        rundown(case, tmp_path / "run.h5")
    film = frbcli.load_case("jeffcott").with_settings({"speed": {"points": POINTS}})
    with pytest.raises(InputError, match="are no ramp"):
        accuracy(film, until=0.2)
