"""Words, units and names that engineers bring: understood, or told by what is wrong with them."""

import json
from pathlib import Path

import pytest

from frbcli.case.reading.load import load_case
from frbcli.cli.main import run as frb
from frbcli.errors import InputError
from frbcli.materials import walther

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
        ("oil.viscosity=12 MPa*s", "but must be at most 1000 Pa*s"),
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
def test_a_word_of_an_engineer_is_answered(setting: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert frb(["check", "jeffcott", "--set", setting]) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 2  # the case and one fault: consequences are not listed


def test_a_misspelt_rotor_is_one_fault(capsys: pytest.CaptureFixture[str]) -> None:
    assert frb(["check", "jeffcott", "--set", "rotor.kind=rigidd"]) == 2
    fault = '  rotor.kind = "rigidd": is not known here. Did you mean "rigid"?'
    assert capsys.readouterr().err.splitlines()[1:] == [fault]


def test_a_run_is_an_hdf5_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "run.png"
    assert frb(["runup", "jeffcott", "-o", str(picture), "--set", "speed.duration=0.01 s"]) == 2
    assert "Write -o run.h5." in capsys.readouterr().err
    assert not picture.exists()


def test_a_case_is_no_run_and_a_run_no_case(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert frb(["plot", "jeffcott"]) == 2
    assert "`frb runup CASE -o RUN.h5` makes one of a case" in capsys.readouterr().err
    run = tmp_path / "run.h5"
    settings = ["--set", "speed.duration=0.01 s", "--set", "film.theory=short"]
    assert frb(["runup", "jeffcott", "-o", str(run), "--no-picture", "--quiet", *settings]) == 0
    capsys.readouterr()
    assert frb(["check", str(run)]) == 2
    assert "is a run file: `frb plot`, `frb waterfall` and `frb report` show it" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("case", "settings", "said"),
    [
        ("jeffcott", ["rotor.unbalance=0 g*mm"], "has no unbalance"),
        ("turbocharger-car", ["bearing.1.inner.diameter=9 mm", "bearing.1.outer.diameter=12 mm"], "9 mm, the shaft"),
        ("turbocharger-car", ["bearing.0.name=turbine-side", "bearing.1.name=compressor-side"], "stands nearer to"),
    ],
)
def test_what_contradicts_itself_is_remarked(
    case: str, settings: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [word for setting in settings for word in ("--set", setting)]
    assert frb(["check", case, *words, "--json", "--quiet"]) == 0
    assert any(said in remark for remark in json.loads(capsys.readouterr().out)["remarks"])


def test_shipped_cases_have_nothing_to_remark() -> None:
    from frbcli.scene.machine.findings import remarks

    assert remarks(load_case("turbocharger-car")) == remarks(load_case("floating-ring")) == ()
