"""Floating rings whose films follow their tilt: closed forms, balances, limits, and runs beside eigenvalues."""

import math
from dataclasses import replace

import numpy as np
import pytest
from differences import differences
from marches import DIAMETRAL, LENGTH, POLAR, RHO, D, flat_films, march, planned_system, rigid_shaft, seen_between

import frbcli
from frbcli.case.schema import Case
from frbcli.cycles.shooting.period_map import period_map
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting
from frbcli.equilibrium.linearised import first_order, linearised
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.ring_speed import ring_torques
from frbcli.equilibrium.static_films import static_films
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.errors import InputError
from frbcli.film.cells.tilted_film import tilted_force
from frbcli.film.kinds.tilted import TiltedFilms
from frbcli.linear.stability import stability_points
from frbcli.rotor.assembly import COORDINATES, PLANE, without_spins
from frbcli.rotor.loads import speed_profile
from frbcli.runs.start import state_at
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import SPEED_CYCLES
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import System
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.tilted import TiltedForm
from frbcli.solve.state import STEPS, Control

Array = np.ndarray

SPEED = 300.0  # Hz
OMEGA = 2.0 * math.pi * SPEED
FEW = ((24, 8), (16, 6))
BORES = 'supply = {kind = "bores", count = 4, diameter = "1.5 mm", pressure = "2 bar"}'
GROOVE = 'supply = {kind = "circumferential-groove", pressure = "2 bar"}'
RING = '{mass = "5 g", inertia = "0.2 kg*mm^2", tilt_inertia = "0.15 kg*mm^2"}'
INNER = f'{{width = "5 mm", diameter = "10 mm", clearance = "20 um", {BORES}}}'
OUTER = f'{{width = "5 mm", diameter = "16 mm", clearance = "40 um", {GROOVE}}}'


@pytest.fixture(autouse=True)
def few_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(TiltedForm, "static_cells", FEW)


def ringed(*more: str, ring: str = RING, inner: str = INNER, outer: str = OUTER) -> Case:
    """The shaft of rigid_shaft in two floating rings."""
    bearings = ", ".join(
        f'{{kind = "floating-ring", name = "{name}", position = "{place} mm", ring = {ring}, inner = {inner}, '
        f"outer = {outer}}}"
        for name, place in (("left", 7.0), ("right", 13.0))
    )
    settings = ("film.tilt=follows", "film.cavitation=half-sommerfeld", "accuracy.mesh=[4, 24]",
                "disk.0.unbalance=0 g*mm")  # fmt: skip
    return rigid_shaft(f"bearing=[{bearings}]", *settings, *more)


def in_plane(case: Case, system: System) -> System:
    """The same machine and the same cells, rings that move in their plane, and films that do not know of a tilt."""
    rotor = make_rotor(case.with_settings({"film.tilt": "none"}), PLANE)
    return replace(system, films=flat_films(case, system), rotor=rotor)


# -------------------------------------------------------------------------------------------------------------- body


def test_inertias_of_a_ring_that_are_not_given_are_those_of_a_hollow_cylinder() -> None:
    """m (R_i^2 + R_o^2) / 4 + m B^2 / 12 about a diameter; a given one takes its place."""
    (bearing, _) = ringed(ring='{mass = "5 g"}').bearings
    width, mass = 5e-3, 5e-3
    assert bearing.ring_tilt_inertia == pytest.approx(mass * ((5e-3**2 + 8e-3**2) / 4.0 + width**2 / 12.0))
    told = {decision.choice: decision for decision in make_plan(ringed(ring='{mass = "5 g"}')).decisions}
    assert f"tilt {1e6 * bearing.ring_tilt_inertia:.4g} kg*mm^2" in told["ring left"].value
    machine = make_rotor(ringed(), COORDINATES)
    assert np.sort(np.diag(machine.mass))[:4] == pytest.approx([0.15e-6] * 4)
    assert [tuple(cone.any(axis=0).nonzero()[0]) for _, cone in machine.cones] == [(6, 7), (10, 11)]


# ----------------------------------------------------------------------------------------------------------- at rest


