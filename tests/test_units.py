"""Text with a unit -> SI, and back. The remedy for a name that is not known."""

import math
import subprocess
import sys
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frbcli import units
from frbcli.case.model import Quantity
from frbcli.errors import InputError, did_you_mean, nearest
from frbcli.results.records import Signal
from frbcli.results.store import Run
from frbcli.units import ANGLE, NUMBER, SPEED, TEMPERATURE_DIFFERENCE, ValueFault, display, quantity


@pytest.mark.parametrize(
    ("text", "unit", "si"),
    [
        ("35 um", "m", 35e-6),
        ("4 mil", "m", 101.6e-6),
        ("35 micron", "m", 35e-6),
        ("35 um pp", "m", 35e-6),
        ("35 umpp", "m", 35e-6),
        ("2 milpk-pk", "m", 50.8e-6),
        ("2 sec", "s", 2.0),
        ("150 krpm", SPEED, 2500.0),
        ("3 g-mm", "kg*m", 3e-6),
        ("3 bara", "Pa", 3e5),
        ("3 bar abs", "Pa", 3e5),
        *((f"1200 {name}", SPEED, 20.0) for name in ("min-1", "r/min", "rev/min", "cpm", "1/min", "U/min")),
        ("35 µm", "m", 35e-6),  # micro sign
        ("35 μm", "m", 35e-6),  # Greek mu
        ("20mm", "m", 0.02),
        ("3 g*mm", "kg*m", 3e-6),
        ("3 g mm", "kg*m", 3e-6),
        ("20 kg·mm²", "kg*m^2", 20e-6),
        ("12 mPa*s", "Pa*s", 0.012),
        ("5000 N/mm", "N/m", 5e6),
        ("0.1 N*s/m", "N*s/m", 0.1),
        ("1 bar", "Pa", 1e5),
        ("830 kg/m^3", "kg/m^3", 830.0),
        ("9.81 m/s^2", "m/s^2", 9.81),
        ("1e-5 1/K", "1/K", 1e-5),
        ("100 degC", "K", 373.15),
        ("100 °C", "K", 373.15),
        ("-178 K", TEMPERATURE_DIFFERENCE, -178.0),
        ("180 deg", ANGLE, math.pi),
        ("15°", ANGLE, math.pi / 12),
        ("25 Hz", SPEED, 25.0),
        ("1.5 kHz", SPEED, 1500.0),
        ("3000 rpm", SPEED, 50.0),
        ("3000 1/min", SPEED, 50.0),
        ("1 rad/s", SPEED, 1 / (2 * math.pi)),
        ("0.999", NUMBER, 0.999),
        ("5 %", NUMBER, 0.05),
        ("80 C", "K", 353.15),
        ("176 F", "K", 353.15),
        ("46 mm2/s", "m^2/s", 46e-6),
        ("12 mPas", "Pa*s", 0.012),  # joined, as on data sheets
        ("10 Nm", "N*m", 10.0),
        ("3 N.m", "N*m", 3.0),
        ("5 Ns/mm", "N*s/m", 5e3),
        ("0.5 N.s/mm", "N*s/m", 500.0),
        ("3 gmm", "kg*m", 3e-6),
        ("3 gcm", "kg*m", 3e-5),
        ("10 kgcm2", "kg*m^2", 1e-3),
        ("830 kg/m3", "kg/m^3", 830.0),
        ("0.14 W/mK", "W/(m*K)", 0.14),
        ("0.14 W/m K", "W/(m*K)", 0.14),
        ("2 kJ/kgK", "J/(kg*K)", 2e3),
        ("2 lbm", "kg", 0.90718474),
        ("2 kp", "N", 19.6133),
        ("3 lpm", "m^3/s", 5e-5),
        ("3000 RPM", SPEED, 50.0),
        ("3000 min⁻¹", SPEED, 50.0),
        ("3000 tr/min", SPEED, 50.0),
        ("120 000 rpm", SPEED, 2000.0),  # thousands apart
        ("120'000.5 rpm", SPEED, 120000.5 / 60.0),
        ("1_234_567 um", "m", 1.234567),
        ('0.3"', "m", 7.62e-3),
        ("30 degrees", ANGLE, math.pi / 6.0),
        ("80 Celsius", "K", 353.15),
        ("2 GPM", "m^3/s", 2.0 * 3.785411784e-3 / 60.0),
    ],
)
def test_reads_the_notation_of_case_files(text: str, unit: str, si: float) -> None:
    assert quantity(text, unit) == pytest.approx(si, rel=1e-14)


