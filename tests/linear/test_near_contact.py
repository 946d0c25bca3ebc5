"""Near contact, where summits carry a part of the load: films on meshes 1.5 times finer agree within the stated errors,
and a run rests where the sheet has it. The force of summits grows by e over a third of a roughness, so that share and
friction tell small errors of the place."""

import math

import numpy as np
import pytest
from films import ROUGH

from frbcli.bearing_tests.kinematic import rotation
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.equilibrium import static_films
from frbcli.equilibrium.resting import resting_position
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.linear.sheets.film_state import FilmState, MixedFriction
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

ON_CELLS = pytest.mark.parametrize(
    "flow", ["film.solution=cells", "contact.flow_factors=true"], ids=["smooth flow", "rough flow"]
)
FINER = (216, 30)  # cells around and along, 1.5 times those of static results
COARSE, FINE = (8, 64), (12, 96)  # along and around, of runs and tests


def rigid(*settings: str) -> Case:
    return load_case("rigid", [*ROUGH, *settings])


def at(case: Case, speed_Hz: float) -> tuple[FilmState, MixedFriction]:
    (state,) = bearing_sheet(case, [speed_Hz]).points
    assert state.mixed is not None
    return state, state.mixed


@ON_CELLS
@pytest.mark.parametrize("speed", [0.1])
def test_sheets_agree_within_their_errors(flow: str, speed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    own, friction = at(rigid(flow), speed)
    monkeypatch.setattr(static_films, "CELLS", FINER)
    fine, finer_friction = at(rigid(flow), speed)
    assert 0.05 < friction.share < 0.7
    assert abs(friction.share - finer_friction.share) <= friction.share_error < 0.25 * friction.share
    assert abs(own.power - fine.power) <= own.power_error < 0.25 * own.power
    assert np.hypot(*(own.displacement - fine.displacement)) <= own.place_error
    assert abs(own.film_thickness_min - fine.film_thickness_min) <= own.film_thickness_error
    assert abs(own.p_max - fine.p_max) <= own.p_max_error
    assert abs(own.side_flow - fine.side_flow) <= own.side_flow_error


@ON_CELLS
@pytest.mark.parametrize("speed", [0.1])
def test_a_run_rests_where_the_sheet_has_it(flow: str, speed: float) -> None:
    """Where its plan and the sheet say so, on the cells of its plan and on more and more."""
    state, _ = at(rigid(flow), speed)
    off = []
    for mesh in ((), *((f"accuracy.mesh=[{along}, {around}]",) for along, around in (COARSE, FINE))):
        case = rigid(flow, *mesh)
        plan = make_plan(case)
        system = make_system(case, plan)
        (place,) = resting_position(system, 2.0 * math.pi * speed).journals / system.clearances[0]
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
