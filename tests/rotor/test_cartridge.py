"""Cartridges: one rigid ring over two journals, against closed forms, limits and two rings of their own."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from marches import march, planned_system, start, without_films
from scipy.linalg import expm

import frbcli
from frbcli.case.schema import Case
from frbcli.equilibrium.linearised import first_order, linearised
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.ring_speed import concentric_ratios
from frbcli.errors import InputError
from frbcli.linear.stability import stability_points
from frbcli.report.sketch import rotor_sketch
from frbcli.rotor.assembly import LinearRotor, Link, assembled, spin, tilting_mass, without_spins
from frbcli.rotor.loads import SpeedProfile, speed_profile
from frbcli.runs.run import runup
from frbcli.runs.start import state_at
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import System
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.state import Control

Array = np.ndarray

MASS, POLAR, TILT, LENGTH = 0.02, 3e-6, 2.5e-6, 0.03  # kg, kg m^2, m
STIFFNESS, TURN = 4e5, 2.0 * math.pi * 900.0  # N/m, rad/s
SPEED = 300.0  # Hz
OMEGA = 2.0 * math.pi * SPEED

GROOVE = 'supply = {kind = "circumferential-groove", pressure = "2 bar"}'
INNER = f'{{width = "5 mm", diameter = "10 mm", clearance = "20 um", {GROOVE}}}'
OUTER = f'{{width = "6 mm", diameter = "16 mm", clearance = "40 um", {GROOVE}}}'
RING = '{mass = "20 g", inertia = "0.7 kg*mm^2", tilt_inertia = "2.5 kg*mm^2"}'
ENDS = ("25 mm", "55 mm")
TWO_PLACES = 'bearing.positions=["20 mm", "60 mm"]'
SHAFT = (
    'rotor = {kind = "turbocharger", modes = 2}',
    'shaft = [{length = "80 mm", diameter = "10 mm"}]',
    'disk = [{position = "0 mm", mass = "30 g", polar_inertia = "3 kg*mm^2", diametral_inertia = "2 kg*mm^2"}]',
    "film.cavitation=sommerfeld",
    "film.theory=finite",
    f"speed.from={SPEED} Hz",
    f"speed.to={SPEED} Hz",
    "speed.duration=4 ms",
    "accuracy.mesh=[4, 32]",
    "accuracy.tolerance=1e-6",
    "output.step=0.1 ms",
)


def cartridge(*more: str, ring: str = RING, inner: str = INNER, outer: str = OUTER) -> Case:
    ends = ", ".join(f'"{place}"' for place in ENDS)
    films = f"inner = {inner}, outer = {outer}"
    bearing = f'bearing = {{kind = "cartridge", positions = [{ends}], ring = {ring}, {films}}}'
    return frbcli.load_case("jeffcott", [*SHAFT, bearing, *more])


def two_rings(*more: str, ring: str) -> Case:
    bearings = ", ".join(
        f'{{kind = "floating-ring", name = "{name}", position = "{place}", ring = {ring}, inner = {INNER}, '
        f"outer = {OUTER}}}"
        for name, place in zip(("left", "right"), ENDS, strict=True)
    )
    return frbcli.load_case("jeffcott", [*SHAFT, f"bearing = [{bearings}]", *more])


def on_springs(polar: float = POLAR) -> LinearRotor:
    """The body on equal springs at both ends, with the angle that it turns by."""
    body = tilting_mass(("left", "right"), MASS, TILT, LENGTH, 0.0)
    rotor = assembled([body, spin(polar)], [Link("left"), Link("right")])
    slope = np.zeros((2, 5))
    slope[0, [0, 2]] = slope[1, [1, 3]] = -1.0 / LENGTH, 1.0 / LENGTH
    stiffness = np.diag([STIFFNESS] * 4 + [0.0])
    return replace(rotor, stiffness=stiffness, cones=((4, math.sqrt(polar) * slope),))


def motion(rotor: LinearRotor) -> tuple[Array, Array]:
    """(N,) eigenvalues and (n, N) shapes of a machine without films."""
    nothing = np.zeros((len(rotor.journals), 2, 2))
    values, vectors = np.linalg.eig(first_order(*linearised(rotor, 0.0, nothing, nothing)))
    return values, vectors[: rotor.size]


# -------------------------------------------------------------------------------------------------------------- body


def test_a_body_on_springs_moves_and_whirls_as_in_closed_form() -> None:
    """Translation w^2 = 2 k / m; cones w^2 -+ w Omega I_p / I_t = k L^2 / (2 I_t), the forward one the faster."""
    values, shapes = motion(without_spins(on_springs(), np.array([TURN])))
    up = values.imag > 0.0
    frequencies, shapes = values.imag[up], shapes[:, up]
    split, square = 0.5 * TURN * POLAR / TILT, STIFFNESS * LENGTH**2 / (2.0 * TILT)
    forward, backward = (math.sqrt(split**2 + square) + sign * split for sign in (1.0, -1.0))
    translation = math.sqrt(2.0 * STIFFNESS / MASS)
    np.testing.assert_allclose(np.sort(frequencies), np.sort([translation, translation, forward, backward]), rtol=1e-9)
    cone = shapes[2:, np.argmin(np.abs(frequencies - forward))]
    assert cone[1] / cone[0] == pytest.approx(-1j)  # y follows x by a quarter: counter-clockwise, as it turns


def test_the_time_loop_follows_the_gyroscopic_moments() -> None:
    """The exact motion of a linear machine whose ring turns with a constant speed."""
    rotor, free = on_springs(), without_spins(on_springs(), np.array([TURN]))
    nothing = without_films(rotor)
    system = replace(nothing, ring_count=1, turning=np.zeros((2, 3, 2)), bodies=np.full((2, 2), -1))
    q, v = np.array([0.1, 0.0, -0.1, 0.0, 0.0]), np.array([0.0, 100.0, 0.0, 200.0, TURN])  # over shells 1 m away
    duration, step = 4e-3, 1e-4
    profile = speed_profile((0.0, duration), (OMEGA, OMEGA))
    limits = Control(1e-12, 1.0, 1e-3, step, 0.9999, 0.0)
    found = march(system, profile, limits, start(system, profile, q, v))
    generator = first_order(*linearised(free, 0.0, np.zeros((2, 2, 2)), np.zeros((2, 2, 2))))
    state = np.concatenate([q[:4], v[:4]])
    exact = np.array([(expm(generator * time) @ state)[:4] for time in found.times])
    assert np.abs(found.q[:, :4] - exact).max() < 1e-6 * np.abs(exact).max()
    still = motion_without(rotor, state, found.times)
    assert np.abs(still - exact).max() > 0.5 * np.abs(exact).max()
    np.testing.assert_allclose(found.v[:, 4], TURN)


def motion_without(rotor: LinearRotor, state: Array, times: Array) -> Array:
    """The same without gyroscopic moments."""
    other = without_spins(rotor, np.zeros(1))
    generator = first_order(*linearised(other, 0.0, np.zeros((2, 2, 2)), np.zeros((2, 2, 2))))
    return np.array([(expm(generator * time) @ state)[:4] for time in times])


# ---------------------------------------------------------------------------------------------------------- in films


@pytest.mark.nightly  # time loops of four tabulated films, which no other file has
def test_a_cartridge_whose_halves_are_not_connected_is_two_rings(tmp_path: Path) -> None:
    """Kept from turning, so that both rings turn alike: m L^2 / 4 is the inertia of two masses."""
    def body(tilt: float) -> str:
        return f'{{mass = "20 g", inertia = "0.7 kg*mm^2", tilt_inertia = "{tilt} kg*m^2", spin = "blocked"}}'

    apart = 0.25 * 0.02 * 0.03**2
    one = runup(cartridge(ring=body(apart)), tmp_path / "one.h5")
    other = runup(two_rings(ring='{mass = "10 g", inertia = "0.35 kg*mm^2", spin = "blocked"}'), tmp_path / "two.h5")
    assert one.status == other.status == "finished"
    for signal in ("eccentricity_left_inner", "eccentricity_right_outer", "ring_right_x_m", "journal_left_y_m"):
        scale = np.abs(other[signal]).max()
        assert scale > 0.0
        assert np.abs(one[signal] - other[signal]).max() < 1e-9 * scale
    joined = runup(cartridge(ring=body(apart / 3.0)), tmp_path / "joined.h5")
    away = np.abs(joined["ring_right_x_m"] - other["ring_right_x_m"]).max()
    assert away > 1e-3 * np.abs(other["ring_right_x_m"]).max()


def test_both_ends_turn_one_ring() -> None:
    """k_i (omega_R - omega_F) = k_o omega_F with the sums of both ends; each film has its own clearance here."""
    wide = INNER.replace("20 um", "30 um")
    case = cartridge("rotor.gravity=0", inner=f"[{INNER}, {wide}]")
    system = planned_system(case)
    left, outer, right, other = system.drags
    ratio = (left + right) / (left + right + outer + other)
    assert concentric_ratios(case) == pytest.approx({"left": ratio, "right": ratio})
    speeds = resting_position(system, OMEGA).ring_speeds
    assert speeds == pytest.approx([ratio * OMEGA])
    assert left / right == pytest.approx(1.5)


def test_both_ends_are_as_warm_as_two_rings() -> None:
    """Concentric, and alike at both ends: what the body of the cartridge joins plays no part."""
    heat = ('oil.viscosity={grade="SAE 10W-40"}', 'thermal={model="lumped", supply_temperature="70 degC"}')
    settings = ("rotor.gravity=0", "accuracy.mesh=[3, 16]", *heat)
    one = frbcli.warm_machine(cartridge(*settings))
    other = frbcli.warm_machine(two_rings(*settings, ring='{mass = "10 g", inertia = "0.35 kg*mm^2"}'))
    assert [ring.ring for ring in one.rings] == ["left", "right"]
    np.testing.assert_allclose(one.steady.temperatures, other.steady.temperatures, rtol=1e-9)
    assert one.rings[0].speed_ratio == pytest.approx(one.rings[1].speed_ratio)
    assert one.rings[0].inner > 343.15 + 1.0


@pytest.mark.nightly  # time loops of four tabulated films, which no other file has
def test_small_motions_decay_and_grow_as_the_eigenvalues_say() -> None:
    """Each motion of the linearised machine that the gyroscopic moments of the ring change, beside a run from it."""
    case = cartridge("rotor.gravity=0", ring=RING.replace('inertia = "0.7', 'inertia = "4.5'))
    system, (point,) = planned_system(case), stability_points(case, [SPEED])[1]
    rest = resting_position(system, OMEGA)
    rotor, still = (without_spins(system.rotor, share * rest.ring_speeds) for share in (1.0, 0.0))
    films = [-np.array([getattr(film, name) for film in rest.films]) for name in ("by_displacement", "by_velocity")]
    values, vectors = np.linalg.eig(first_order(*linearised(rotor, OMEGA, *films)))
    others = np.linalg.eigvals(first_order(*linearised(still, OMEGA, *films)))
    apart = np.abs(values[:, None] - others).min(axis=1) / np.abs(values)
    worth = (values.imag > 0.0) & (np.abs(values.real) < values.imag)
    mode = int(np.argmax(np.where(worth, apart, 0.0)))
    value, shape = complex(values[mode]), vectors[: rotor.size, mode]
    assert np.abs(point.eigenvalues - value).min() < 1e-3 * abs(value)
    found, times = from_mode(system, rest.displacements, rest.velocities(system), value, shape)
    expected = np.real(np.outer(np.exp(value * times), shape))
    size = np.abs(expected).max()
    assert np.abs(found - expected).max() < 1e-3 * size
    nearest = others[np.argmin(np.abs(others - value))]
    assert np.abs(np.real(np.outer(np.exp(nearest * times), shape)) - expected).max() > 0.05 * size


def from_mode(system: System, q: Array, v: Array, value: complex, shape: Array) -> tuple[Array, Array]:
    """Displacements (k, n) beside rest, but for the angle of the ring, and times of a run that begins in a motion; the
    shape becomes that of 1e-4 of the clearance."""
    shape *= 1e-4 * system.clearances[0] / np.abs(system.rotor.journals[:, :, :-1] @ shape).max()
    duration = 4.0 * 2.0 * math.pi / value.imag
    profile: SpeedProfile = speed_profile((0.0, duration), (OMEGA, OMEGA))
    beside, rate = np.append(np.real(shape), 0.0), np.append(np.real(value * shape), 0.0)
    limits = Control(1e-9, 60.0, 1e-3, duration / 50.0, 0.9999, 0.0)
    run = march(system, profile, limits, state_at(system, profile, q + beside, v + rate))
    return run.q[:, :-1] - q[:-1], run.times


# -------------------------------------------------------------------------------------------------------------- case


@pytest.mark.parametrize(
    ("setting", "key", "problem", "remedy"),
    [
        ('bearing.positions=["25 mm", "90 mm"]', "bearing.positions.1", "not on the shaft", TWO_PLACES),
        ('bearing.positions=["55 mm", "25 mm"]', "bearing.positions", "descend", TWO_PLACES),
        ('bearing.ring={mass="20 g", inertia="1 kg*mm^2"}', "bearing.ring.tilt_inertia", "is missing",
         "bearing.ring.tilt_inertia=1 kg*mm^2"),
        ('bearing.ring={inertia="1 kg*mm^2", tilt_inertia="1 kg*mm^2"}', "bearing.ring.mass", "is missing",
         "bearing.ring.mass=9 g"),
        ("bearing.ring.tilt_inertia=0.3 kg*mm^2", "bearing.ring.tilt_inertia", "less than half",
         "bearing.ring.tilt_inertia=0.35 kg*mm^2"),
        ("bearing.ring.width=40 mm", "bearing.ring.width", "has no effect", None),
    ],
)  # fmt: skip
def test_faults_of_a_cartridge(setting: str, key: str, problem: str, remedy: str | None) -> None:
    with pytest.raises(InputError) as refused:
        cartridge(setting)
    (fault,) = refused.value.faults
    assert (fault.key, problem in fault.problem) == (key, True)
    assert fault.remedy
    if remedy is not None:
        cartridge(setting, remedy)


def test_symmetric_rotors_do_not_tilt() -> None:
    with pytest.raises(InputError, match="does not tilt around a rigid rotor"):
        cartridge('rotor = {kind = "rigid", mass = "1 kg"}', "shaft=[]", "disk=[]")


def test_what_is_not_modelled_is_refused_once() -> None:
    coupled = 'bearing.inner.supply={kind="bores", count=4, diameter="1 mm", pressure="2 bar"}', "film.tilt=follows"
    with pytest.raises(InputError) as refused:
        make_plan(cartridge("bearing.channels=coupled", *coupled))
    assert [fault.key for fault in refused.value.faults] == ["bearing.channels"]


def test_text_and_keys_of_a_cartridge() -> None:
    case = cartridge()
    assert frbcli.load_case_text(case.source_text) == case
    other = case.with_settings({"bearing.name": "core", "bearing.inner.clearance": "25 um"})
    assert [bearing.name for bearing in other.bearings] == ["core_left", "core_right"]
    assert [film.clearance for film in other.films] == [25e-6, 40e-6] * 2
    rings = [name for name, _ in make_rotor(other).points if name.startswith("ring")]
    assert rings == ["ring_core_left", "ring_core_right"]
    films = [*case.films[:2], *other.films[2:]]
    assert case.with_films(films).films == tuple(films)
    drawn = re.findall(r'width="([0-9.]+)" height="[0-9.]+" class="(ring|shell)"', rotor_sketch(case)[0])
    ring, shell = ({float(width) for width, kind in drawn if kind == asked} for asked in ("ring", "shell"))
    assert max(ring) == pytest.approx(30.0 / 6.0 * max(shell), rel=1e-3)  # from the middle of one end to the other
