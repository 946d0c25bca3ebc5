"""The heat of thrust bearings: what is dissipated leaves, and the film is that of its viscosity."""

from __future__ import annotations

import numpy as np
import pytest

import frbcli
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.linear.sheets.thrust import ThrustState

SPEED, SUPPLY = [2000.0], 343.15
GRADE = "oil.viscosity={grade='SAE 10W-40'}"


def warm(*settings: str) -> Case:
    thermal = 'thermal={model="lumped", supply_temperature="70 degC"}'
    return frbcli.load_case("thrust", [GRADE, thermal, *settings])


def at(case: Case, gap: float = 10e-6) -> ThrustState:
    (state,) = frbcli.thrust_sheet(case, [gap], SPEED).points
    return state


@pytest.mark.parametrize("mixing", [0.5, 1.0])
def test_loss_leaves_with_the_oil(mixing: float) -> None:
    """P = s Q (T - T_in) / m, with the flow out of the bearing; s is linear between 80 and 120 degC, to 0.2 % that of
    the oil at the mean temperature of inlet and outlet."""
    case = warm(f"thermal.mixing={mixing}")
    state = at(case)
    assert state.temperature is not None
    rise = (state.temperature - SUPPLY) / mixing
    heat = case.oil.density * case.oil.heat_capacity_at(SUPPLY + 0.5 * rise)
    assert state.power == pytest.approx(heat * (state.flow_inner + state.flow_outer) * rise, rel=2e-3)


def test_film_is_that_of_its_viscosity() -> None:
    state = at(warm())
    assert case_law(warm(), state.temperature) == pytest.approx(state.viscosity, rel=1e-12)
    cold = at(frbcli.load_case("thrust", [f"oil.viscosity={state.viscosity!r}"]))
    assert cold.load == pytest.approx(state.load, rel=1e-12)
    assert cold.power == pytest.approx(state.power, rel=1e-12)
    assert cold.stiffness == pytest.approx(state.stiffness, rel=1e-12)


def case_law(case: Case, temperature: float | None) -> float:
    assert case.oil.law is not None
    assert temperature is not None
    return float(case.oil.law.at(temperature))


def test_collar_and_pads_take_heat() -> None:
    """P = s Q (T - T_in) / m + sum of Nu k (T - T_wall) integral of dA / h, that in closed form."""
    wall, gap = 348.15, 10e-6
    case = warm("thermal.shaft=75 degC", "thermal.housing=75 degC")
    (bearing,), state = case.thrust_bearings, at(case, gap)
    assert state.temperature is not None
    tapered = bearing.taper_angle / bearing.taper * np.log1p(bearing.taper / gap)
    sector = tapered + (bearing.pad_angle - bearing.taper_angle) / gap
    inverse = 0.5 * bearing.pads * (bearing.outer_radius**2 - bearing.inner_radius**2) * sector
    passed = 2.0 * 3.77 * case.oil.thermal_conductivity * inverse * (state.temperature - wall)
    heat = case.oil.density * case.oil.heat_capacity_at(state.temperature)
    carried = heat * (state.flow_inner + state.flow_outer) * 2.0 * (state.temperature - SUPPLY)
    assert passed > 0.1 * state.power
    assert state.power == pytest.approx(passed + carried, rel=2e-3)
    beyond = '{capacity="100 J/K", conductance="1e9 W/K", temperature="75 degC"}'
    node = at(warm(f"thermal.shaft={beyond}", "thermal.housing=75 degC"), gap)
    assert node.temperature == pytest.approx(state.temperature, abs=1e-3)


def test_sides_have_temperatures_of_their_own() -> None:
    both = warm("thrust_bearing.0.side=both", "thrust_bearing.0.end_play=40 um")
    (state,) = frbcli.thrust_sheet(both, [10e-6], SPEED).points
    first, other = at(warm(), 10e-6), at(warm(), 30e-6)
    assert state.temperature == first.temperature
    assert state.load == pytest.approx(first.load - other.load, rel=1e-9)
    assert state.power == pytest.approx(first.power + other.power, rel=1e-9)


def test_film_that_is_too_hot_ends_the_sheet() -> None:
    with pytest.raises(NotConverged, match="thrust bearing"):
        at(warm("thermal.hottest_film=100 degC"))
    assert np.isfinite(at(warm("thermal.hottest_film=110 degC")).load)
