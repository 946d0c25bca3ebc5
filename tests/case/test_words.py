"""What engineers bring: words, units and names, understood or told by what is wrong with them; slips of a unit, refused
or confirmed."""

import json
import math
from pathlib import Path

import pytest
from commands import Frb

from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.reading.shipped import hard_cases, shipped_names
from frbcli.errors import Fault, InputError
from frbcli.materials import walther
from frbcli.runs.run import run_cost
from frbcli.scene.machine.findings import operating_points

TWO = '{ points = [["40 degC", "46 cSt"], ["100 degC", "6.8 cSt"]] }'


@pytest.mark.parametrize("text", ["12 cSt", "0.12 St", "12 mm^2/s", "1.2e-5 m^2/s", "12 mm²/s"])
def test_a_kinematic_viscosity_is_taken_with_the_density(text: str) -> None:
    case = load_case("jeffcott", [f"oil.viscosity={text}", "oil.density=850 kg/m^3"])
    assert case.oil.viscosity == pytest.approx(12e-6 * 850.0)


def test_a_kinematic_viscosity_without_a_density_is_refused() -> None:
    with pytest.raises(InputError, match="is a kinematic viscosity, which needs the density"):
        load_case("jeffcott", ['oil={ viscosity = "12 cSt" }'])
    with pytest.raises(InputError, match=r"oil\.density: is missing; a kinematic viscosity needs it"):
        load_case("jeffcott", [f'oil={{ viscosity = {TWO}, temperature = "80 degC" }}'])


def test_two_points_of_a_data_sheet_follow_walther() -> None:
    """At both temperatures what the sheet has, between them Vogel's law stays within .5 % of ASTM D341."""
    for celsius, within in ((40.0, 1e-9), (100.0, 1e-9), (60.0, 5e-3), (80.0, 5e-3), (150.0, 1e-9)):
        settings = [f"oil.viscosity={TWO}", f"oil.temperature={celsius} degC", "oil.density=850 kg/m^3"]
        case = load_case("jeffcott", settings)
        kinematic = 1e-6 * walther(celsius + 273.15, (313.15, 46.0), (373.15, 6.8))
        assert case.oil.viscosity == pytest.approx(850.0 * kinematic, rel=within)


@pytest.mark.parametrize("written", ["VG46", "iso vg 46", "ISO-VG-46", "{ grade = 'VG46' }"])
def test_a_grade_is_known_by_its_spellings(written: str) -> None:
    grades = [load_case("jeffcott", [f"oil.viscosity={name}", "oil.temperature=60 degC"])
              for name in (written, '{ grade = "ISO VG 46" }')]  # fmt: skip
    assert grades[0].oil == grades[1].oil


@pytest.mark.parametrize("grade", ["ISO VG 22", "SAE 15W-40"])
def test_a_grade_without_data_leads_to_its_data_sheet(grade: str) -> None:
    with pytest.raises(InputError, match="For another oil give density and"):
        load_case("jeffcott", [f"oil.viscosity={grade}", "oil.temperature=60 degC"])


