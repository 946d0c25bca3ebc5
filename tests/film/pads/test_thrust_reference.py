"""Two tapered-land bearings against an independent finite-volume program (cells 120 x 300, extrapolated; its error is
3e-4): tests/data/thrust-tapered-land.csv."""

from __future__ import annotations

import numpy as np
import pytest
from paths import rows_of

from frbcli.case.reading.load import case_from_dict
from frbcli.case.schema import Case
from frbcli.linear.sheets.thrust import thrust_sheet

REFERENCE_ERROR = 3e-4
ROWS = rows_of("thrust-tapered-land.csv")
# pads, taper in um, angle of the taper in deg, radii in mm, angle of a pad in deg, viscosity in Pa s, speed in Hz
BEARINGS = {"A": (4, 20.0, 50.0, 5.0, 11.0, 75.0, 8e-3, 2000.0), "B": (6, 40.0, 40.0, 15.0, 30.0, 50.0, 12e-3, 600.0)}


def case_of(name: str) -> Case:
    pads, taper, taper_angle, inner, outer, angle, viscosity, _ = BEARINGS[name]
    return case_from_dict({
        "oil": {"viscosity": viscosity},
        "thrust_bearing": [{
            "side": "left", "pads": pads, "taper": f"{taper} um", "taper_angle": f"{taper_angle} deg",
            "inner_radius": f"{inner} mm", "outer_radius": f"{outer} mm", "pad_angle": f"{angle} deg",
        }],
    })  # fmt: skip


def printed(row: dict[str, str]) -> dict[str, float]:
    return {key: float(value) for key, value in row.items() if key != "case"}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['case']} {row['h0_um']} um")
def test_the_planned_mesh_is_within_its_stated_error(row: dict[str, str]) -> None:
    known = printed(row)
    case, speed = case_of(row["case"]), BEARINGS[row["case"]][-1]
    (state,) = thrust_sheet(case, [1e-6 * known["h0_um"]], [speed]).points
    assert state.load == pytest.approx(known["load_N"], rel=state.load_error + REFERENCE_ERROR)
    assert state.load_error < 1e-3
    allowed = state.coefficient_error + REFERENCE_ERROR
    assert state.stiffness == pytest.approx(known["k_zz_N_m"], rel=allowed)
    assert state.damping == pytest.approx(known["c_zz_Ns_m"], rel=allowed)
    direct, cross = known["k_tilt_Nm_rad"], known["k_tilt_cross_Nm_rad"]
    np.testing.assert_allclose(state.tilt_stiffness, [[direct, -cross], [cross, direct]], atol=allowed * direct)
    c = known["c_tilt_Nms_rad"]
    np.testing.assert_allclose(state.tilt_damping, c * np.eye(2), rtol=0, atol=allowed * c)
    assert state.coefficient_error < 2e-3
    for found, name in ((state.torque, "torque_Nm"), (state.flow_inner, "q_inner_m3_s"),
                        (state.flow_outer, "q_outer_m3_s"), (state.flow_leading, "q_leading_m3_s"),
                        (state.p_max - 1e5, "p_max_Pa")):  # fmt: skip
        assert found == pytest.approx(known[name], rel=2e-3), name
