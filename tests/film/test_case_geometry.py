"""The geometry of a case on its way to the films: numbers of tables A.1 and A.2, lobes, faults, what the plan says."""

from __future__ import annotations

import json
import math

import pytest

from frbcli import load_case
from frbcli.cli.main import run
from frbcli.film.gap import LobedShell, reynolds_number, ring_rotation_strains, shaft_rotation_strain
from frbcli.materials import BRASS, STEEL
from frbcli.scene.machine.findings import operating_points
from frbcli.scene.planning.kinematic_plan import KinematicPlan, kinematic_plan

CAR, ENGINE = 2.0 * math.pi * 5000.0, 2.0 * math.pi * 1500.0  # rad/s, tables A.1 and A.2


@pytest.mark.parametrize(
    ("omega", "diameter", "clearance", "viscosity", "printed"),
    [
        # table A.1 lists 12 mPa s for the inner films, too, but its Reynolds numbers there are those of 10 mPa s
        (1.3 * CAR, 7e-3, 15e-6, 10e-3, 193.0),
        (1.3 * ENGINE, 25e-3, 35e-6, 10e-3, 482.0),
        (0.3 * CAR, 11e-3, 35e-6, 12e-3, 136.0),
        (0.3 * ENGINE, 40e-3, 50e-6, 12e-3, 212.0),
    ],
)
def test_reynolds_numbers_of_table_a1(
    omega: float, diameter: float, clearance: float, viscosity: float, printed: float
) -> None:
    assert reynolds_number(900.0, omega, 0.5 * diameter, clearance, viscosity) == pytest.approx(printed, abs=0.6)


def test_strains_of_table_a2() -> None:
    printed = 0.6e-6  # half of the last digit
    assert shaft_rotation_strain(STEEL, CAR, 3.5e-3) == pytest.approx(0.083e-3, abs=printed)
    assert shaft_rotation_strain(STEEL, ENGINE, 12.5e-3) == pytest.approx(0.095e-3, abs=printed)
    car = ring_rotation_strains(BRASS, 0.4 * CAR, 3.5e-3, 5.5e-3)
    engine = ring_rotation_strains(BRASS, 0.4 * ENGINE, 12.5e-3, 20e-3)
    assert car == pytest.approx((0.492e-3, 0.271e-3), abs=printed)
    assert engine == pytest.approx((0.584e-3, 0.314e-3), abs=printed)


def test_solid_ring_is_a_shaft() -> None:
    assert ring_rotation_strains(STEEL, 1e3, 0.0, 0.02)[1] == pytest.approx(shaft_rotation_strain(STEEL, 1e3, 0.02))


def plan_of(*settings: str, test: str = "rotation", cavitation: str = "elrod") -> KinematicPlan:
    case = load_case("bearing", ["motion={eccentricity=0.3, speed='100 Hz'}", *settings])
    return kinematic_plan(case, cavitation, test)


def test_lobes_of_a_case_reach_the_section() -> None:
    plan = plan_of("bearing.lobes={count=3, preload=0.5, position='1.5 rad', offset=0.6}", cavitation="half-sommerfeld")
    assert plan.section.profile == LobedShell(3, 0.5, 1.5, 0.6)
    assert plan.section.clearance == pytest.approx(40e-6)  # that of the assembled bearing
    assert not plan.modal  # the modal film knows a plain gap only
    assert "lobes" in {decision.choice for decision in plan.decisions}


@pytest.mark.parametrize(
    ("settings", "cavitation", "expected"),
    [
        ((), "elrod", True),
        ((), "two-phase", True),
        ((), "reynolds", False),
        (("bearing.supply.pressure='1.2 bar'",), "elrod", False),
        (("bearing.ends='oil-bath'",), "elrod", True),  # at the pressure of the cavities a bath pushes nothing in
        (("bearing.ends='oil-bath'",), "two-phase", False),  # whose pressure falls below that of the bath
        (("bearing.ends='oil-bath'", "oil.cavitation_pressure='0.8 bar'"), "elrod", False),
        (("oil.cavitation_pressure='0.8 bar'",), "elrod", False),
        (("bearing.supply={kind='axial-grooves', opening_angle='15 deg', pressure='1 bar'}",), "elrod", False),
    ],
)
def test_plan_says_beforehand_that_a_film_will_starve(
    settings: tuple[str, ...], cavitation: str, expected: bool
) -> None:
    told = {(decision.choice, decision.value) for decision in plan_of(*settings, cavitation=cavitation).decisions}
    assert (("supply", "starves") in told) is expected


def test_check_shows_gap_and_reynolds_number(capsys: pytest.CaptureFixture[str]) -> None:
    """The bearing of table A.1, large engine, in a single film at its top speed; with (4.24) and Vogel's law (3.12)."""
    settings = ["bearing.clearance='35 um'", "oil.viscosity='10 mPa*s'", "oil.density='900 kg/m^3'",
                "motion={eccentricity=0.3, speed='1950 Hz'}"]  # fmt: skip
    options = [word for setting in settings for word in ("--set", setting)]
    assert run(["check", "bearing", "--json", *options]) == 0
    spoken = capsys.readouterr()
    film = json.loads(spoken.out)["films"][0]
    assert film["reynolds_number"] == pytest.approx(482.0, abs=0.6)
    assert film["laminar"]
    assert film["turning_m"] == pytest.approx(-12.5e-3 * 0.095e-3 * 1.3**2, rel=0.01)
    assert "Warning" not in spoken.out + spoken.err
    assert run(["check", "bearing", *options, "--set", "oil.viscosity='2 mPa*s'"]) == 0
    assert "Warning: Reynolds number 2412 in film" in capsys.readouterr().out
    engine = ["speed.to='1500 Hz'", "bearing.0.inner.diameter='25 mm'", "bearing.0.outer.diameter='40 mm'"]
    inner, outer = operating_points(load_case("turbocharger-heavy", engine))[:2]
    assert (inner.omega, outer.omega) == pytest.approx((1.3 * ENGINE, 0.3 * ENGINE))
    assert inner.turning == pytest.approx(12.5e-3 * (0.584e-3 * (0.3 / 0.4) ** 2 - 0.095e-3), rel=0.01)
    assert outer.turning == pytest.approx(-20e-3 * 0.314e-3 * (0.3 / 0.4) ** 2, rel=0.01)
    steel = operating_points(load_case("turbocharger-heavy", [*engine, "bearing.0.ring.material=steel"]))[1]
    share = (7850.0 / 2.1e11) / (8860.0 / 78e9)  # of density over modulus, and little of Poisson's ratio
    assert steel.turning == pytest.approx(share * outer.turning, rel=0.1)
    inner, outer = operating_points(load_case("turbocharger-heavy", [*engine, "bearing.0.ring.spin=blocked"]))[:2]
    assert (inner.omega, outer.omega, outer.turning) == pytest.approx((ENGINE, 0.0, 0.0))
    warm = ("{cold='35 um', reference_temperature='20 degC', shell_temperature='70 degC', "
            "journal_temperature='100 degC', shell_expansion='1.17e-5 1/K', "
            "journal_expansion='1.18e-5 1/K'}")  # fmt: skip
    point = operating_points(load_case("bearing", [f"bearing.clearance={warm}"]))[0]
    psi = 35e-6 / 12.5e-3 + 1.17e-5 * 50.0 - 1.18e-5 * 80.0  # (4.21), (4.22)
    assert point.clearance == pytest.approx(12.5e-3 * psi, rel=1e-9)
    assert point.warming == pytest.approx(point.clearance - 35e-6, rel=1e-9)