def test_conversion_leaves_no_noise_in_the_last_bit() -> None:
    assert quantity("35 um", "m") == 35e-6


@pytest.mark.parametrize("unit", ["m", SPEED, ANGLE, "K", NUMBER])
def test_bare_numbers_are_si(unit: str) -> None:
    assert quantity(12, unit) == 12.0
    assert quantity(0.5, unit) == 0.5


@pytest.mark.parametrize(
    ("given", "unit", "problem"),
    [
        ("35", "m", "no unit"),
        ("25", SPEED, "no unit"),
        ("35 kg", "m", "cannot be turned into m"),
        ("35 furlongz", "m", "not known"),
        ("5 Hz", ANGLE, "does not fit"),
        ("5 1/s", SPEED, "does not fit"),  # revolutions or radians?
        ("10 degC", TEMPERATURE_DIFFERENCE, "cannot be turned into K"),
        ("35 u m", "kg*m", '"u" is a prefix without a unit'),  # to pint the atomic mass unit
        ("1 k", "J/K", '"k" is a prefix without a unit'),  # Boltzmann's constant
        ("35 u", "kg", '"u" is a prefix without a unit'),
        ("35 µ", "m", '"µ" is a prefix without a unit'),
        ("1 c", "m/s", '"c" is a prefix without a unit'),
        ("1 mPas", "Pa", '"mPas" in its unit, which is no unit'),  # the plural of mPa
        ("60 rpm", "1/s", "an angle or a plain number"),  # 6.28 by radians
        ("1 pi m", "m", "an angle or a plain number"),
        ("1 rad m", "m", "an angle or a plain number"),
        ("1 m^0", "m", "cannot be read"),  # a KeyError of pint
        ("1 degC^0", "K", "cannot be read"),
        ("1 m**-1/2", "m", "cannot be read"),
        ("1 degC*m", "m", "cannot be turned into m"),
        ("1e-400 m", "m", "too small"),
        ("1e-320 nm", "m", "too small"),
        ("1 m^9999999999", "m", "cannot be read"),
        ("1" * 100_000 + " m", "m", "finite"),
        ("1 " + "m" * 100_000, "m", "cannot be read"),
        ("1 " + "m*" * 50_000, "m", "cannot be read"),
        ("1 a" + " " * 100_000 + "b", "m", "cannot be turned into m"),
        ("1 m" + " " * 100_000 + "!", "m", "cannot be read"),
        ("1 " + "x" * 100_000, SPEED, "does not fit"),
        ("3 m^^2", "m", "cannot be read"),
        ("2 m^99999999", "m", "cannot be read"),
        ("120 0000 rpm", SPEED, "does not fit"),
        ("1234 567 rpm", SPEED, "does not fit"),
        ("about 3 mm", "m", "not a number"),
        ("", "m", "not a number"),
        ("nan m", "m", "not a number"),
        (math.nan, "m", "finite"),
        (math.inf, "m", "finite"),
        ("1e999 m", "m", "finite"),
        (10**400, "m", "finite"),
        (True, "m", "not a quantity"),
        (None, "m", "not a quantity"),
        ([1], "m", "not a quantity"),
    ],
)
def test_faults_say_what_is_wrong_and_what_to_write(given: object, unit: str, problem: str) -> None:
    begun = time.process_time()
    with pytest.raises(ValueFault) as caught:
        quantity(given, unit, "20 mm")
    assert time.process_time() - begun < 2.0  # the first one loads the registry
    assert problem in caught.value.problem
    assert '"20 mm"' in caught.value.remedy
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize(
    ("given", "unit", "written"), [("100 lb/in", "N/m", "100 lbf/in"), ("1 ft-lb", "N*m", "1 ft*lbf")]
)
def test_a_mass_where_a_force_is_meant_has_its_remedy(given: str, unit: str, written: str) -> None:
    with pytest.raises(ValueFault, match="cannot be turned") as caught:
        quantity(given, unit)
    assert f'"{written}"' in caught.value.remedy
    assert quantity(written, unit) > 1.0


