"""Rotations of a journal that tilts, and what is refused. Independent values: tests/data/tilted-journal.csv, by finite
volumes of another program, 360 x 120 and 180 x 60 cells extrapolated, exact to 1e-4 of the largest force or moment of a
row."""

import math
import re

import numpy as np
import pytest
from paths import rows_of

from frbcli import load_case_text, rotation, squeeze, whirl
from frbcli.bearing_tests.kinematic import KinematicResult
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.film.cavitation.table import names
from frbcli.scene.gate.gate import faults

ROWS = rows_of("tilted-journal.csv")
REFERENCE = 1e-4  # of the largest force or moment of a row
FINE, COARSE = "accuracy.mesh=[80, 240]", "accuracy.mesh=[40, 128]"

CASE = """
[bearing]
kind = "single-film"
width = "12 mm"
diameter = "20 mm"
clearance = "40 um"
ends = "oil-bath"
[oil]
viscosity = "10 mPa*s"
density = "850 kg/m^3"
ambient_pressure = "1 bar"
cavitation_pressure = "1 bar"
[film]
cavitation = "reynolds"
[motion]
eccentricity = 0.4
angle = "-60 deg"
speed = "150 Hz"
"""
TILT = 'motion.tilt=["1 mrad", "-0.5 mrad"]'


def case_of(*settings: str) -> Case:
    return load_case_text(CASE, settings, "tilted")


def of_row(row: dict[str, str], *settings: str) -> Case:
    value = {key: float(number) for key, number in row.items() if key != "condition"}
    x, y, c = value["x_m"], value["y_m"], value["clearance_m"]
    return case_of(
        f"film.cavitation={row['condition']}",
        f"bearing.width={value['width_m']}", f"bearing.diameter={2.0 * value['radius_m']}", f"bearing.clearance={c}",
        f"oil.viscosity={value['viscosity_Pas']}",
        f"motion.eccentricity={math.hypot(x, y) / c}", f"motion.angle={math.atan2(y, x)}",
        f"motion.speed={value['omega_rad_s'] / (2.0 * math.pi)}",
        f"motion.velocity=[{value['vx_m_s']}, {value['vy_m_s']}]",
        f"motion.tilt=[{value['tilt_x_rad']}, {value['tilt_y_rad']}]",
        f"motion.tilt_rate=[{value['tilt_rate_x_rad_s']}, {value['tilt_rate_y_rad_s']}]",
        *settings,
    )  # fmt: skip


def one(case: Case) -> KinematicResult:
    (result,) = rotation(case).results
    assert result.loads is not None
    return result


@pytest.mark.parametrize("number", range(len(ROWS)))
def test_reference_values_and_the_stated_error(number: int) -> None:
    """To 2e-3 of the largest force and moment; the true error is one to six times smaller than the stated one."""
    row = ROWS[number]
    result = one(of_row(row))
    assert result.loads is not None
    for found, stated, keys in (
        (result.loads.force, result.force_error, ("Fx_N", "Fy_N")),
        (result.loads.moment, result.moment_error, ("Mx_Nm", "My_Nm")),
    ):
        expected = np.array([float(row[key]) for key in keys])
        off, largest = float(np.hypot(*(np.array(found) - expected))), np.abs(expected).max()
        error = stated * float(np.hypot(*found))
        assert off < 2e-3 * largest
        assert off < error + REFERENCE * largest
        assert error < 6.0 * (off + REFERENCE * largest)


def test_no_tilt_is_the_film_without() -> None:
    still = one(case_of())
    given = one(case_of('motion.tilt=["0 mrad", "0 mrad"]'))
    assert given.loads == still.loads
    assert given.loads is not None
    assert given.loads.moment == (0.0, 0.0)
    nearly = one(case_of('motion.tilt=["1e-9 rad", "0 rad"]'))
    assert nearly.loads is not None
    assert nearly.loads.force == pytest.approx(given.loads.force, rel=2e-3)
    assert abs(nearly.loads.moment[0]) < 1e-5 * 0.012 * np.hypot(*nearly.loads.force)


def test_documents_have_the_moment_where_it_is_asked_for() -> None:
    found = rotation(case_of(TILT, "accuracy.mesh=[12, 48]"))
    (document,) = found.table().documents()
    assert found.results[0].loads is not None
    assert document["moment_N_m"] == found.results[0].loads.moment
    assert document["error"]["moment_relative"] == found.results[0].moment_error
    assert "moment_x_N_m" in found.to_pandas()
    assert "moment_N_m" not in rotation(case_of()).table().documents()[0]