def test_a_blocked_ring_tilts_against_the_closed_form_of_its_short_film(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kept from turning, and around it a film of its own alone: I_t t'' = -pi eta R L^5 / (60 C^3) t'."""
    monkeypatch.setattr(TiltedForm, "static_cells", ((24, 16), (16, 12)))
    inner = '{width = "1.6 mm", diameter = "10 mm", clearance = "400 um"}'
    outer = '{width = "1.6 mm", diameter = "16 mm", clearance = "20 um"}'
    ring = RING[:-1] + ', spin = "blocked"}'
    case = ringed("rotor.gravity=0", "film.cavitation=sommerfeld", ring=ring, inner=inner, outer=outer)
    damping = math.pi * case.oil_viscosity * 8e-3 * 1.6e-3**5 / (60.0 * 20e-6**3)
    (point,) = stability_points(case, [SPEED])[1]
    near = np.sort(np.abs(point.eigenvalues / (-damping / 0.15e-6) - 1.0))
    assert near[:4].max() < 1.5e-2  # both rings, about both axes
    assert near[4] > 0.1


ACROSS = np.array([[0.0, 1.0], [-1.0, 0.0]])  # a tilt moves the journal by z (t_y, -t_x)
STILL, SAME = np.zeros((2, 2)), np.eye(2)


def test_cones_of_a_rigid_rotor_in_rings_and_in_a_cartridge() -> None:
    """Without weight everything rests in the middle. The shaft tilts by t, rings move by d and -d and tilt by p, and a
    cartridge tilts by p: films on arms of half their distance, with their stiffness and damping in tilt."""
    ring, inner = '{mass = "5 g", inertia = "2 kg*mm^2", tilt_inertia = "1.5 kg*mm^2"}', INNER.replace(BORES, GROOVE)
    arm = 3e-3 * ACROSS
    rings = {
        "inertias": [0.0, 2.0 * 5e-3, 2.0 * 1.5e-6],
        "inner": np.block([[arm, -SAME, STILL], [SAME, STILL, -SAME]]),
        "outer": np.block([[STILL, SAME, STILL], [STILL, STILL, SAME]]),
        "polar": 2.0 * 2e-6,
    }
    body = {
        "inertias": [0.0, 1.5e-6],
        "inner": np.block([[arm, -arm], [SAME, -SAME]]),
        "outer": np.block([[STILL, arm], [STILL, SAME]]),
        "polar": 2e-6,
    }
    films = f"ring = {ring}, inner = {inner}, outer = {OUTER}"
    one = f'bearing={{kind = "cartridge", positions = ["7 mm", "13 mm"], {films}}}'
    settings = "rotor.gravity=0", "film.cavitation=sommerfeld"
    cases = ringed(*settings, ring=ring, inner=inner), ringed(*settings, one)
    for case, parts in zip(cases, (rings, body), strict=True):
        (point,) = stability_points(case, [SPEED])[1]
        own, turn = static_films(case).system.films, 2.0 * math.pi * point.ring_speeds_Hz[0]
        assert isinstance(own, TiltedFilms)
        totals = OMEGA + turn, turn
        loads = [tilted_force(own.own[i], np.zeros(4), np.zeros(4), total) for i, total in enumerate(totals)]
        maps = parts["inner"], parts["outer"]
        stiffness, damping = (
            -2.0 * sum(p.T @ getattr(film, name) @ p for p, film in zip(maps, loads, strict=True))
            for name in ("by_displacement", "by_velocity")
        )
        shaft = RHO * math.pi / 4.0 * D**2 * LENGTH
        inertias = np.repeat(parts["inertias"], 2)
        inertias[:2] = DIAMETRAL + shaft * (3.0 * (0.5 * D) ** 2 + LENGTH**2) / 12.0
        damping[:2, :2] += OMEGA * (POLAR + 0.5 * shaft * (0.5 * D) ** 2) * ACROSS
        damping[-2:, -2:] += turn * parts["polar"] * ACROSS
        expected = np.linalg.eigvals(first_order(np.diag(inertias), damping, stiffness))
        for value in expected:
            assert np.abs(point.eigenvalues - value).min() < 1e-6 * abs(value)
        damping[-2:, -2:] -= turn * parts["polar"] * ACROSS
        still = np.linalg.eigvals(first_order(np.diag(inertias), damping, stiffness))
        assert max(np.abs(point.eigenvalues - value).min() / abs(value) for value in still) > 1e-2


def test_forces_moments_and_torques_on_the_rings_balance() -> None:
    """A disk beside the bearings tilts the shaft, and it the rings."""
    case = ringed("disk.0.position=16 mm")
    system = planned_system(case)
    rest = resting_position(system, OMEGA)
    loads = np.array([film.force for film in rest.films])
    inner, outer = loads[0::2], loads[1::2]
    assert outer[:, 2:] == pytest.approx(inner[:, 2:], rel=1e-7, abs=1e-9 * np.abs(inner[:, 2:]).max())
    assert outer[:, 1] - inner[:, 1] == pytest.approx(5e-3 * 9.81, rel=1e-6)
    assert outer[:, 0] == pytest.approx(inner[:, 0], abs=1e-8 * np.abs(inner).max())
    weight, places = -system.rotor.static_load, np.array([-3e-3, 3e-3])
    shaft = RHO * math.pi / 4.0 * D**2 * LENGTH
    assert inner[:, 1].sum() == pytest.approx(9.81 * (shaft + 0.05), rel=1e-8)
    couple = -(places @ inner[:, 1]) + inner[:, 2].sum()
    assert couple == pytest.approx(-9.81 * 0.05 * 6e-3, rel=1e-7)  # about the middle: M_x = -z F_y
    assert weight.max() > 0.0
    tilts = np.hypot(*rest.journals[:, 2:].T)
    assert tilts[1::2].min() > 0.1 * tilts[0::2].max()
    torques, _, _ = ring_torques(system, np.append(OMEGA, rest.ring_speeds), rest.journals, rest.films)
    assert np.abs(torques).max() < 1e-8 * system.drags[0] * OMEGA
    assert 0.1 * OMEGA < rest.ring_speeds.min() < rest.ring_speeds.max() < 0.6 * OMEGA


def test_derivatives_of_the_torques_on_rings() -> None:
    """By the speeds they are those of the motion of the gap, which on few cells differs a little."""
    system = planned_system(ringed("film.cavitation=sommerfeld"))
    speeds = OMEGA * np.array([1.0, 0.3, 0.2])
    c = system.clearances[0]
    places = 0.2 * c * np.random.default_rng(3).normal(size=(4, 4)) * [1.0, 1.0, 200.0, 200.0]

    def torques(bodies: Array, at: Array) -> tuple[Array, Array, Array]:
        totals = system.turning[:, 0] @ bodies
        films = tuple(system.force(i, at[i], np.zeros(4), float(totals[i])) for i in range(4))
        return ring_torques(system, bodies, at, films)

    _, by_speeds, by_places = torques(speeds, places)
    changes = differences(lambda bodies: torques(bodies, places)[0], speeds, 1e-3 * OMEGA)
    assert changes[:, 1:] == pytest.approx(by_speeds, rel=1e-3)
    for film, coordinate in ((0, 0), (1, 3), (2, 1), (3, 2)):
        step = np.zeros((4, 4))
        step[film, coordinate] = 1e-5 * (c if coordinate < 2 else 200.0 * c)
        ahead, behind = torques(speeds, places + step)[0], torques(speeds, places - step)[0]
        expected = by_places[:, 4 * film + coordinate]
        assert (ahead - behind) / (2.0 * step[film, coordinate]) == pytest.approx(expected, rel=1e-4)
        assert np.abs(expected).max() > 0.0


# -------------------------------------------------------------------------------------------------------------- runs

CONTROL = Control(1e-6, 24.0, 1e-3, 1e-4, 0.9999, 0.0)


@pytest.mark.parametrize(("supply", "tolerance", "duration"), [(GROOVE, 1e-6, 3e-3), (BORES, 1e-9, 3e-4)])
@pytest.mark.nightly  # the runs of this file compile a time loop that no other has
def test_rings_in_translation_run_as_without_tilt(supply: str, tolerance: float, duration: float) -> None:
    """Weight in the middle of a rigid symmetric rotor: nothing tilts, also where feed holes turn with the rings. With
    these, Newton's method leaves a difference that falls with the tolerance."""
    case = ringed("disk.0.unbalance=1 g*mm", inner=INNER.replace(BORES, supply))
    system = planned_system(case)
    flat = in_plane(case, system)
    ends, c = [], np.array(system.clearances)[:, None]
    for each in (system, flat):
        journals = each.rotor.journals[:, :2].reshape(8, -1)
        aside = np.linalg.pinv(journals) @ (np.tile([0.1, -0.3], 4) * np.repeat(each.clearances, 2))
        v = np.zeros(each.rotor.size)
        v[list(each.spins)] = 0.3 * OMEGA
        profile = speed_profile((0.0, duration), (OMEGA, OMEGA))
        limits = CONTROL._replace(tolerance=tolerance)
        found = march(each, profile, limits, state_at(each, profile, aside, v), "esdirk3")
        places = np.einsum("fcn,kn->kfc", each.rotor.journals, found.q)
        ends.append((places[:, :, :2] / c, found.v[:, list(each.spins)] / OMEGA, found.numbers[STEPS]))
        if each is system:
            assert np.abs(places[:, :, 2:]).max() < 1e-9 * c.min() / 5e-3
    (one, turned, steps), (other, expected, same) = ends
    assert np.abs(other).max() > 0.05
    assert np.abs(one - other).max() < 1e-9
    assert np.abs(turned - expected).max() < 1e-9
    assert np.ptp(expected) > 1e-4
    assert steps == same


@pytest.mark.nightly  # the runs of this file compile a time loop that no other has
def test_small_tilts_grow_and_decay_as_the_eigenvalues_say() -> None:
    """The motion that the gyroscopic moments of the rings change the most, beside a run that begins in it."""
    ring = '{mass = "5 g", inertia = "2 kg*mm^2", tilt_inertia = "1 kg*mm^2"}'
    case = ringed("rotor.gravity=0", "film.cavitation=sommerfeld", ring=ring)
    system, (point,) = planned_system(case), stability_points(case, [SPEED])[1]
    rest = resting_position(system, OMEGA)
    films = [-np.array([getattr(film, name) for film in rest.films]) for name in ("by_displacement", "by_velocity")]
    rotor, still = (without_spins(system.rotor, share * rest.ring_speeds) for share in (1.0, 0.0))
    values, vectors = np.linalg.eig(first_order(*linearised(rotor, OMEGA, *films)))
    others = np.linalg.eigvals(first_order(*linearised(still, OMEGA, *films)))
    apart = np.abs(values[:, None] - others).min(axis=1) / np.abs(values)
    worth = (values.imag > 0.0) & (np.abs(values.real) < values.imag)
    mode = int(np.argmax(np.where(worth, apart, 0.0)))
    value, shape = complex(values[mode]), vectors[: rotor.size, mode]
    assert apart[mode] > 0.02
    assert np.abs(point.eigenvalues - value).min() < 1e-3 * abs(value)
    shape = shape * 1e-4 / np.abs(system.films.ends((system.rotor.journals[:, :, :-2] @ shape).real)).max()
    duration = 4.0 * 2.0 * math.pi / value.imag
    profile = speed_profile((0.0, duration), (OMEGA, OMEGA))
    beside, rate = (np.append(np.real(each), [0.0, 0.0]) for each in (shape, value * shape))
    limits = Control(1e-9, 60.0, 1e-3, duration / 50.0, 0.9999, 0.0)
    begin = state_at(system, profile, rest.displacements + beside, rest.velocities(system) + rate)
    found = march(system, profile, limits, begin)
    tilts = np.einsum("fcn,kn->kfc", system.rotor.journals[:, 2:, :-2], found.q[:, :-2])
    expected = np.real(np.exp(value * found.times)[:, None, None] * (system.rotor.journals[:, 2:, :-2] @ shape))
    assert np.abs(tilts - expected).max() < 1e-2 * np.abs(expected).max()
    nearest = others[np.argmin(np.abs(others - value))]
    without = np.real(np.exp(nearest * found.times)[:, None, None] * (system.rotor.journals[:, 2:, :-2] @ shape))
    assert np.abs(without - expected).max() > 0.05 * np.abs(expected).max()


@pytest.mark.nightly  # the runs of this file compile a time loop that no other has
def test_a_ring_follows_a_shell_that_is_not_in_line() -> None:
    """Both shells tilt against each other around a rotor without weight: by symmetry the shaft stays in line, and each
    ring stands between it and the shell so that the moments of its films balance. A run that begins there stays."""
    size, more = 1e-3, ("rotor.gravity=0", "film.cavitation=sommerfeld")
    shells = [f'bearing.{side}.misalignment=["{tilt} rad", "0 rad"]' for side, tilt in ((0, size), (1, -size))]
    case = ringed(*more, *shells, inner=INNER.replace(BORES, GROOVE))
    system = planned_system(case)
    rest = resting_position(system, OMEGA)
    inner, outer = rest.journals[0::2, 2:], rest.journals[1::2, 2:]
    assert inner + outer == pytest.approx(np.array([[-size, 0.0], [size, 0.0]]), abs=1e-7 * size)  # against the shells
    assert inner[0] == pytest.approx(-inner[1], rel=1e-6)
    share = np.hypot(*inner[0]) / size
    assert 0.1 < share < 0.9
    moments = np.array([film.force[2:] for film in rest.films])
    assert moments[0::2] == pytest.approx(moments[1::2], rel=1e-7)
    profile = speed_profile((0.0, 1e-3), (OMEGA, OMEGA))
    found = march(system, profile, CONTROL, state_at(system, profile, rest.displacements, rest.velocities(system)))
    moved = system.films.seen(system.rotor.journals) @ (found.q - rest.displacements).T
    assert np.abs(moved).max() < 1e-4 * system.clearances[0]


# ------------------------------------------------------------------------------------------------------ limit cycles


HEAVY = '{mass = "5 g", inertia = "5 kg*mm^2", tilt_inertia = "3 kg*mm^2"}'  # keeps its speed, as in stability


def grooved(body: str, *more: str) -> Case:
    """The shaft with its disk beside the middle, in two rings or in a cartridge; no opening turns."""
    inner = INNER.replace(BORES, GROOVE)
    films = f"ring = {HEAVY}, inner = {inner}, outer = {OUTER}"
    one = (f'bearing={{kind = "cartridge", positions = ["7 mm", "13 mm"], {films}}}',) if body == "cartridge" else ()
    return ringed("disk.0.position=12 mm", *one, *more, ring=HEAVY, inner=inner)


@pytest.mark.parametrize("body", ["rings", "cartridge"])
@pytest.mark.nightly  # 10 s each, and a time loop that no other file has
def test_small_motions_of_rings_that_tilt_grow_in_cycles_as_in_the_linearised_machine(body: str) -> None:
    case = grooved(body, "film.cavitation=reynolds")
    rest = settled(Shooting(period_map(case), OMEGA), OMEGA)
    assert rest is not None
    s = stability_points(case, [SPEED])[1][0].eigenvalues
    slow = s[(np.abs(s.imag) > 0.05 * OMEGA) & (s.real > -0.2 * OMEGA)]
    assert len(slow) >= 6
    assert (slow.real > 0.0).any()
    for value in slow:
        assert np.abs(rest.eigenvalues - value).min() < 2e-3 * abs(value)


@pytest.mark.nightly  # a minute of CPU time; of a cartridge without memory: above
def test_rings_that_tilt_in_films_that_keep_oil_grow_as_in_the_time_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two runs from beside rest, on either side, by the shape of the motion that grows the fastest in stability: how
    what lies between them goes on."""
    monkeypatch.undo()  # on all cells of stability
    case, steps = grooved("rings", "film.cavitation=elrod", "accuracy.mesh=[8,96]"), 400
    machine = StaticMachines(case, memory=True).at(OMEGA)
    value, shape = max(machine.modes, key=lambda mode: mode[0].real)
    assert value.real > 50.0
    system = planned_system(case)
    rest, spins = resting_position(system, OMEGA), list(system.spins)
    shape *= 1e-3 * system.clearances[0] / np.abs(system.rotor.journals[:, :2] @ shape).max()
    q, v = shape.real.copy(), (value * shape).real
    q[spins], v[spins] = 0.0, shape.real[spins]  # of rings, the shape has the speeds
    middle = rest.displacements, rest.velocities(system)
    seen = seen_between(system, OMEGA, middle, (q, v), 0.04, steps, lag=8, count=9, settled=steps // 4)
    nearest = seen[np.argmin(np.abs(seen - value))]
    assert nearest.real == pytest.approx(value.real, rel=0.01)
    assert nearest.imag == pytest.approx(value.imag, rel=1e-3)


# -------------------------------------------------------------------------------------------------------------- case


def test_limit_cycles_have_rings_that_tilt_in_films_that_keep_oil() -> None:
    """Where no opening turns with a ring."""
    for law in ("reynolds", "elrod", "two-phase"):
        for body in ("rings", "cartridge"):
            assert not faults(grooved(body, f"film.cavitation={law}"), SPEED_CYCLES)
        assert "film.cavitation" in [fault.key for fault in faults(ringed(f"film.cavitation={law}"), SPEED_CYCLES)]


def test_what_rings_that_tilt_do_not_have_is_refused() -> None:
    with pytest.raises(InputError) as refused:
        make_plan(ringed("bearing.0.channels=coupled"))
    assert [fault.key for fault in refused.value.faults] == ["bearing.0.channels"]
    shell = 'misalignment=["{} mrad", "0 mrad"]'
    with pytest.raises(InputError) as refused:
        make_plan(ringed("bearing.1." + shell.format(20)))
    assert [fault.key for fault in refused.value.faults] == ["bearing.1.misalignment"]
    with pytest.raises(InputError, match="whose own tilt"):
        make_plan(frbcli.load_case("floating-ring", ["bearing." + shell.format(0.1)]))
    with pytest.raises(InputError, match="in line but for the motion"):
        frbcli.rotation(ringed("bearing.0." + shell.format(0.1), 'motion={film="left_outer", eccentricity=0.5}'))
    with pytest.raises(InputError, match="less than half"):
        ringed(ring='{mass = "5 g", inertia = "2 kg*mm^2", tilt_inertia = "0.5 kg*mm^2"}')
    with pytest.raises(InputError, match="moves in its plane"):
        frbcli.load_case("floating-ring", ["bearing.ring.tilt_inertia=20 kg*mm^2"])
