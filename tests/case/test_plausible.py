"""A slip of a unit: what is absurd for a rotor is refused or confirmed, and a number without a unit is told."""

import json
import math

import pytest

from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.reading.shipped import hard_cases, shipped_names
from frbcli.cli.main import run as frb
from frbcli.errors import Fault, InputError
from frbcli.runs.run import run_cost
from frbcli.scene.machine.findings import operating_points


def faults_of(name: str, *settings: str) -> dict[str, Fault]:
    """The faults of a shipped case with settings, by their keys."""
    with pytest.raises(InputError) as caught:
        load_case(name, settings)
    return {fault.key: fault for fault in caught.value.faults}


# --- what is absurd ---


@pytest.mark.parametrize(
    ("name", "settings", "keys"),
    [
        ("jeffcott", ["speed.to=180000"], ["bearing.clearance", "speed.to"]),  # the issue's: meant was 180 krpm
        ("jeffcott", ["speed.from=-18 kHz"], ["bearing.clearance", "speed.from"]),
        ("jeffcott", ["bearing.clearance=0.9 um"], ["bearing.clearance"]),
        ("jeffcott", ["bearing.clearance=1 um"], []),
        ("jeffcott", ["bearing.clearance=1.26 mm"], ["bearing.clearance"]),  # a tenth of the radius is 1.25 mm
        ("jeffcott", ["bearing.clearance_steps=[{time='1 s', clearance='35 nm'}]"],
         ["bearing.clearance_steps.0.clearance"]),
        ("jeffcott", ["bearing.diameter=25"], ["bearing.clearance", "speed.to"]),  # mm were meant
        ("turbocharger-car", ["bearing.1.outer.clearance=0.035 um"], ["bearing.1.outer.clearance"]),
        ("bearing", ["motion.speed=1e6 Hz"], ["bearing.clearance", "motion.speed"]),
    ],
)  # fmt: skip
def test_what_no_rotor_has_is_refused_and_can_be_confirmed(name: str, settings: list[str], keys: list[str]) -> None:
    if not keys:
        assert load_case(name, settings)
        return
    faults = faults_of(name, *settings)
    if name != "turbocharger-car":
        assert sorted(faults) == keys
    assert set(keys) <= set(faults)
    named = {word for fault in faults.values() for word in ("surface-speed", "gap-growth", "clearance")
             if f'"{word}"' in fault.remedy.partition("confirm = ")[2]}  # fmt: skip
    case = load_case(name, [*settings, f"confirm={sorted(named)}"])
    assert sorted(case.confirm) == sorted(named)
    assert load_case_text(case.source_text) == case


def test_all_that_has_to_be_confirmed_is_told_at_once() -> None:
    faults = faults_of("jeffcott", "speed.to=180000", "bearing.clearance=1e-9")
    assert 'confirm = ["clearance", "gap-growth"]' in faults["bearing.clearance"].remedy
    assert "0.001 um, below 1 um" in faults["bearing.clearance"].problem
    assert "A number without a unit is in Hz." in faults["speed.to"].remedy
    assert "1.414e+04 m/s, above 500 m/s" in faults["speed.to"].problem
    assert "without a unit" not in faults_of("jeffcott", "speed.to=180 kHz")["speed.to"].remedy


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("jeffcott", ()),
        ("jeffcott", ("bearing.clearance={cold='35 um', shell_temperature='80 degC', journal_temperature='100 degC', "
                      "shell_expansion='1.2e-5 1/K', journal_expansion='1.2e-5 1/K'}",)),
        ("turbocharger-car", ()),
        ("turbocharger-car", ("bearing.1.inner.clearance=8 um",)),
    ],
)  # fmt: skip
def test_the_limit_of_growth_is_half_of_what_check_shows(name: str, settings: tuple[str, ...]) -> None:
    """Growth goes with the square of the speed, and the clearance that it is compared with is the warm one."""
    case = load_case(name, settings)
    worst = max(abs(film.turning) / film.clearance for film in operating_points(case))
    limit = case.speed.end * math.sqrt(0.5 / worst)
    load_case(name, [*settings, f"speed.to={0.999 * limit!r} Hz"])
    faults = faults_of(name, *settings, f"speed.to={1.001 * limit!r} Hz")
    assert all("0% by centrifugal growth" in fault.problem for fault in faults.values())


