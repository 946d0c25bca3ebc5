"""Films on pads: closed forms, derivatives, balances, symmetries, their table over the gap, and tapered-land bearings
against an independent finite-volume program."""

import math
from dataclasses import replace

import numpy as np
import pytest
from differences import differences
from paths import rows_of
from scipy.sparse import csr_matrix

from frbcli.case.reading.load import case_from_dict
from frbcli.case.schema import Case
from frbcli.film.pad_geometry import MESH, Pad, Profile
from frbcli.film.pads import (
    AT_REST,
    PadFilm,
    PadMesh,
    PadOil,
    RunnerMotion,
    gap_table,
    pad_film,
    pad_mesh,
    ring_of_pads,
)
from frbcli.linear.sheets.thrust import thrust_sheet

PAD = Pad(5e-3, 11e-3, math.radians(75.0), math.radians(50.0), 20e-6)
VISCOSITY, OMEGA, LAND = 8e-3, 2.0 * math.pi * 2000.0, 15e-6


def film(pad: Pad = PAD, motion: RunnerMotion = AT_REST, law: str = "sommerfeld", land: float = LAND) -> PadFilm:
    mesh = pad_mesh(pad, 8, 16)
    return pad_film(mesh, land + pad.depth(mesh.theta), PadOil(VISCOSITY, law), OMEGA, motion)


def slider_load(taper: float, share: float, profile: Profile) -> float:
    """W h0^2 / (eta U B^2 L) of an infinitely wide slider: by narrow pads of two widths at a large radius, whose
    difference has no ends."""
    length, radius, loads = 1.0, 1e4, []
    for width in (8.0, 12.0):
        angle = length / radius
        pad = Pad(radius - 0.5 * width, radius + 0.5 * width, angle, share * angle, taper * 1e-4, profile)
        mesh = pad_mesh(pad, 48, 16)
        found = pad_film(mesh, 1e-4 + pad.depth(mesh.theta), PadOil(1.0, "sommerfeld"), 1.0 / radius)
        loads.append(found.forces[0])
    return (loads[1] - loads[0]) / 4.0 * 1e-8


def test_a_wide_plane_slider_has_the_load_of_the_closed_form() -> None:
    """0.16024 at a ratio of the gaps of 2.189, the largest of all."""
    assert slider_load(1.189, 1.0, "taper") == pytest.approx(0.16024, rel=1e-4)
    assert slider_load(1.0, 1.0, "taper") < 0.16024 > slider_load(1.4, 1.0, "taper")


def test_a_wide_step_has_the_load_of_rayleigh() -> None:
    """0.20627 at a ratio of the gaps of 1.866 and a step at 0.718 of the length."""
    assert slider_load(0.866, 0.718, "step") == pytest.approx(0.20627, rel=1e-4)


def disc(radius: float) -> PadMesh:
    """A disc without grooves and with a hole that oil does not pass: both ends of the sector are one, and the pressure
    is given at the outer radius alone."""
    mesh = pad_mesh(Pad(1e-3 * radius, radius, 2.0 * math.pi, math.pi, 0.0), 24, 32)
    order = np.arange(mesh.nodes.shape[1])
    by_radius = {round(float(mesh.nodes[1, i]), 15): i for i in mesh.leading}
    order[mesh.trailing] = [by_radius[round(float(mesh.nodes[1, i]), 15)] for i in mesh.trailing]
    count = len(order)
    merged = csr_matrix((np.ones(count), (np.arange(count), order)), shape=(count, count))
    kept = np.setdiff1d(np.arange(count), mesh.trailing)
    free = kept[mesh.nodes[1, kept] < radius * (1.0 - 1e-9)]
    return replace(mesh, value=mesh.value @ merged, slope_theta=mesh.slope_theta @ merged,
                   slope_r=mesh.slope_r @ merged, free=free)  # fmt: skip


def test_a_disc_in_tilt_has_the_damping_of_the_closed_form() -> None:
    """pi eta R^6 / (8 h^3) in tilt, 3 pi eta R^4 / (2 h^3) in translation."""
    radius, gap = 10e-3, 20e-6
    mesh = disc(radius)
    found = pad_film(mesh, np.full_like(mesh.r, gap), PadOil(VISCOSITY, "sommerfeld"), 0.0)
    tilt = math.pi * VISCOSITY * radius**6 / (8.0 * gap**3)
    np.testing.assert_allclose(found.damping[1:, 1:], tilt * np.eye(2), rtol=1e-4, atol=1e-6 * tilt)
    axial = 1.5 * math.pi * VISCOSITY * radius**4 / gap**3
    assert found.damping[0, 0] == pytest.approx(axial, rel=1e-4)


TILTED = RunnerMotion((1e-6, 4e-4, -3e-4), (2e-3, 1.0, 0.5), 0.4)
DIVERGING = RunnerMotion((0.0, 3e-3, 0.0), (2e-3, 1.0, 0.5))  # the gap grows behind a part of the taper


