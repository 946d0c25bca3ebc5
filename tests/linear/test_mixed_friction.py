"""Rough bearings at rest: standing on their summits, mixed friction, and the film alone. Near contact, where summits
carry a part of the load: films on meshes 1.5 times finer agree within the stated errors, and a run rests where the
sheet has it. The force of summits grows by e over a third of a roughness, so that share and friction tell small errors
of the place."""

import math
from functools import partial

import numpy as np
import pytest
from films import ROUGH, plain_touch

from frbcli.bearing_tests.kinematic import rotation
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.equilibrium import static_films
from frbcli.equilibrium.dynamic_films import dynamic_film
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.static_machine import StaticMachines, warm_machine
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.linear.sheets.film_state import FilmState, MixedFriction
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import STABILITY
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

LOAD = 6.1 * 9.81 / 2.0


def rigid(*settings: str) -> Case:
    return load_case("rigid", [*ROUGH, *settings])


def mixed(state: FilmState) -> MixedFriction:
    assert state.mixed is not None
    return state.mixed


@pytest.mark.parametrize("settings", [(), ("contact.mean_height=1.5 um",)])
def test_a_shaft_that_stands_still_rests_on_its_summits(settings: tuple[str, ...]) -> None:
    case = rigid(*settings)
    system = make_system(case, make_plan(case))
    place = resting_position(system, 0.0).journals[0]
    assert place[0] == pytest.approx(0.0, abs=1e-12 * system.clearances[0])
    assert system.asperities is not None
    _, radial = plain_touch(system.asperities, 0, system.clearances[0], -float(place[1]))
    assert radial == pytest.approx(LOAD, rel=1e-6)
    if settings:
        lower = make_system(rigid(), make_plan(rigid()))
        gaps = [each.clearances[0] + resting_position(each, 0.0).journals[0][1] for each in (system, lower)]
        assert gaps[0] - gaps[1] == pytest.approx(1.5e-6, rel=0.02)  # and a stripe that is as much narrower


def test_thin_oil_leaves_boundary_friction() -> None:
    """A film that carries nothing: the journal climbs until friction and pressure hold its weight."""
    (state,) = bearing_sheet(rigid("oil.viscosity=1e-8 Pa*s"), [1.0]).points
    assert mixed(state).share == pytest.approx(1.0, abs=1e-4)
    assert state.attitude_deg == pytest.approx(-math.degrees(math.atan(0.12)), abs=1e-3)  # against the film's sense
    system = make_system(rigid(), make_plan(rigid()))
    assert system.asperities is not None
    eccentricity = state.eccentricity * state.clearance
    normal, radial = plain_touch(system.asperities, 0, state.clearance, eccentricity)
    assert state.friction_coefficient == pytest.approx(0.12 * normal / (radial * math.hypot(1.0, 0.12)), rel=1e-4)


def test_stribeck_curve_has_its_minimum_between_boundary_friction_and_the_film_alone() -> None:
    speeds = [0.05, 0.1, 0.2, 0.4, 0.8, 3.0, 20.0]
    rough, smooth = (bearing_sheet(case, speeds).points for case in (rigid(), load_case("rigid")))
    friction = [state.friction_coefficient for state in rough]
    least = int(np.argmin(friction))
    assert 0 < least < len(speeds) - 2
    assert friction[: least + 1] == sorted(friction[: least + 1], reverse=True)
    assert friction[least:] == sorted(friction[least:])
    shares = [mixed(state).share for state in rough]
    assert shares == sorted(shares, reverse=True)
    assert shares[0] > 0.5
    for own, film in zip(rough[-2:], smooth[-2:], strict=True):  # where no summits meet
        assert mixed(own).share == mixed(own).power == 0.0
        assert own.friction_coefficient == film.friction_coefficient
        np.testing.assert_array_equal(own.displacement, film.displacement)
        np.testing.assert_array_equal(own.stiffness, film.stiffness)