@pytest.mark.parametrize(
    ("given", "unit", "better"),
    [("35 u m", "m", "35 um"), ("12 m Pa s", "Pa*s", "12 mPa s"), ("1.5 k N", "N", "1.5 kN"), ("35 m m", "m", "35 mm")],
)
def test_a_blank_behind_a_prefix_has_a_remedy_that_reads(given: str, unit: str, better: str) -> None:
    with pytest.raises(ValueFault) as caught:
        quantity(given, unit, "20 mm")
    assert f'Write "{better}"' in caught.value.remedy
    assert math.isfinite(quantity(better, unit))


@pytest.mark.parametrize(
    ("kind", "given", "problem"),
    [
        (Quantity("Pa", "210 GPa", above=0), 0.0, "is 0 Pa, but must be greater than 0."),
        (Quantity("Pa", "210 GPa", above=0), -1.0, "is -1 Pa, but must be greater than 0."),
        (Quantity(NUMBER, "0.5", most=1), 1.0000000001, "is 1.0000000001, but must be at most 1."),
        (Quantity("m", "1 mm", below=1e-3), 1.000000001e-3, "is 0.001000000001 m, but must be less than 1 mm."),
        (Quantity("m", "1 mm", below=1e-3), 1e-3, "is 1 mm, but must be less than 1 mm."),
        (Quantity("kg*m", "3 g*mm", above=0), 0, "is 0 g*mm, but must be greater than 0."),
    ],
)
def test_a_value_and_its_bound_never_print_alike(kind: Quantity, given: float, problem: str) -> None:
    with pytest.raises(ValueFault) as caught:
        kind.read(given)
    assert caught.value.problem == problem


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1 N*m/rpm", "N*m*s", 30.0 / math.pi),
        ("1 N*m/(1/min)", "N*m*s", 30.0 / math.pi),
        ("1 mN*m/krpm", "N*m*s", 30e-6 / math.pi),
        ("1 N*m/Hz", "N*m*s", 0.5 / math.pi),  # revolutions per second, as everywhere
        ("1 Nm/(rad/s)", "N*m*s", 1.0),
        ("1 N*m*s/rad", "N*m*s", 1.0),
        ("1 N*mm/rpm^2", "N*m*s^2", 1e-3 * (30.0 / math.pi) ** 2),
        ("1 Nm/(rad/s)²", "N*m*s^2", 1.0),
        ("1 N*m/rpm", "N*m*s^2", None),
        ("1 N*m/rpm^2", "N*m*s", None),
        ("1 N*m/rad/s", "N*m*s", None),
        ("1 N*m/s", "N*m*s", None),
        ("1 N*m/rpm^3", "N*m*s^2", None),
        ("1 N/rpm", "N*m*s", None),
    ],
)
def test_a_torque_over_a_speed_counts_its_radians(text: str, unit: str, value: float | None) -> None:
    if value is None:
        with pytest.raises(ValueFault):
            quantity(text, unit)
    else:
        assert quantity(text, unit) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (35e-6, "m", "35 um"),
        (0.02, "m", "20 mm"),
        (0.001, "m", "1 mm"),
        (3e-6, "kg*m", "3 g*mm"),
        (5e6, "N/m", "5000 N/mm"),
        (5e4, "Pa", "0.5 bar"),
        (0.012, "Pa*s", "12 mPa*s"),
        (math.pi / 12, ANGLE, "15 deg"),
        (-0.25, NUMBER, "-0.25"),
        (0.0, "m", "0 m"),
        (343.15, "K", "70 degC"),
        (0.5, "K", "0.5 K"),
        (9.81, "m/s^2", "9.81 m/s^2"),
    ],
)
def test_display_is_what_engineers_write(value: float, unit: str, text: str) -> None:
    assert display(value, unit) == text


UNITS = ["m", "kg", "kg*m", "kg*m^2", "N/m", "N*s/m", "Pa", "Pa*s", "s", "K", "1/K", SPEED, ANGLE, NUMBER]


@given(
    value=st.floats(1e-9, 1e9) | st.floats(-1e9, -1e-9) | st.just(0.0),
    unit=st.sampled_from([*UNITS, TEMPERATURE_DIFFERENCE]),
)
def test_what_is_displayed_reads_back(value: float, unit: str) -> None:
    assert quantity(display(value, unit), unit) == pytest.approx(value, rel=1e-5)


