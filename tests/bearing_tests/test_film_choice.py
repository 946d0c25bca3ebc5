"""Kinematic tests of one film among several: what the journal's test of a machine says is what that film alone says."""

import pytest

from frbcli import load_case, rotation
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import ROTATION

MOTION = 'motion={{film="{}", eccentricity=0.6, angle="-60 deg", speed="20 Hz"}}'
ALONE = 'motion={eccentricity=0.6, angle="-60 deg", speed="20 Hz"}'
OIL = ("oil.viscosity=12 mPa*s", "accuracy.mesh=[8, 48]")
# The films of floating-ring.toml as bearings of their own
INNER = (
    'bearing={kind="single-film", width="20 mm", diameter="25 mm", clearance="40 um", viscosity="12 mPa*s", '
    'supply={kind="bores", count=6, diameter="2.5 mm", pressure="2 bar"}}'
)
OUTER = (
    'bearing={kind="single-film", width="16 mm", diameter="40 mm", clearance="50 um", viscosity="14 mPa*s", '
    'supply={kind="circumferential-groove", pressure="2 bar"}}'
)


@pytest.mark.parametrize(("film", "alone"), [("inner", INNER), ("outer", OUTER)])
def test_a_film_of_a_ring_is_that_of_a_bearing_with_its_gap(film: str, alone: str) -> None:
    ring = rotation(load_case("floating-ring", [MOTION.format(film), "accuracy.mesh=[8, 48]"]), ["half-sommerfeld"])
    single = rotation(load_case("bearing", [ALONE, alone, *OIL]), ["half-sommerfeld"])
    assert ring.results[0].loads == single.results[0].loads
    assert ring.results[0].sommerfeld_number == single.results[0].sommerfeld_number


def test_each_bearing_of_a_turbocharger_can_be_tested() -> None:
    """Half-Sommerfeld forces fall with the square of the clearance, at one relative displacement."""
    film = 'kind="single-film", width="5 mm", diameter="7 mm", clearance="{} um"'
    bearings = ", ".join(
        f'{{name="{name}", position="{at} mm", {film.format(c)}}}' for name, at, c in (("a", 42, 10), ("b", 74, 20))
    )
    cases = (load_case("turbocharger-car", [f"bearing=[{bearings}]", MOTION.format(name)]) for name in "ab")
    narrow, wide = (rotation(case, ["half-sommerfeld"]).results[0].loads for case in cases)
    assert narrow is not None
    assert wide is not None
    assert narrow.force == pytest.approx([4.0 * each for each in wide.force], rel=1e-12)


def test_a_film_has_its_own_model_unless_another_one_is_asked_for() -> None:
    own = [MOTION.format("inner"), 'bearing.inner.cavitation="reynolds"', "accuracy.mesh=[4, 24]"]
    case = load_case("floating-ring", own)
    assert [each.cavitation for each in rotation(case).results] == ["reynolds"]
    assert [each.cavitation for each in rotation(case, ["half-sommerfeld"]).results] == ["half-sommerfeld"]


def test_remedies_lead_to_a_test() -> None:
    assert not faults(load_case("turbocharger-heavy", [MOTION.format("turbine_outer")]), ROTATION)
    coupled = [MOTION.format("inner"), "bearing.channels=pressure"]
    assert not faults(load_case("floating-ring", coupled), ROTATION)
    assert not faults(load_case("floating-ring-heat", [MOTION.format("outer"), "thermal.model=none"]), ROTATION)