def test_flow_factors_carry_more_and_resist_more_until_the_gap_is_wide() -> None:
    """Rough surfaces hold their oil back: the journal rides higher, with less of its load on the summits. Against the
    same films on cells between surfaces that are smooth for the flow."""
    plain = ("film.solution=cells",)
    rough, smooth = (
        bearing_sheet(rigid(*plain, *settings), [0.1, 0.4, 60.0]).points
        for settings in (("contact.flow_factors=true",), ())
    )
    for own, other in zip(rough[:2], smooth[:2], strict=True):
        assert mixed(own).film_parameter > mixed(other).film_parameter
        assert mixed(own).share < mixed(other).share
    assert rough[1].friction_coefficient < rough[0].friction_coefficient  # boundary friction, then mixed
    wide = 0.4e-6 / rough[2].film_thickness_min
    assert wide < 0.05
    assert rough[2].eccentricity == pytest.approx(smooth[2].eccentricity, rel=2.0 * wide)
    assert rough[2].torque == pytest.approx(smooth[2].torque, rel=2.5 * wide**2)


@pytest.mark.parametrize("speed", [0.2, 20.0])
def test_smooth_surfaces_have_the_film_alone(speed: float) -> None:
    (rough,) = bearing_sheet(rigid("contact.roughness=1 nm", "contact.summit_radius=50 nm"), [speed]).points
    (smooth,) = bearing_sheet(load_case("rigid"), [speed]).points
    np.testing.assert_allclose(rough.displacement, smooth.displacement, rtol=1e-9)
    np.testing.assert_allclose(rough.stiffness, smooth.stiffness, rtol=1e-9)
    assert rough.torque == pytest.approx(smooth.torque, rel=1e-9)


def test_stiffness_is_the_slope_of_the_load_with_friction_and_film() -> None:
    case = rigid()
    system = make_system(case, make_plan(case))
    place, omega = np.array([2e-6, -33.9e-6]), 2.0 * math.pi * 0.2
    found, step = system.force(0, place, np.zeros(2), omega), 1e-11
    for column, unit in enumerate(np.eye(2)):
        ahead, behind = (system.force(0, place + side * step * unit, np.zeros(2), omega).force for side in (1, -1))
        slope = found.by_displacement[:, column]
        np.testing.assert_allclose(slope, (ahead - behind) / (2 * step), rtol=1e-4, atol=1e-4 * abs(slope).max())


HOT = "oil.viscosity={grade='SAE 10W-40'}", 'thermal={model="lumped", supply_temperature="70 degC"}'


def test_friction_heats_a_film_at_rest() -> None:
    """The power of the balance is that of film and friction in the sheet at its viscosity, and friction is a part of
    it. It was left out, and so refused."""
    case = rigid(*HOT, "rotor.gravity=100 m/s^2")
    (film,) = warm_machine(case, 1.0).films
    (state,) = bearing_sheet(case, [1.0]).points
    assert mixed(state).power > 0.2 * state.power
    assert film.power == pytest.approx(state.power, rel=1e-2)
    assert not faults(case, STABILITY)


def test_a_sheet_has_the_friction_that_holds_a_ring() -> None:
    """At 1 Hz the ring creeps: the torques of friction and film on its inner and outer surface balance. That on a
    shell is that on its journal turned round, with the moment of the load about the middle of the shell."""
    ring = load_case("floating-ring", [*ROUGH, "film.cavitation=half-sommerfeld"])
    inner, outer = bearing_sheet(ring, [1.0]).points
    assert mixed(outer).share > 0.5
    assert 0.0 < outer.journal_speed_Hz < 1e-3
    assert inner.shell_speed_Hz == pytest.approx(outer.journal_speed_Hz, rel=1e-9)
    moment = inner.clearance * (inner.displacement[0] * inner.load[1] - inner.displacement[1] * inner.load[0])
    assert abs(moment) > 0.2 * abs(inner.torque)
    assert outer.torque + (moment - inner.torque) == pytest.approx(0.0, abs=0.01 * abs(outer.torque))


