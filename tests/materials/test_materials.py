"""Oils and solids by name: figures of their sources, the laws through them, and their keys in a case."""

import math

import pytest
from paths import DOCS

from frbcli.case.reading.load import load_case, load_case_text
from frbcli.materials import (
    OILS,
    SOLIDS,
    ZERO_CELSIUS,
    VogelLaw,
    conductivity,
    density,
    heat_capacity,
    through_three,
    walther,
)

KELVIN = tuple(t + ZERO_CELSIUS for t in (40.0, 100.0, 150.0))


def kinematic_viscosity(name: str, temperature: float) -> float:
    """mm^2/s of a grade at a temperature in K."""
    grade = OILS[name]
    return 1e6 * grade.law.at(temperature) / density(grade.density_15, temperature)


def test_law_through_three_points_of_a_law_is_that_law() -> None:
    law = VogelLaw(1.0369e-4, 973.95, 106.07 - ZERO_CELSIUS)
    found = through_three(KELVIN, [law.at(t) for t in KELVIN])
    assert (found.eta_0, found.a, found.c) == pytest.approx((law.eta_0, law.a, law.c), rel=1e-9)


def test_grade_10w_40_is_the_oil_of_the_concentric_heat_balance() -> None:
    law, printed = OILS["SAE 10W-40"].law, VogelLaw(1.0369e-4, 973.95, 106.07 - ZERO_CELSIUS)
    for celsius in (20.0, 70.0, 110.0, 154.0):
        assert law.at(celsius + ZERO_CELSIUS) == pytest.approx(printed.at(celsius + ZERO_CELSIUS), rel=1.5e-3)


@pytest.mark.parametrize("grade", OILS.values(), ids=list(OILS))
def test_every_oil_passes_through_its_figures_and_has_a_source(grade) -> None:  # type: ignore[no-untyped-def]
    assert [grade.law.at(t) for t in KELVIN] == pytest.approx(grade.viscosities, rel=1e-9)
    assert grade.source
    assert 850.0 <= grade.density_15 <= 900.0
    assert grade.law.at(ZERO_CELSIUS) > grade.law.at(KELVIN[0]) > grade.law.at(KELVIN[2]) > 1e-3


def test_single_grades_lie_within_sae_j300() -> None:
    """Kinematic viscosity at 100 degC, SAE J300 of 2015. The fit has SAE 40 2 % below the least of its grade."""
    limits = {"SAE 20": (6.9, 9.3), "SAE 30": (9.3, 12.5), "SAE 40": (0.975 * 12.5, 16.3), "SAE 50": (16.3, 21.9),
              "SAE 60": (21.9, 26.1), "SAE 10W-40": (12.5, 16.3), "SAE 5W-30": (9.3, 12.5),
              "SAE 0W-20": (6.9, 9.3), "SAE 0W-30": (9.3, 12.5)}  # fmt: skip
    for name, (least, most) in limits.items():
        assert least <= kinematic_viscosity(name, KELVIN[1]) < most, name


def test_grade_10w_40_is_one_per_cent_below_the_thinnest_measured_oil() -> None:
    """Five oils of the grade that PQIA measured in 2016 (pqiadata.org): 96.18 to 113.02 and 14.42 to 15.92 mm^2/s."""
    assert kinematic_viscosity("SAE 10W-40", KELVIN[0]) == pytest.approx(0.99 * 96.18, rel=3e-3)
    assert kinematic_viscosity("SAE 10W-40", KELVIN[1]) == pytest.approx(0.99 * 14.42, rel=3e-3)


@pytest.mark.parametrize(("name", "above"), [("SAE 10W-40", 0.024), ("SAE 5W-30", 0.013)])
def test_multigrade_oils_at_150_degrees_are_near_the_line_through_the_other_two(name: str, above: float) -> None:
    measured = [(t, kinematic_viscosity(name, t)) for t in KELVIN]
    assert measured[2][1] / walther(KELVIN[2], measured[0], measured[1]) == pytest.approx(1.0 + above, abs=1e-3)


def test_iso_grades_have_their_number_at_40_degrees_within_ten_per_cent() -> None:
    for number in (32, 46, 68):
        assert kinematic_viscosity(f"ISO VG {number}", KELVIN[0]) == pytest.approx(number, rel=0.1)


def test_heat_of_an_oil_is_that_of_tables() -> None:
    """Engine oil, unused, Incropera and DeWitt table A.5: K, kg/m^3, J/(kg K), W/(m K); docs/heat.md says the same."""
    table = [(280.0, 895.3, 1827.0, 0.144), (300.0, 884.1, 1909.0, 0.145), (320.0, 871.8, 1993.0, 0.143),
             (350.0, 853.9, 2118.0, 0.138), (400.0, 825.1, 2337.0, 0.134), (430.0, 806.5, 2471.0, 0.132)]  # fmt: skip
    at_15 = 853.9 * (1.0 + 7.0e-4 * (350.0 - 288.15))
    for kelvin, rho, c, k in table:
        assert density(at_15, kelvin) == pytest.approx(rho, rel=5e-3)
        assert 0.95 < heat_capacity(at_15, kelvin) / c < 0.993
        assert 0.89 < conductivity(at_15, kelvin) / k < 0.915


def test_heat_of_an_oil_is_the_formula_in_its_own_units() -> None:
    """(0.388 + 0.00045 t)/sqrt(s) Btu/(lb degF) with t in degF."""
    for celsius in (0.0, 60.0, 150.0):
        formula = 4186.8 * (0.388 + 0.00045 * (32.0 + 1.8 * celsius)) / math.sqrt(0.88)
        assert heat_capacity(880.0, celsius + ZERO_CELSIUS) == pytest.approx(formula, rel=1e-3)


def test_page_on_heat_has_the_figures() -> None:
    page = (DOCS / "heat.md").read_text(encoding="utf-8")
    for name, grade in OILS.items():
        viscosities = ", ".join(f"{1e3 * value:.4g}" for value in grade.viscosities)
        assert f"| `{name}` | {viscosities} | {grade.density_15:g} |" in page
    for name, solid in SOLIDS.items():
        heat = f"{solid.conductivity:g} | {solid.heat_capacity:g} | {solid.density:g}"
        growth = f"{1e6 * solid.expansion:.3g} | {1e-9 * solid.modulus:g}"
        assert f"| `{name}` | {heat} | {growth} |" in page


GRADE = "oil.viscosity={ grade = 'SAE 10W-40' }"


def test_case_takes_a_grade_at_its_temperature() -> None:
    case = load_case("jeffcott", [GRADE, "oil.temperature=100 degC"])
    assert case.viscosity(case.bearings[0]) == pytest.approx(11.7e-3)  # type: ignore[arg-type]
    assert load_case_text(case.source_text) == case
    thinner = load_case("jeffcott", [GRADE, "oil.temperature=100 degC", "oil.shear_factor=0.7"])
    assert thinner.oil.viscosity == pytest.approx(0.7 * 11.7e-3)


def test_density_of_a_grade_is_that_at_its_temperature_unless_given() -> None:
    text = load_case("jeffcott").source_text.replace('density = "830 kg/m^3"\n', "")
    assert "density" not in text
    case = load_case_text(text, [GRADE, "oil.temperature=86 degC"])
    assert case.oil.density == pytest.approx(870.0 / (1.0 + 7.0e-4 * 71.0))
    assert load_case("jeffcott", [GRADE, "oil.temperature=86 degC", "oil.density=900 kg/m^3"]).oil.density == 900.0
