"""Turbocharger rotors: natural frequencies, the reduced rotor as a whole, and floating rings."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Frb
from scipy.optimize import brentq
from test_beam import transfer

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.case.schema import Case
from frbcli.equilibrium.linearised import RestingFilm
from frbcli.errors import InputError
from frbcli.linear.modes import direct_springs, film_springs, natural_modes
from frbcli.linear.stability_point import eigenvalues
from frbcli.plot.machine.modes import modes_figure
from frbcli.rotor.assembly import Body, LinearRotor, Link, assembled, jeffcott_rotor, point_mass, without_spins
from frbcli.rotor.beam import BeamSection
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.turbocharger import shaft_of

GRAVITY = 9.81
SPRING = 5e6


@pytest.fixture(scope="module")
def heavy() -> Case:
    return load_case("turbocharger-heavy")


def exact_whirl(case: Case, spring: float, speed_Hz: float, near_Hz: float) -> float:
    """Forward whirl in Hz of the unreduced rotor on springs, by transfer matrices of (v, psi, moment, shear force)."""
    spin = 2 * math.pi * speed_Hz
    ends = np.cumsum([0.0, *(section.length for section in case.shaft)])
    places = sorted({*ends, *(d.position for d in case.disks), *(b.position or 0.0 for b in case.bearings)})
    places = [a for a, b in zip(places, [*places[1:], math.inf], strict=True) if b - a > 1e-9]

    def determinant(omega: float) -> float:
        whole = np.eye(4)
        for place, following in zip(places, [*places[1:], None], strict=True):
            station = np.eye(4)
            for disk in case.disks:
                if math.isclose(disk.position, place, abs_tol=1e-9):
                    station[2, 1] -= disk.diametral_inertia * omega**2 - disk.polar_inertia * spin * omega
                    station[3, 0] -= disk.mass * omega**2
            for bearing in case.bearings:
                if math.isclose(bearing.position or 0.0, place, abs_tol=1e-9):
                    station[3, 0] += spring
            whole = station @ whole
            if following is None:
                break
            part = case.shaft[int(np.searchsorted(ends, 0.5 * (place + following))) - 1]
            material = part.density, part.youngs_modulus, part.poisson_ratio
            whole = transfer(BeamSection(following - place, part.diameter, 0.0, *material), omega, spin) @ whole
        return float(np.linalg.det(whole[2:, :2]))

    root = brentq(determinant, 2 * math.pi * near_Hz * 0.99, 2 * math.pi * near_Hz * 1.01)
    return float(root) / (2 * math.pi)


# -------------------------------------------------------------------------------------------- natural frequencies


def test_heavy_turbocharger_free(heavy: Case) -> None:
    """An independent program has 5.99 kg and free bending modes at 619 and 1118 Hz."""
    found = natural_modes(heavy, None, [0.0])
    assert found.mass_kg == pytest.approx(5.99, abs=0.005)
    assert found.free_Hz[:2] == pytest.approx([619.0, 1118.0], rel=0.002)
    assert {mode.kind for mode in found.points[0].modes} == {"bending"}
    assert found.free_Hz[:4] == pytest.approx([mode.frequency_Hz for mode in found.points[0].directed("forward")])


@pytest.mark.parametrize("speed", [0.0, 350.0, 1200.0])
def test_heavy_turbocharger_on_springs_against_transfer_matrices(heavy: Case, speed: float) -> None:
    forward = natural_modes(heavy, SPRING, [speed]).points[0].directed("forward")
    assert [mode.kind for mode in forward[:3]] == ["conical", "cylindrical", "bending"]
    for mode in forward[:3]:
        assert mode.frequency_Hz == pytest.approx(exact_whirl(heavy, SPRING, speed, mode.frequency_Hz), rel=2e-6)


def test_car_turbocharger_weighs_100_g() -> None:
    assert natural_modes(load_case("turbocharger-car"), None, [0.0]).mass_kg == pytest.approx(0.1, rel=1e-3)


def test_modes_table_and_faults(heavy: Case) -> None:
    table = natural_modes(heavy, SPRING, [0.0, 350.0]).to_pandas()
    assert list(table.columns) == ["speed_Hz", "frequency_Hz", "direction", "kind"]
    assert len(table) == 16
    for stiffness, speeds in ((0.0, [1.0]), (math.inf, [1.0]), (1e6, []), (1e6, [-1.0]), (1e6, [math.nan])):
        with pytest.raises(InputError):
            natural_modes(heavy, stiffness, speeds)


@pytest.mark.parametrize("stiffness", [None, SPRING])
def test_picture_of_the_modes(heavy: Case, stiffness: float | None) -> None:
    figure = modes_figure(natural_modes(heavy, stiffness, [0.0, 600.0, 1200.0]))
    campbell, *shapes = figure.axes
    assert campbell.get_xlim() == (0.0, 1200.0)
    assert len(shapes) == 4
    assert all(axes.lines for axes in shapes)


# ---------------------------------------------------------------------------------------------------- whole rotor


def whole(case: Case) -> LinearRotor:
    """Without the angles of the two rings."""
    return without_spins(make_rotor(case), np.zeros(2))


def test_cutoff_keeps_the_modes_below_it() -> None:
    low = load_case("turbocharger-heavy", ["rotor={kind='turbocharger', cutoff='1.2 kHz'}"])
    assert whole(low).size == 2 * 4 + 2 * 2  # translation, tilt, 619 and 1120 Hz
    rigid = load_case("turbocharger-heavy", ["rotor={kind='turbocharger', cutoff='1 Hz'}"])
    assert whole(rigid).size == 2 * 2 + 2 * 2
    with pytest.raises(InputError, match="with modes"):
        load_case("turbocharger-heavy", ["rotor.cutoff=2 kHz"])


def test_films_carry_the_weights_and_no_moment(heavy: Case) -> None:
    """At rest on springs: inner films the rotor, outer ones the rings as well; moments about the bearings balance."""
    rotor = whole(heavy)
    stiffness = rotor.stiffness + 1e7 * np.einsum("fki,fkj->ij", rotor.journals, rotor.journals)
    forces = -1e7 * (rotor.journals @ np.linalg.solve(stiffness, rotor.static_load))
    mass = natural_modes(heavy, None, [0.0]).mass_kg
    assert forces[:, 0] == pytest.approx(np.zeros(4), abs=1e-9)
    inner, outer = forces[::2, 1], forces[1::2, 1]
    assert inner.sum() == pytest.approx(mass * GRAVITY, rel=1e-9)
    assert outer - inner == pytest.approx([0.075 * GRAVITY] * 2, rel=1e-6)
    masses = [(d.mass, d.position) for d in heavy.disks]
    start = 0.0
    for part in heavy.shaft:
        masses.append((part.density * math.pi / 4 * part.diameter**2 * part.length, start + part.length / 2))
        start += part.length
    moment = GRAVITY * sum(mass * place for mass, place in masses)
    assert inner @ [0.08, 0.185] == pytest.approx(moment, rel=1e-9)


def test_unbalance_turns_with_the_rotor() -> None:
    """At constant speed: U omega^2 in the direction of the eccentric mass; upwards for an angle and a phase of 0."""
    case = load_case("turbocharger-heavy", ["disk.1.unbalance=0 g*mm", "disk.2.phase=30 deg"])
    rotor, modes = whole(case), shaft_of(case).free().modes.lowest(6)
    alpha, omega, unbalance, phase = 0.7, 100.0, 2e-6, math.pi / 6
    force = -(omega**2) * (rotor.unbalance_cos * math.sin(alpha) - rotor.unbalance_sin * math.cos(alpha))
    direction = np.array([-math.sin(alpha + phase), math.cos(alpha + phase)])
    assert force[:12] == pytest.approx(unbalance * omega**2 * np.kron(direction, modes.at(0.224)))
    assert not force[12:].any()


def test_reduced_rotor_whirls_as_the_whole_one(heavy: Case) -> None:
    """Eigenvalues of the linear rotor with single films of stiffness s, undamped, are those of the free modes."""
    text = heavy.source_text
    assert 'kind = "floating-ring"' in text
    case = load_case("turbocharger-heavy", ["rotor.modal_damping=0", "bearing=" + SINGLE])
    rotor = make_rotor(case)
    assert rotor.journals.shape == (2, 2, 12)
    omega = 2 * math.pi * 350
    springs, none = np.tile(SPRING * np.eye(2), (2, 1, 1)), np.zeros((2, 2, 2))
    found = eigenvalues(rotor, omega, springs, none)
    assert np.max(np.abs(found.real)) < 1e-6 * np.max(np.abs(found.imag))
    pairs = np.sort(found.imag[found.imag > 0])[:6] / (2 * math.pi)
    exact = sorted(mode.frequency_Hz for mode in natural_modes(case, SPRING, [350.0]).points[0].modes)[:6]
    assert pairs == pytest.approx(exact, rel=2e-3)


SINGLE = "[" + ", ".join(
    f"{{kind='single-film', name='{z}', position='{z} mm', width='20 mm', diameter='25 mm', clearance='40 um'}}"
    for z in (80, 185)
) + "]"  # fmt: skip


def test_damping_is_modal_and_external(heavy: Case) -> None:
    rotor = whole(heavy)
    frequencies = np.sqrt(np.diag(rotor.stiffness))[:6]
    assert np.diag(rotor.damping)[:6] == pytest.approx(2 * 0.002 * frequencies)
    outside = whole(load_case("turbocharger-heavy", ["rotor.external_damping=2 N*s/m"]))
    places = np.stack([place[0] for name, place in rotor.points if name.startswith("disk")])
    assert (outside.damping - rotor.damping)[:6, :6] == pytest.approx(2.0 * (places.T @ places)[:6, :6])


# ---------------------------------------------------------------------------------------------------------- rings


def jeffcott() -> Body:
    """Table 7.1."""
    return jeffcott_rotor(5.0, 1.0, 2e7, 3e-6, 1.0, 0.1, GRAVITY)


def on_shell() -> LinearRotor:
    return assembled([jeffcott()], [Link("journal", count=2.0)])


def on_rings(mass: float) -> LinearRotor:
    """mass in kg, of one ring."""
    ring = point_mass("ring", 2.0 * mass, GRAVITY)
    return assembled([jeffcott(), ring], [Link("journal", "ring", 2.0), Link("ring", count=2.0)])


def test_a_light_ring_puts_films_in_series() -> None:
    inner, outer = 2e6, 3e6
    springs = np.stack([inner * np.eye(2), outer * np.eye(2)])
    ringed = eigenvalues(on_rings(1e-9), 100.0, springs, 0 * springs)
    series = np.eye(2)[None] / (1 / inner + 1 / outer)
    single = eigenvalues(on_shell(), 100.0, series, 0 * series)
    assert ringed[: len(single)] == pytest.approx(single, rel=1e-6)


def test_warm_films_of_the_heavy_turbocharger(heavy: Case) -> None:
    """(4.24) with the oil temperatures of section 7.3, by an independent program, in um."""
    films = [b for b in heavy.bearings if isinstance(b, FloatingRingBearing)]
    assert [b.inner.clearance * 1e6 for b in films] == pytest.approx([39.6, 39.8], abs=0.05)
    assert [b.outer.clearance * 1e6 for b in films] == pytest.approx([51.9, 49.1], abs=0.06)


# --------------------------------------------------------------------------------------------------------- command


def test_springs_of_films_at_rest(heavy: Case) -> None:
    films = [
        RestingFilm(np.zeros(2), 0.0, np.array([[k, 9e9], [-9e9, 3 * k]]), np.eye(2)) for k in (1e6, 2e6, 4e6, 4e6)
    ]
    assert film_springs(heavy, films) == pytest.approx((1 / (1 / 2e6 + 1 / 4e6), 4e6))
    centred = [replace(films[0], stiffness=np.array([[0.0, 9e9], [-9e9, 0.0]])), *films[1:]]
    assert film_springs(heavy, centred) == ()
    assert direct_springs(heavy, centred) == pytest.approx((np.nan, 4e6), nan_ok=True)
    with pytest.raises(InputError, match="as many as bearings"):
        natural_modes(heavy, [1e6, 1e6, 1e6])
    unequal = natural_modes(heavy, film_springs(heavy, films), [0.0])
    assert unequal.stiffness_N_m == pytest.approx((4e6 / 3, 4e6))


def test_command_with_a_stiffness(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    call = ["stability", "turbocharger-heavy", "--modes", "5e6 N/m", "--speed", "350 Hz", "--json"]
    said = frb(*call)
    document = json.loads(said.out)
    free, held = document["natural_frequencies"]
    assert free["free_bending_Hz"][0] == pytest.approx(619.0, rel=1e-3)
    assert (held["stiffness_N_m"], held["points"][0]["speed_Hz"]) == ([5e6, 5e6], pytest.approx(350.0))
    assert {"frequency_Hz", "direction", "kind"} == set(held["points"][0]["modes"][0])
    assert held["reduction"]["modes"] == 6
    text = frb(*call[:-1]).out
    assert "bending modes of 619.3, 1120, 2850 Hz" in text
    assert max(map(len, text.splitlines())) <= 80
    assert (tmp_path / "turbocharger-heavy-modes.png").read_bytes().startswith(b"\x89PNG")


def test_one_option_has_the_modes_of_any_rotor(frb: Frb) -> None:
    """Closed forms: sqrt(2 k / m) of a rigid rotor, two masses and springs in a row of a Jeffcott rotor, at 0 Hz."""
    rigid, jeffcott = load_case("rigid").rotor, load_case("jeffcott").rotor
    k = 1e6
    m, j, c = jeffcott.mass, jeffcott.journal_mass, jeffcott.shaft_stiffness  # type: ignore[union-attr]
    row = np.sort(np.roots([m * j, -(m * (c + 2 * k) + j * c), 2 * k * c]))
    exact = {"rigid": [2 * k / rigid.mass], "jeffcott": row.tolist()}  # type: ignore[union-attr]
    for name, squares in exact.items():
        said = frb("stability", name, "--no-picture", "--modes", "1e6 N/m", "--speed", "0 Hz", "--json")
        _, held = said.document["natural_frequencies"]
        found = [mode["frequency_Hz"] for mode in held["points"][0]["modes"] if mode["direction"] == "forward"]
        assert found == pytest.approx(np.sqrt(squares) / (2 * math.pi), rel=1e-9)
    free, _ = frb("stability", "jeffcott", "--no-picture", "--modes", "free", "--json").document["natural_frequencies"]
    assert free["free_bending_Hz"] == pytest.approx([math.sqrt(c * (1 / m + 1 / j)) / (2 * math.pi)], rel=1e-9)


def test_rings_of_a_free_rotor_are_apart(frb: Frb) -> None:
    said = frb("stability", "turbocharger-heavy", "--no-picture", "--modes", "free", "--speed", "0 Hz")
    told = " ".join(said.out.split())
    assert "4 rigid-body motions of 0 Hz, and its 2 rings are apart" in told


def test_bearings_of_given_coefficients_are_springs_of_the_modes() -> None:
    def rigid(stiffness: Any) -> Case:
        tables = {
            "rotor": {"kind": "rigid", "mass": "4 kg"},
            "bearing": {"kind": "coefficients", "stiffness": stiffness},
            "speed": {"from": "0 Hz", "to": "100 Hz", "duration": "1 s"},
        }
        return case_from_dict(tables, "rigid")

    with_own = rigid("3e6 N/m")
    for stiffness, spring in (("bearings", 3e6), (5e6, 5e6)):
        (mode, _) = natural_modes(with_own, stiffness, [0.0]).points[0].modes  # type: ignore[arg-type]
        assert mode.frequency_Hz == pytest.approx(math.sqrt(2 * spring / 4.0) / (2 * math.pi), rel=1e-12)
    unequal = rigid([["3e6 N/m", 0], [0, "1e6 N/m"]])
    with pytest.raises(InputError, match="differs with the direction"):
        natural_modes(unequal, "bearings")
    with pytest.raises(InputError, match="films"):
        natural_modes(load_case("jeffcott"), "bearings")