def test_a_multigrade_needs_no_sae() -> None:
    grades = [load_case("jeffcott", [f"oil.viscosity={name}", "oil.temperature=90 degC"])
              for name in ("0W20", "0W-20", "SAE 0W-20")]  # fmt: skip
    assert grades[0].oil == grades[1].oil == grades[2].oil


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("bearing.diametral_clearance=70 um", "write clearance, half of the diametral one: 35 um."),
        ("bearing.radial_clearance=35 um", "Clearances are radial: write clearance."),
        ("bearing.length=20 mm", "Write width."),
        ("bearing.radius=12.5 mm", "Write diameter: 25 mm."),
        ("bearing.kind=plain", 'Write kind = "single-film".'),
        ("bearing.kind=deep-groove", 'Write kind = "ball".'),
        ("film.cavitation=JFO", 'Write "elrod"'),
        ("film.cavitation=Gumbel", 'Write "half-sommerfeld"'),
        ("film.cavitation=Guembel", 'Write "half-sommerfeld"'),
        ("film.cavitation=mass conserving", 'Write "elrod"'),
        ("film.theory=Ocvirk", 'Write "short"'),
        ("film.theory=infinite", 'The width counts always: write "finite"'),
        ("rotor.kind=de Laval", 'Write kind = "jeffcott"'),
        ("rotor.kind=flexible", 'Write kind = "turbocharger"'),
        ("bearing.kind=SFD", "Write [bearing.damper]"),
        ("bearing.ends=flooded", 'Write "oil-bath"'),
        ("bearing.play=70 um", "Write clearance, half of a diametral play: 35 um."),
        ("bearing.D=25 mm", "Write diameter."),
        ("bearing.durchmesser=25 mm", "Write diameter."),
        ("bearing.Lagerspiel=70 um", "Write clearance, half of a diametral play: 35 um."),
        ("bearing.Cr=35 um", "Clearances are radial: write clearance."),
        ("bearing.preload=0.5", "Write preload in lobes."),
        ("oil.nu=12 cSt", 'Write viscosity = "12 cSt", and density.'),
        ("oil.viscosity=12 MPa*s", "but must be at most 10 Pa*s"),
        ("oil.viscosity=12", "but must be at most 10 Pa*s"),
        ("bearing.psi=0.002", "Write clearance, this times the radius."),
        ("bearing.cd=70 um", "half of the diametral one: 35 um."),
        ("bearing.supply.kind=hole", 'Write kind = "bores".'),
        ("oil.cp=2 kJ/(kg*K)", "Write heat_capacity."),
        ("rotor.e=1 um", "Write unbalance"),
        ("rotor.mass=6 ton", 'Write "t" for 1000 kg.'),
        ("rotor.unbalance=10 gr*mm", '"gr" is a grain to some and a gram to others. Write "g".'),
        ("bearing.supply.pressure=3 barü", 'Write "4.01 bar"'),
        ("oil.eta=0.012", 'Write viscosity = "12 mPa*s"'),
        ("rotor.zeta=0.01", "Write shaft_damping, 2 zeta times"),
        ("gravity=0", "Write gravity in [rotor]."),
        ("output.fs=10 kHz", "Write step, the inverse of the rate."),
        ("speed.max=9000 rpm", "Write to."),
        ("rotor.eccentricity=1 um", "Write unbalance"),
        ("oil.grade=VG 32", 'Write viscosity = "ISO VG 32"'),
        ("oil.viscosity=VG 46", "temperature"),
        ("oil.type=VG 46", "There are: viscosity"),  # an oil has no kind
        ("bearing.eccentricity=0.5", "Known are: shaft"),
        ("bearing.clearance=0,035 mm", 'has a decimal comma. Write "0.035 mm".'),
        ("bearing.supply.pressure=3 barg", 'is a gauge pressure; pressures are absolute here. Write "4.01 bar"'),
        ("bearing.kind=semi-floating", '"floating-ring" with [bearing.pin]'),
        ("bearing.kind=tilting-pad", 'kind = "coefficients" takes its stiffness and damping'),
        ("speed.to=150.000rpm", "can be 150 rpm or 150000 rpm"),
        ("speed.to=18.000 rpm", "can be 18 rpm or 18000 rpm"),
    ],
)
def test_a_word_of_an_engineer_is_answered(setting: str, said: str, frb: Frb) -> None:
    told = frb("check", "jeffcott", "--set", setting, code=2).err
    assert said in told
    assert told.count("\n") == 2  # the case and one fault: consequences are not listed


def test_a_misspelt_rotor_is_one_fault(frb: Frb) -> None:
    said = frb("check", "jeffcott", "--set", "rotor.kind=rigidd", code=2)
    fault = '  rotor.kind = "rigidd": is not known here. Did you mean "rigid"?'
    assert said.err.splitlines()[1:] == [fault]


def test_a_run_is_an_hdf5_file(tmp_path: Path, frb: Frb) -> None:
    picture = tmp_path / "run.png"
    said = frb("runup", "jeffcott", "-o", str(picture), "--set", "speed.duration=0.01 s", code=2)
    assert "Write -o run.h5." in said.err
    assert not picture.exists()


def test_a_case_is_no_run_and_a_run_no_case(tmp_path: Path, frb: Frb) -> None:
    assert "`frb runup CASE -o RUN.h5` makes one of a case" in frb("plot", "jeffcott", code=2).err
    run = tmp_path / "run.h5"
    settings = ["--set", "speed.duration=0.01 s", "--set", "film.theory=short"]
    frb("runup", "jeffcott", "-o", str(run), "--no-picture", "--quiet", *settings)
    assert "is a run file: `frb plot`, `frb waterfall` and `frb report` show it" in frb("check", str(run), code=2).err


@pytest.mark.parametrize(
    ("case", "settings", "said"),
    [
        ("jeffcott", ["rotor.unbalance=0 g*mm"], "has no unbalance"),
        ("turbocharger-car", ["bearing.1.inner.diameter=9 mm", "bearing.1.outer.diameter=12 mm"], "9 mm, the shaft"),
        ("turbocharger-car", ["bearing.0.name=turbine-side", "bearing.1.name=compressor-side"], "stands nearer to"),
    ],
)
def test_what_contradicts_itself_is_remarked(case: str, settings: list[str], said: str, frb: Frb) -> None:
    words = [word for setting in settings for word in ("--set", setting)]
    assert any(said in remark for remark in frb("check", case, *words, "--json", "--quiet").document["remarks"])


def test_shipped_cases_have_nothing_to_remark() -> None:
    from frbcli.scene.machine.findings import remarks

    assert remarks(load_case("turbocharger-car")) == remarks(load_case("floating-ring")) == ()


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


def test_check_tells_which_numbers_had_no_unit(frb: Frb) -> None:
    words = ["check", "turbocharger-car", "--set", "disk.1.mass=0.025", "--set", "speed.to=300", "--json"]
    words += ["--set", "bearing.0.inner.clearance=15e-6", "--set", "rotor.modal_damping=0.001"]
    out, err = frb(*words)
    assert json.loads(out)["bare_numbers"] == [
        {"key": "disk.1.mass", "value": 0.025, "unit": "kg"},
        {"key": "bearing.0.inner.clearance", "value": 1.5e-05, "unit": "m"},
        {"key": "speed.to", "value": 300.0, "unit": "Hz"},
    ]
    assert "Note" not in out + err
    out, err = frb(*words[:6] + words[7:])
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