def test_velocity_is_that_of_whirl_and_eccentricity_rate() -> None:
    e, angle, c = 0.4, math.radians(-60.0), 40e-6
    turn, growth = 2.0 * math.pi * 30.0, 20.0
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    v = c * (growth * along + e * turn * across)
    whirl = one(case_of('motion.whirl_speed="30 Hz"', 'motion.eccentricity_rate="20 1/s"'))
    given = one(case_of(f"motion.velocity=[{v[0]}, {v[1]}]"))
    assert whirl.loads is not None
    assert given.loads is not None
    assert given.loads.force == pytest.approx(whirl.loads.force, rel=1e-9)


def test_shell_that_is_not_in_line_tilts_the_journal_the_other_way() -> None:
    journal = one(case_of(TILT))
    shell = one(case_of('bearing.misalignment=["-1 mrad", "0.5 mrad"]'))
    assert shell.loads == journal.loads
    both = one(case_of(TILT, 'bearing.misalignment=["1 mrad", "-0.5 mrad"]'))
    assert both.loads == one(case_of()).loads


# --- squeeze and whirl ------------------------------------------------------------------------------------------------

TESTS = {"squeeze": squeeze, "whirl": whirl}
SHORT = ('motion.frequency="50 Hz"', "motion.periods=0.05", "accuracy.mesh=[8, 32]")
PLAIN = 'bearing.supply={kind="none"}'
GROOVE = 'bearing.supply={kind="circumferential-groove", pressure="2 bar"}'
BORES = 'bearing.supply={kind="bores", count=3, diameter="2 mm", axial_position=0.5, pressure="2 bar", on="journal"}'


def moved(test: str, *settings: str) -> KinematicResult:
    (result,) = TESTS[test](case_of(*SHORT, *settings)).results
    assert result.history is not None
    return result


@pytest.mark.parametrize(("test", "law", "supply", "apart"), [
    ("whirl", "elrod", PLAIN, 0.02),
    ("whirl", "reynolds", GROOVE, 0.02),
    ("squeeze", "elrod", BORES, 0.05),
])  # fmt: skip
def test_a_moved_journal_tilted_the_other_way_is_the_mirror_image(
    test: str, law: str, supply: str, apart: float
) -> None:
    """Mirrored at the middle of the bearing: the same force, and the opposite moment, also of a shell in place of the
    journal. A tilt that is next to none is the film without one but for the cells, finer at the ends, which bores cut
    elsewhere."""
    law = f"film.cavitation={law}"
    one_way = moved(test, law, supply, TILT).history
    other = moved(test, law, supply, 'bearing.misalignment=["1 mrad", "-0.5 mrad"]').history
    assert one_way is not None
    assert other is not None
    size, length = np.abs(one_way.force).max(), 0.012
    assert np.abs(one_way.force - other.force).max() < 1e-9 * size
    assert np.abs(one_way.moment + other.moment).max() < 1e-9 * size * length
    assert np.abs(one_way.moment).max() > 1e-3 * size * length
    flat, hardly = (moved(test, law, supply, *more).history for more in ((), ('motion.tilt=["1e-9 rad", "0 rad"]',)))
    assert flat is not None
    assert hardly is not None
    assert np.abs(flat.force - hardly.force).max() < apart * np.abs(flat.force).max()
    assert np.abs(one_way.force - hardly.force).max() > 0.01 * np.abs(flat.force).max()


@pytest.mark.parametrize("supply", ['bearing.supply={kind="none"}', GROOVE])
def test_a_moved_journal_is_at_each_moment_a_rotation_with_its_velocity(supply: str) -> None:
    """Of a law without oil of its own; on 64 x 16 cells around and along, equal ones and finer ones at the gap."""
    mesh = "accuracy.mesh=[24, 64]"
    settings = (supply, TILT, "motion.eccentricity=0.3", mesh)
    found = moved("squeeze", "motion.periods=0.02", *settings)
    assert found.history is not None
    time, force, moment = (values[-1] for values in (found.history.time_s, found.history.force, found.history.moment))
    rate, c = 2.0 * math.pi * 50.0, 40e-6
    y, v = -0.3 * math.sin(rate * time), -0.3 * c * rate * math.cos(rate * time)
    still = one(case_of(*settings, f"motion.eccentricity={-y}", "motion.angle=-90 deg", f"motion.velocity=[0, {v}]"))
    assert still.loads is not None
    assert np.hypot(*(force - still.loads.force)) < 5e-3 * np.hypot(*force)
    assert np.hypot(*(moment - still.loads.moment)) < 1e-2 * np.hypot(*moment)


