"""Rotations of a journal that tilts, and what is refused. Independent values: tests/data/tilted-journal.csv, by finite
volumes of another program, 360 x 120 and 180 x 60 cells extrapolated, exact to 1e-4 of the largest force or moment of a
row."""

from __future__ import annotations

import csv
import math
import re

import numpy as np
import pytest
from paths import DATA

from frbcli import load_case_text, rotation
from frbcli.bearing_tests.kinematic import KinematicResult
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.film.cavitation.table import names
from frbcli.scene.gate.gate import faults

ROWS = list(csv.DictReader((DATA / "tilted-journal.csv").read_text(encoding="utf-8").splitlines()))
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


@pytest.mark.parametrize("number", [1, 6, 10, 15])
def test_meshes_that_are_given(number: int) -> None:
    row = ROWS[number]
    for mesh, bound in ((FINE, 1e-3), (COARSE, 4e-3)):
        result = one(of_row(row, mesh))
        assert result.loads is not None
        for found, keys in ((result.loads.force, ("Fx_N", "Fy_N")), (result.loads.moment, ("Mx_Nm", "My_Nm"))):
            expected = np.array([float(row[key]) for key in keys])
            assert np.hypot(*(np.array(found) - expected)) < bound * np.abs(expected).max()


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


@pytest.mark.parametrize("cavitation", [name for name in names() if name != "peeken"])
@pytest.mark.parametrize("supply", [
    '{kind="none"}',
    '{kind="axial-grooves", count=2, opening_angle="20 deg", pressure="2 bar"}',
    '{kind="bores", count=3, diameter="2 mm", axial_position=0.4, pressure="2 bar"}',
    '{kind="circumferential-groove", pressure="2 bar"}',
])  # fmt: skip
def test_every_law_and_supply(cavitation: str, supply: str) -> None:
    """A tilt pushes back: the moment of the film turns the journal against it, on the whole."""
    settings = (f"film.cavitation={cavitation}", f"bearing.supply={supply}", "accuracy.mesh=[16, 64]")
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
    ("squeeze", TILT, "motion.tilt"),
    ("whirl", 'motion.velocity=["1 mm/s", "0 mm/s"]', "motion.velocity"),
    ("squeeze", 'bearing.misalignment=["0.1 mrad", "0 mrad"]', "bearing.misalignment"),
])  # fmt: skip
def test_refused_elsewhere(analysis: str, setting: str, key: str) -> None:
    case = case_of(setting, 'motion.frequency="50 Hz"')
    about = re.compile("tilt|misalignment|velocity")
    assert [fault.key for fault in faults(case, analysis) if about.search(fault.key)] == [key]


def test_refused_beside_what_does_not_know_it() -> None:
    loaded = CASE.replace("eccentricity = 0.4", 'load = "20 N"')
    assert "moment" in next(f.problem for f in faults(load_case_text(loaded, [TILT]), "rotation"))
    published = ("film.cavitation=two-phase", "film.two-phase.form=published", TILT)
    assert [fault.key for fault in faults(case_of(*published), "rotation")] == ["motion.tilt"]
    with pytest.raises(InputError, match="whirl_speed"):
        case_of('motion.velocity=["1 mm/s", "0 mm/s"]', 'motion.whirl_speed="3 Hz"')
