"""Rough surfaces in kinematic tests and in small motions about rest: what their summits add to the film."""

import math

import numpy as np
import pytest
from films import ROUGH, plain_touch

from frbcli.bearing_tests.kinematic import KinematicResult, rotation, squeeze, whirl
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.film.roughness.asperities import SLOW
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.scene.machine.system import rough_surfaces

GROOVE = "bearing.supply={ kind = 'circumferential-groove', pressure = '1 bar' }"
R, C = 12.5e-3, 40e-6
CLOSE = 0.97  # 3 roughnesses are left


def case(motion: str, *settings: str) -> Case:
    return load_case("bearing", [GROOVE, "film.theory=short", f"motion={{{motion}}}", *settings])


def both(test: object, motion: str, *settings: str) -> tuple[KinematicResult, KinematicResult]:
    """A test between rough surfaces and between smooth ones."""
    found = [test(case(motion, *own, *settings), ["half-sommerfeld"]).results[0] for own in (ROUGH, ())]  # type: ignore[operator]
    return found[0], found[1]


def pressed(eccentricity: float) -> tuple[float, float]:
    """Integrals in N of the pressure of the summits: of all of it, and along the line of centres."""
    surfaces = rough_surfaces(case("eccentricity=0.5, speed='1 Hz'", *ROUGH))
    assert surfaces is not None
    return plain_touch(surfaces, 0, C, eccentricity * C)


@pytest.mark.parametrize("theory", ["short", "finite"])
def test_rotation_has_pressure_and_friction_of_the_summits_beside_the_film(theory: str) -> None:
    motion = f"eccentricity={CLOSE}, angle='-90 deg', speed='0.5 Hz'"
    rough, smooth = both(rotation, motion, f"film.theory={theory}", "accuracy.mesh=[8, 48]")
    assert rough.loads is not None
    assert smooth.loads is not None
    normal, radial = pressed(CLOSE)
    more = np.array(rough.loads.force) - smooth.loads.force
    assert more[1] == pytest.approx(radial, rel=1e-5)
    assert more[0] == pytest.approx(-0.12 * radial, rel=1e-5)  # its lowest place slides towards x
    assert rough.loads.torque.journal - smooth.loads.torque.journal == pytest.approx(-0.12 * R * normal, rel=1e-5)
    # moments about the middle of the shell: what turns the journal and the shell, and the force on its arm
    turning, own = (each.loads.torque.journal - each.loads.torque.shell for each in (rough, smooth))
    assert turning - own == pytest.approx(-CLOSE * C * more[0], rel=1e-9)
    assert rough.force_error < smooth.force_error  # of a larger force


def test_wide_gaps_have_the_film_alone() -> None:
    rough, smooth = both(rotation, "eccentricity=0.5, angle='-60 deg', speed='20 Hz'")
    assert rough.loads == smooth.loads
    assert [each.value for each in rough.plan.decisions if each.choice == "contact"] == ["rough, 0.4 um"]
    assert not any(each.choice == "contact" for each in smooth.plan.decisions)


@pytest.mark.parametrize("flow", [(), ("contact.flow_factors=true",)], ids=["smooth flow", "rough flow"])
def test_stribeck_curve_is_that_of_the_sheet(flow: tuple[str, ...]) -> None:
    """From boundary friction over a least one to the film alone, whose journals do not know of the roughness."""
    motion, common = "load='40 N', speed='3 Hz'", ("film.cavitation=half-sommerfeld", "film.theory=finite")
    (rough,) = rotation(case(motion, *ROUGH, *flow, *common)).results
    curve = rough.stribeck
    assert curve is not None
    friction, share = curve.friction_coefficient, curve.asperity_share
    least = int(np.argmin(friction))
    assert np.all(np.diff(curve.speed) > 0.0)
    assert 0 < least < len(friction) - 2
    assert np.all(np.diff(friction[least:]) > 0.0)
    assert share[0] > 0.9
    assert 0.5 * 0.12 < friction[0] < 1.1 * 0.12  # boundary friction has its own coefficient
    assert np.all(np.diff(share) <= 0.0)
    assert share[-1] == share[-2] == 0.0
    assert curve.least == (friction[least], curve.speed[least])
    some = [least - 2, least, len(friction) - 1]
    states = bearing_sheet(case(motion, *ROUGH, *flow, *common), curve.speed[some].tolist()).points
    for k, state in zip(some, states, strict=True):
        assert friction[k] == pytest.approx(state.friction_coefficient, rel=0.02)
    if not flow:
        (smooth,) = rotation(case(f"load='40 N', speed='{curve.speed[-1]} Hz'", *common)).results
        assert smooth.stribeck is None
        assert smooth.loads is not None
        assert friction[-1] == pytest.approx(abs(smooth.loads.torque.journal) / (R * 40.0), rel=2e-3)


def test_a_rotation_at_a_displacement_has_no_stribeck_curve() -> None:
    """Its load changes with the speed."""
    (result,) = rotation(case(f"eccentricity={CLOSE}, speed='1 Hz'", *ROUGH), ["half-sommerfeld"]).results
    assert result.stribeck is None


def test_a_squeeze_presses_the_summits_as_a_spring() -> None:
    """Without rotation they do not slide."""
    rough, smooth = both(squeeze, f"eccentricity={CLOSE}, frequency='2 Hz', periods=1, speed='0 Hz'")
    assert rough.history is not None
    assert smooth.history is not None
    more = rough.history.force - smooth.history.force
    np.testing.assert_array_equal(more[:, 0], 0.0)
    for place, force in list(zip(rough.history.displacement[:, 1], more[:, 1], strict=True))[::40]:
        expected = pressed(abs(place))[1] if abs(place) > 0.5 else 0.0
        assert force == pytest.approx(-math.copysign(expected, place), rel=1e-4, abs=1e-9)
    assert rough.loads is not None
    assert math.hypot(*rough.loads.force) == pytest.approx(np.hypot(*rough.history.force.T).max(), rel=1e-12)


def test_a_whirl_slides_on_its_shell() -> None:
    """Friction of a journal that does not spin holds its whirl back; its surface slides with eps C times the rate."""
    rough, smooth = both(whirl, f"eccentricity={CLOSE}, frequency='20 Hz', periods=3, speed='0 Hz'")
    assert rough.history is not None
    assert smooth.history is not None
    more, (x, y) = (rough.history.force - smooth.history.force)[-1], rough.history.displacement[-1]
    e = math.hypot(x, y)
    normal, radial = pressed(e)
    held = math.tanh(radial / normal * 2.0 * math.pi * 20.0 * e * C / SLOW)
    assert (x * more[0] + y * more[1]) / e == pytest.approx(-radial, rel=1e-4)
    assert (x * more[1] - y * more[0]) / e == pytest.approx(-0.12 * held * radial, rel=1e-4)


HEAT = "oil.viscosity={grade='SAE 10W-40'}", 'thermal={supply_temperature="70 degC"}'


@pytest.mark.parametrize(
    ("motion", "settings", "problem"),
    [
        ("eccentricity=0.5, speed='1 Hz', tilt=['0.1 mrad', '0 mrad']", (), "same along the axis"),
        ("eccentricity=0.5, speed='1 Hz'", HEAT, "makes heat by friction"),
    ],
)
def test_tests_of_rough_surfaces_without_an_answer_are_refused(
    motion: str, settings: tuple[str, ...], problem: str
) -> None:
    with pytest.raises(InputError, match=problem):
        rotation(case(motion, *ROUGH, *settings, "film.theory=finite"), ["half-sommerfeld"])