def is_number_or_fault(given: object, unit: str) -> bool:
    """Whether `given` is a finite number, or refused with words; any other exception passes and fails the test."""
    try:
        return math.isfinite(quantity(given, unit))
    except ValueFault as fault:
        return bool(fault.problem and fault.remedy)


@given(given=st.text() | st.integers() | st.floats() | st.booleans() | st.none(), unit=st.sampled_from(UNITS))
def test_anything_is_a_finite_number_or_a_fault(given: object, unit: str) -> None:
    assert is_number_or_fault(given, unit)


@settings(deadline=None)  # the first unit that is not in the table loads the registry
@given(
    number=st.floats(-1e3, 1e3),
    unit_text=st.text(alphabet="mKsPaNHzbardegC°µ*/^-0123456789 ", max_size=12),
    unit=st.sampled_from(UNITS),
)
def test_any_unit_is_read_or_refused(number: float, unit_text: str, unit: str) -> None:
    assert is_number_or_fault(f"{number} {unit_text}", unit)


REGISTERED = {"mil": "thou", "mils": "thou"}  # to the registry a mil is an angle
COMMON = [(unit, text) for unit, factors in units._COMMON.items() for text in factors]


@pytest.mark.parametrize(("unit", "text"), [*COMMON, ("K", "degC"), ("K", "°C")])
@settings(deadline=None, max_examples=10)  # a factor, and of temperatures a sum: a few numbers tell
@given(number=st.floats(-1e6, 1e6, allow_subnormal=False))
def test_common_units_are_those_of_the_registry(unit: str, text: str, number: float) -> None:
    written = float(f"{number:.9g}")
    assert quantity(f"{written!r} {text}", unit) == pytest.approx(
        units._by_pint(written, REGISTERED.get(text, text), unit, ""), rel=1e-14, abs=1e-12 if unit == "K" else 0.0
    )


def test_a_shipped_case_needs_no_registry_of_units() -> None:
    load = "import sys, frbcli; [frbcli.load_case(name) for name in frbcli.shipped_cases()]"
    code = f"{load}; assert 'pint' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


POINTS = ("journal_front", "journal_rear", "disk_turbine", "disk_compressor")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("compressor", ("disk_compressor",)),
        ("compresor", ("disk_compressor",)),
        ("journal_frnt", ("journal_front",)),
        ("journal_", ("journal_rear", "journal_front")),
        ("pressure", ()),
        ("", ()),
        (" ", ()),
    ],
)
def test_the_nearest_names(name: str, found: tuple[str, ...]) -> None:
    assert nearest(name, POINTS) == found


def test_few_names_are_listed_whole_and_many_by_their_command() -> None:
    assert did_you_mean("q", ["a", "b"]) == "There are: a, b."
    many = [f"signal_{k}" for k in range(46)]
    assert did_you_mean("q", many, "`frb cases` lists them.") == "`frb cases` lists them."
    assert did_you_mean("q", many).endswith("signal_11 and 34 more.")
    assert did_you_mean("signal_7x", many) == 'Did you mean "signal_7", "signal_17" or "signal_27"?'
    assert did_you_mean("q", []) == ""


def run_with(names: tuple[str, ...]) -> Run:
    import numpy as np

    samples = np.zeros(8)
    signals = {"time_s": Signal(np.arange(8.0), "s"), "speed_Hz": Signal(samples, "Hz")}
    signals |= {f"{name}_{axis}_m": Signal(samples, "m") for name in names for axis in "xy"}
    return Run(
        path="run.h5", title="", command="runup", case_name="", case_text="", versions={}, signals=signals,  # type: ignore[arg-type]
        status="finished", t_end_s=7.0, events=[], cost={}, error={}, references={}, checkpoint=None,
    )  # fmt: skip


def test_a_point_is_found_by_its_name_alone() -> None:
    from frbcli.analysis.signals import located, point_of

    run = run_with(POINTS)
    assert point_of(run, "compressor") == "disk_compressor"
    assert located(run, "front") == ("journal", "front")
    assert point_of(run, "journal") == "journal_front"
    with pytest.raises(InputError, match='Did you mean "disk_compressor"'):
        point_of(run, "compresor")
    assert point_of(run_with((*POINTS, "ring_front")), "front") == "journal_front"
    both = run_with(("journal_1", "disk_1"))
    with pytest.raises(InputError, match="There are: journal_1, disk_1"):
        point_of(both, "1")
    with pytest.raises(InputError, match='no signal "force"'):
        run["force"]