def test_a_confirmation_is_one_of_a_list() -> None:
    faults = faults_of("jeffcott", "confirm=['surface']")
    assert faults["confirm.0"].remedy == 'Did you mean "surface-speed"?'
    no_list = faults_of("jeffcott", "confirm=clearance", "bearing.clearance=0.9 um")
    assert sorted(no_list) == ["bearing.clearance", "confirm"]
    assert load_case("jeffcott", ["confirm=['clearance']"]).confirm == ("clearance",)


@pytest.mark.parametrize("setting", ["speed.to=1e300", "bearing.diameter=1e300", "bearing.clearance=1e-300",
                                     "bearing.clearance=-35 um", "bearing.diameter=-1e200"])  # fmt: skip
def test_what_no_machine_has_is_no_matter_of_confirmation(setting: str) -> None:
    key = setting.partition("=")[0]
    faults = faults_of("jeffcott", setting, "confirm=['clearance', 'gap-growth', 'surface-speed']")
    assert "confirm" not in faults[key].remedy


def test_no_shipped_or_hard_case_needs_a_confirmation() -> None:
    for name in shipped_names():
        assert load_case(name).confirm == ()
    for hard in hard_cases():
        if hard.end != "input-error":
            assert hard.case().confirm == hard.case(fine=True).confirm == ()


# --- numbers without a unit ---


def test_check_tells_which_numbers_had_no_unit(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["check", "turbocharger-car", "--set", "disk.1.mass=0.025", "--set", "speed.to=300", "--json"]
    words += ["--set", "bearing.0.inner.clearance=15e-6", "--set", "rotor.modal_damping=0.001"]
    assert frb(words) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["bare_numbers"] == [
        {"key": "disk.1.mass", "value": 0.025, "unit": "kg"},
        {"key": "bearing.0.inner.clearance", "value": 1.5e-05, "unit": "m"},
        {"key": "speed.to", "value": 300.0, "unit": "Hz"},
    ]
    assert "Note" not in out + err
    assert frb(words[:6] + words[7:]) == 0
    out, err = capsys.readouterr()
    assert "Note: speed.to = 300: no unit, read as Hz." in out + err
    assert "Note: disk.1.mass = 0.025: no unit, read as kg." in out + err
    assert "damping = 0.001: no unit" not in out + err  # it has none


@pytest.mark.parametrize("name", shipped_names())
def test_every_number_of_a_shipped_case_is_listed_with_its_unit(name: str) -> None:
    plain = {"poisson_ratio", "modal_damping", "axial_position", "eccentricity", "periods", "target", "bunsen",
             "preload", "entrained", "steepness", "whirl_steepness", "offset", "tolerance", "shear_factor", "mixing",
             "nusselt", "order", "inner_curvature", "outer_curvature", "0", "1"}  # fmt: skip
    for value in values(load_case(name)):
        assert not value.bare
        ratio = value.key.startswith("housing.modes.") and value.key.endswith(".damping")
        over_time = value.key.split(".")[-2:-1] in (["time"], ["x"], ["y"])  # all in SI
        if isinstance(value.value, float) and value.key.rpartition(".")[2] not in plain and not ratio and not over_time:
            assert value.unit
            assert value.shown


def test_no_hard_case_has_a_number_without_a_unit() -> None:
    for hard in hard_cases():
        if hard.end != "input-error":
            assert [value.key for value in values(hard.case()) if value.bare] == []


# --- what no machine can be ---


@pytest.mark.parametrize(
    ("name", "setting", "key", "problem"),
    [
        ("floating-ring", "bearing.ring.inertia=0", "bearing.ring.inertia", "greater than 0"),
        ("jeffcott", "bearing.width=2e10 m", "bearing.width", "must be at most 1000 m"),
        ("axial-groove-two-phase", "bearing.supply.count=24", "bearing.supply.opening_angle", "leaves no land"),
    ],
)
def test_what_leaves_nothing_to_compute_is_refused(name: str, setting: str, key: str, problem: str) -> None:
    with pytest.raises(InputError, match=problem) as caught:
        run_cost("runup", load_case(name, [setting]))
    assert caught.value.faults[0].key == key
