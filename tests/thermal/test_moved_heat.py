"""Heat in squeeze and whirl: one temperature, at which the means of dissipation and side flow over a period balance."""

from __future__ import annotations

import numpy as np
import pytest

from frbcli.bearing_tests.kinematic import KinematicResult, rotation, squeeze, whirl
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.thermal.steady import SteadyHeat

SUPPLIED = 50.0 + 273.15
WARM = [
    "bearing.supply={ kind = 'circumferential-groove', pressure = '2 bar' }", "oil.heat_capacity=2100 J/(kg*K)",
    'oil.viscosity={ grade = "SAE 10W-40" }', "thermal.model=lumped", "thermal.supply_temperature=50 degC",
    "accuracy.mesh=[8, 32]",
]  # fmt: skip


def moved(motion: str, *settings: str) -> Case:
    return load_case("squeeze", [*WARM, f"motion={{{motion}}}", *settings])


def heat(found: KinematicResult) -> SteadyHeat:
    assert found.heat is not None
    return found.heat


def rise(found: KinematicResult) -> float:
    return float(heat(found).temperatures[0]) - SUPPLIED


def test_steady_whirl_has_the_temperature_of_a_rotation_that_whirls() -> None:
    """On a circle a film without memory dissipates the same at each moment, as a rotation with this whirl speed does.
    Both have the same cells; those of the rotation are finer at the narrowest gap."""
    circle = "eccentricity=0.4, speed='50 Hz'"
    (turned,) = whirl(moved(f"{circle}, frequency='20 Hz', periods=3"), ["half-sommerfeld"]).results
    (lasting,) = rotation(moved(f"{circle}, angle='0 deg', whirl_speed='20 Hz'"), ["half-sommerfeld"]).results
    assert rise(lasting) > 10.0
    assert rise(turned) == pytest.approx(rise(lasting), rel=5e-3)
    assert heat(turned).films.power == pytest.approx(heat(lasting).films.power, rel=5e-3)
    assert heat(turned).films.flow == pytest.approx(heat(lasting).films.flow, rel=5e-3)


@pytest.mark.parametrize("cavitation", ["half-sommerfeld", "two-phase"])
def test_power_of_a_squeeze_is_the_work_of_its_force(cavitation: str) -> None:
    """Without rotation the journal puts in -F . v alone; without walls the oil that leaves carries it away."""
    case = moved("eccentricity=0.6, frequency='20 Hz', periods=1")
    (found,) = squeeze(case, [cavitation]).results
    assert found.history is not None
    (temperature,), (power,), (flow,) = heat(found).temperatures, heat(found).films.power, heat(found).films.flow
    assert temperature - SUPPLIED == pytest.approx(0.5 * power / (case.oil.density * 2100.0 * flow), rel=1e-3)
    times, force = found.history.time_s, found.history.force[:, 1]
    rate = 2.0 * np.pi * 20.0
    speed = -found.plan.section.clearance * 0.6 * rate * np.cos(rate * times)
    assert power == pytest.approx(-float(np.mean((force * speed)[-found.plan.steps :])), rel=1e-4)
    assert found.plan.section.viscosity == pytest.approx(heat(found).viscosities[0])


def test_less_than_a_period_has_no_mean() -> None:
    with pytest.raises(InputError, match="less than one period"):
        squeeze(moved("eccentricity=0.6, frequency='20 Hz', periods=0.5"))