def test_moments_over_time_are_in_table_and_document() -> None:
    test = squeeze(case_of(*SHORT, TILT, "film.cavitation=half-sommerfeld"))
    (result,) = test.results
    assert result.history is not None
    assert test.to_pandas()["moment_x_N_m"].to_numpy() == pytest.approx(result.history.moment[:, 0], nan_ok=False)
    assert "moment_x_N_m" not in squeeze(case_of(*SHORT, "film.cavitation=half-sommerfeld")).to_pandas()


@pytest.mark.parametrize("test", TESTS)
def test_contact_at_an_end_on_the_way_is_refused_with_a_remedy_that_helps(test: str) -> None:
    """0.4 of the clearance and a slope that takes 0.75 of it at the ends: they touch on the way."""
    steep = f"motion.tilt=[{1.5 * 40e-6 / 0.012}, 0]"
    (fault,) = faults(case_of(*SHORT, steep), test)
    assert fault.key == "motion.tilt"
    share = float(re.search(r"at most ([0-9.]+) of", fault.remedy)[1])  # type: ignore[index]
    assert 0.5 < 0.75 * share < 0.6
    assert not faults(case_of(*SHORT, f"motion.tilt=[{1.5 * 40e-6 / 0.012 * share}, 0]"), test)


@pytest.mark.parametrize("cavitation", [name for name in names() if name != "peeken"])
@pytest.mark.parametrize("supply", [
    '{kind="axial-grooves", count=2, opening_angle="20 deg", pressure="2 bar"}',
    '{kind="bores", count=3, diameter="2 mm", axial_position=0.4, pressure="2 bar"}',
    '{kind="circumferential-groove", pressure="2 bar"}',
])  # fmt: skip
def test_every_law_and_supply(cavitation: str, supply: str) -> None:
    """A tilt pushes back: the moment of the film turns the journal against it, on the whole."""
    settings = (f"film.cavitation={cavitation}", f"bearing.supply={supply}", "accuracy.mesh=[8, 48]")
    result = one(case_of('motion.tilt=["1 mrad", "0 mrad"]', "motion.eccentricity=0.2", *settings))
    assert result.loads is not None
    assert np.hypot(*result.loads.moment) > 1e-3 * 0.012 * np.hypot(*result.loads.force)
    rate = one(case_of('motion.tilt_rate=["2 rad/s", "0 rad/s"]', "motion.eccentricity=0", *settings))
    assert rate.loads is not None
    assert rate.loads.moment[0] < 0.0
    if cavitation in ("sommerfeld", "elrod", "two-phase", "barotropic"):
        assert abs(result.loads.oil.defect_relative) < 1e-9


def test_contact_at_an_end_is_one_fault_whose_remedy_helps() -> None:
    with pytest.raises(InputError) as caught:
        rotation(case_of('motion.tilt=["6 mrad", "-3 mrad"]'))
    (fault,) = caught.value.faults
    assert fault.key == "motion.tilt"
    assert "closes the gap at the end z" in fault.problem
    share = float(re.search(r"at most ([0-9.]+) of", fault.remedy)[1])  # type: ignore[index]
    assert not faults(case_of(f"motion.tilt=[{6e-3 * share}, {-3e-3 * share}]"), "rotation")
    one(case_of(f"motion.tilt=[{6e-3 * share}, {-3e-3 * share}]"))
    with pytest.raises(InputError, match=r"bearing\.misalignment"):
        rotation(case_of('bearing.misalignment=["6 mrad", "0 mrad"]'))


@pytest.mark.parametrize(("analysis", "setting", "key"), [
    ("bearing sheet", TILT, "motion.tilt"),
    ("squeeze", 'motion.tilt_rate=["1 rad/s", "0 rad/s"]', "motion.tilt_rate"),
    ("whirl", 'motion.velocity=["1 mm/s", "0 mm/s"]', "motion.velocity"),
])  # fmt: skip
def test_refused_elsewhere(analysis: str, setting: str, key: str) -> None:
    case = case_of(setting, 'motion.frequency="50 Hz"')
    about = re.compile("tilt|misalignment|velocity")
    assert [fault.key for fault in faults(case, analysis) if about.search(fault.key)] == [key]


def test_refused_beside_what_does_not_know_it() -> None:
    loaded = CASE.replace("eccentricity = 0.4", 'load = "20 N"')
    assert "moment" in next(f.problem for f in faults(load_case_text(loaded, [TILT]), "rotation"))
    published = ("film.cavitation=two-phase", "film.two-phase.form=published", TILT)
    assert [fault.key for fault in faults(case_of(*published), "rotation")] == ["film.two-phase.form"]
    with pytest.raises(InputError, match="whirl_speed"):
        case_of('motion.velocity=["1 mm/s", "0 mm/s"]', 'motion.whirl_speed="3 Hz"')