@pytest.mark.parametrize(("law", "motion"), [
    ("sommerfeld", TILTED), ("sommerfeld", DIVERGING), ("reynolds", DIVERGING), ("half-sommerfeld", DIVERGING),
])  # fmt: skip
def test_stiffness_and_damping_are_the_derivatives_of_forces_and_moments(law: str, motion: RunnerMotion) -> None:
    found = film(motion=motion, law=law)
    small = 1e-3 if law == "half-sommerfeld" else 1.0  # so that no point of integration passes the cut
    for part, matrix, sizes in (("displacement", found.stiffness, (1e-10, 1e-8, 1e-8)),
                                ("rate", found.damping, (1e-5, 1e-3, 1e-3))):  # fmt: skip
        scale = np.array([[1.0], [100.0], [100.0]])  # of forces and moments

        def forces(values: np.ndarray, part: str = part) -> np.ndarray:
            return film(motion=replace(motion, **{part: tuple(values)}), law=law).forces

        numeric = -scale * differences(forces, getattr(motion, part), small * np.array(sizes))
        assert np.all(np.abs(scale * matrix - numeric) <= 1e-6 * np.abs(numeric).max(axis=0))


@pytest.mark.parametrize("motion", [RunnerMotion(), TILTED])
def test_oil_balances_to_round_off(motion: RunnerMotion) -> None:
    found = film(motion=motion)
    out = found.inner_flow + found.outer_flow + found.trailing_flow
    assert found.leading_flow - out == pytest.approx(found.swept, abs=1e-13 * abs(found.leading_flow))
    assert (found.swept != 0.0) == (motion is TILTED)


@pytest.mark.parametrize("pads", [2, 4])
def test_a_ring_of_pads_is_the_sum_of_its_pads(pads: int) -> None:
    """Each of them solved where it stands."""
    ring = ring_of_pads(film(), pads)
    each = [film(motion=RunnerMotion(phase=2.0 * math.pi * k / pads)) for k in range(pads)]
    for name in ("forces", "stiffness", "damping", "torque", "inner_flow", "leading_flow"):
        whole = np.sum([getattr(one, name) for one in each], axis=0)
        tolerance = 1e-11 * np.abs(whole).max()
        np.testing.assert_allclose(getattr(ring, name), whole, rtol=1e-10, atol=tolerance)


def test_without_tilt_there_is_no_moment() -> None:
    ring = ring_of_pads(film(), 2)
    assert np.abs(ring.forces[1:]).max() < 1e-12 * ring.forces[0] * PAD.outer_radius
    one = film()
    assert abs(one.forces[1]) > 0.1 * one.forces[0] * PAD.inner_radius  # one pad alone has


def test_a_cavity_by_reynolds_keeps_the_pressure_and_takes_no_tension() -> None:
    full, half, reynolds = (film(motion=DIVERGING, law=law) for law in ("sommerfeld", "half-sommerfeld", "reynolds"))
    assert full.pressure.min() < -1e4
    assert half.pressure.min() == reynolds.pressure.min() == 0.0
    assert full.forces[0] < reynolds.forces[0]
    assert 0.0 < half.forces[0] < reynolds.forces[0]


# Of a step a hundred times as deep as the thinnest gap, round-off is 1.5e-8 of the stiffness across a tilt there, by
# mobilities in the ratio of 1e6; polynomials spread it over all gaps. At 1e-7 m it would be 3e-7.
THIN, WIDE, PADS = 2e-7, 2e-3, 4


@pytest.mark.parametrize("profile", ["taper", "step"])
def test_table_is_the_film_at_any_speed_and_viscosity(profile: Profile) -> None:
    pad = Pad(5e-3, 11e-3, math.radians(75.0), math.radians(50.0), 20e-6, profile)
    table, mesh, eta, omega = gap_table(pad, PADS, THIN, WIDE), pad_mesh(pad, *MESH), 8e-3, 2.0 * math.pi * 2000.0
    for gap in (2.7e-7, 6.1e-6, 3.3e-5, 9e-4):
        film = ring_of_pads(pad_film(mesh, gap + pad.depth(mesh.theta), PadOil(eta), omega), PADS)
        scaled = table.at(gap)
        assert eta * omega * scaled.load == pytest.approx(film.forces[0], rel=1e-7)
        assert eta * omega * scaled.torque == pytest.approx(film.torque, rel=1e-7)
        assert omega * scaled.side_flow == pytest.approx(film.inner_flow + film.outer_flow, rel=1e-7)
        assert eta * omega * scaled.stiffness == pytest.approx(film.stiffness[0, 0], rel=1e-7)
        assert eta * scaled.damping == pytest.approx(film.damping[0, 0], rel=1e-7)
        tilt = film.stiffness[1:, 1:]
        assert eta * omega * scaled.tilt_stiffness == pytest.approx(tilt, abs=1e-7 * np.abs(tilt).max())
        assert eta * scaled.tilt_damping == pytest.approx(film.damping[1:, 1:], abs=1e-7 * film.damping[1, 1])
        assert film.pressure.min() >= 0.0  # else films would not scale with speed and viscosity


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