def test_oil_and_summits_answer_beside_each_other() -> None:
    supply = 'bearing.supply={kind="axial-grooves", opening_angle="15 deg", pressure="2 bar"}'
    case = rigid("film.cavitation=elrod", supply)
    machine = StaticMachines(case, memory=True).at(2.0 * math.pi * 0.3)
    (film,), (place,), system = machine.dynamic, machine.at_rest.position.journals, machine.system
    assert system.asperities is not None
    summits = system.rubbing(0).force(place, np.zeros(2), 2.0 * math.pi * 0.3)
    assert -summits.by_displacement[1, 1] > 1e6
    alone = dynamic_film(partial(system.films.linear, 0), place, 2.0 * math.pi * 0.3, 2.0 * math.pi * 0.3)
    for s in (0.5j, -0.1 + 3.0j):
        more = -summits.by_displacement - s * summits.by_velocity
        for own, other in ((film.own, alone.own), (film.fine, alone.fine), (film.one, alone.one)):
            np.testing.assert_allclose(own.at(s)[0], other.at(s)[0] + more, atol=1e-9 * np.abs(more).max())


ON_CELLS = pytest.mark.parametrize(
    "flow", ["film.solution=cells", "contact.flow_factors=true"], ids=["smooth flow", "rough flow"]
)
FINER = (216, 30)  # cells around and along, 1.5 times those of static results
SLOW_Hz = 0.1
COARSE, FINE = (8, 64), (12, 96)  # along and around, of runs and tests


def at(case: Case, speed_Hz: float) -> tuple[FilmState, MixedFriction]:
    (state,) = bearing_sheet(case, [speed_Hz]).points
    assert state.mixed is not None
    return state, state.mixed


@ON_CELLS
def test_sheets_agree_within_their_errors(flow: str, monkeypatch: pytest.MonkeyPatch) -> None:
    own, friction = at(rigid(flow), SLOW_Hz)
    monkeypatch.setattr(static_films, "CELLS", FINER)
    fine, finer_friction = at(rigid(flow), SLOW_Hz)
    assert 0.05 < friction.share < 0.7
    assert abs(friction.share - finer_friction.share) <= friction.share_error < 0.25 * friction.share
    assert abs(own.power - fine.power) <= own.power_error < 0.25 * own.power
    assert np.hypot(*(own.displacement - fine.displacement)) <= own.place_error
    assert abs(own.film_thickness_min - fine.film_thickness_min) <= own.film_thickness_error
    assert abs(own.p_max - fine.p_max) <= own.p_max_error
    assert abs(own.side_flow - fine.side_flow) <= own.side_flow_error


@ON_CELLS
def test_a_run_rests_where_the_sheet_has_it(flow: str) -> None:
    """Where its plan and the sheet say so, on the cells of its plan and on more and more."""
    state, _ = at(rigid(flow), SLOW_Hz)
    off = []
    for mesh in ((), *((f"accuracy.mesh=[{along}, {around}]",) for along, around in (COARSE, FINE))):
        case = rigid(flow, *mesh)
        plan = make_plan(case)
        system = make_system(case, plan)
        (place,) = resting_position(system, 2.0 * math.pi * SLOW_Hz).journals / system.clearances[0]
        assert abs(np.hypot(*place) - state.eccentricity) <= plan.film_error + state.place_error
        off.append(np.hypot(*(place - state.displacement)))
    assert off[1] > 2.0 * off[2]
    assert off[2] < 2e-3


def test_rotations_agree_within_their_errors() -> None:
    supply = "bearing.supply={ kind = 'circumferential-groove', pressure = '1 bar' }"
    motion = "motion={eccentricity=0.97, angle='-90 deg', speed='0.5 Hz'}"
    common = supply, motion, *ROUGH, "contact.flow_factors=true", "film.cavitation=half-sommerfeld"
    found = []
    for along, around in (COARSE, FINE):
        (result,) = rotation(load_case("bearing", [*common, f"accuracy.mesh=[{along}, {around}]"])).results
        assert result.loads is not None
        found.append((np.array(result.loads.force), result.force_error * np.hypot(*result.loads.force)))
    (coarse, error), (fine, less) = found
    assert less < 0.5 * error
    assert np.hypot(*(coarse - fine)) <= error < 0.03 * np.hypot(*fine)


def test_where_no_summits_meet_friction_has_no_error() -> None:
    _, friction = at(rigid("film.solution=cells"), 20.0)
    assert friction.share == friction.share_error == friction.power_error == 0.0
