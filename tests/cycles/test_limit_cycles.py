"""Limit cycles: Hopf points with their criticality, harmonic balance, folds, the synchronous response.

The rigid rotor in short bearings without supply has two numbers, the speed w = omega sqrt(C/g) and
Gamma = mu R L^3 omega / (W C^2) / w with the load W of a bearing.
"""

import math
import tomllib
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from cycle_machines import (
    CLEARANCE,
    GRAVITY,
    MASS,
    RADIUS,
    WIDTH,
    UNIT_Hz,
    cartridge,
    diagram,
    machine_of,
    rigid,
    ring_case,
    turbocharger,
)
from differences import differences
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import fsolve

import frbcli
from frbcli.case.reading.load import load_case_text
from frbcli.cycles.method.balance import Balance, packed, state_space
from frbcli.cycles.method.equilibria import resting_curve
from frbcli.cycles.method.machine import film_loads, smooth_films, transfer
from frbcli.equilibrium.resting import resting_position
from frbcli.film.cells.film import turned
from frbcli.film.cells.linearised import steady_force
from frbcli.film.rectangles.film import evaluate
from frbcli.film.rectangles.film_force import film_force
from frbcli.linear.stability import stability
from frbcli.rotor.loads import speed_profile
from frbcli.runs.start import control_of, rotor_data, state_at
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import SPEED_CYCLES
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.state import METHODS, RUNNING, make_output
from frbcli.solve.time_loop import advance


@pytest.mark.parametrize("name", ["rigid", "ring", "turbocharger"])
def test_the_rotor_behind_its_films_is_the_whole_rotor(name: str) -> None:
    """T_k and the springs beside the films give what (Z - P^T m dF) q = P^T m f gives with all degrees of freedom."""
    case = {"rigid": lambda: rigid(2.0, 1.0, 3.0), "ring": ring_case, "turbocharger": turbocharger}[name]()
    machine = machine_of(case)
    nu, omega, c = 0.45 * machine.pace, 0.9 * machine.pace, machine.size
    loads = np.random.default_rng(1).standard_normal(c)
    passing, space = transfer(machine, nu * np.arange(4.0), omega), state_space(machine)
    for k in (1, 2, 3):
        kept = np.linalg.solve(np.eye(c) - passing.values[k] * passing.kappa[k], passing.values[k] @ loads)
        whole = 1j * k * nu * np.eye(len(space.still)) - space.still - omega * space.by_speed
        np.testing.assert_allclose(kept, space.read @ np.linalg.solve(whole, space.given @ loads), rtol=1e-8)


@pytest.mark.parametrize(
    "make", [lambda: rigid(2.0, 1.0, 3.0), ring_case, cartridge], ids=["rigid", "ring", "cartridge"]
)
def test_derivatives_are_those_of_the_residual(make) -> None:  # type: ignore[no-untyped-def]
    machine = machine_of(make())
    random = np.random.default_rng(0)
    motion = 0.02 * (random.standard_normal((4, machine.size)) + 1j * random.standard_normal((4, machine.size)))
    motion[0] = motion[0].real + 0.1
    motion[1, :2] += 0.2 * np.array([1.0, -1.0j])
    y = np.concatenate([packed(motion), [0.4, 0.8]])
    balance = Balance(machine, motion + 0.1)
    _, slope = balance(y)
    expected = differences(lambda y: balance(y)[0], y, 1e-6)
    np.testing.assert_allclose(slope, expected, atol=1e-7 * np.abs(slope).max())


@pytest.mark.parametrize(
    ("gamma", "speed", "eccentricity", "ratio", "criticality"),
    [(4.538, 2.7413, 0.1, 0.5029, "subcritical"), (1.313, 2.6058, 0.3, 0.5194, "supercritical")],
)
def test_hopf_points_of_the_rigid_rotor(
    gamma: float, speed: float, eccentricity: float, ratio: float, criticality: str
) -> None:
    """Known values, to the digits given."""
    (hopf,) = diagram(gamma, 2.4, 2.9).of("hopf")
    assert hopf.speed_Hz / UNIT_Hz == pytest.approx(speed, abs=1e-4)
    assert hopf.eccentricity_max[0] == pytest.approx(eccentricity, abs=1e-4)
    assert hopf.frequency_Hz / hopf.speed_Hz == pytest.approx(ratio, abs=1e-4)
    assert hopf.criticality == criticality


def test_the_threshold_is_that_of_stability() -> None:
    threshold = stability(rigid(1.313, 2.4, 2.9)).threshold
    (hopf,) = diagram(1.313, 2.4, 2.9).of("hopf")
    assert threshold is not None
    assert hopf.speed_Hz == pytest.approx(threshold.speed_Hz, rel=1e-8)
    assert hopf.frequency_Hz == pytest.approx(threshold.frequency_Hz, rel=1e-8)
    assert hopf.value_uncertainty == pytest.approx(threshold.speed_uncertainty_Hz, rel=1e-4)
    assert hopf.frequency_uncertainty_Hz == pytest.approx(threshold.frequency_uncertainty_Hz, rel=1e-4)


@pytest.mark.parametrize("gamma", [4.538, 1.313])
def test_small_cycles_have_the_amplitude_of_the_normal_form(gamma: float) -> None:
    """sigma'(omega) d_omega + Re c_1 r^2 = 0: the coefficient against cycles that harmonic balance has found."""
    case, found = rigid(gamma, 2.4, 2.9), diagram(gamma, 2.4, 2.9)
    (hopf,) = found.of("hopf")
    machine, step = machine_of(case), 1e-4 * hopf.speed_Hz
    system = make_system(case, make_plan(case))
    near = resting_curve(system, machine, *(2.0 * math.pi * (hopf.speed_Hz + side * step) for side in (-1.0, 1.0)))
    slope = (near.points[-1].growth_of(0) - near.points[0].growth_of(0)) / (2.0 * step)
    ratios = []
    for cycle in found.branches[0].points[:2]:
        size = 2.0 * np.abs(cycle.harmonics[1]).max()  # the mode's largest displacement is 1
        ratios.append((size**2 / 4.0, -slope * (cycle.speed_Hz - hopf.speed_Hz) / (size**2 / 4.0)))
    (a, first), (b, second) = ratios
    assert first - (second - first) * a / (b - a) == pytest.approx(hopf.lyapunov, rel=0.02)


@pytest.mark.nightly  # 8 s; folds of both methods: test_shot_branch.py
def test_the_fold_is_where_cycles_end_in_the_time_domain() -> None:
    """Gamma = 4.538: the stable cycle integrated over 100 periods stays just above the fold and is lost below it."""
    found = diagram(4.538, 2.4, 2.9)
    (fold,) = found.of("fold")
    assert 2.60545 < fold.speed_Hz / UNIT_Hz < 2.6056
    stable = [point for point in found.branches[0].points if point.stable and not point.kind]
    lowest = min(stable, key=lambda point: point.speed_Hz)
    reached = integrated(4.538, lowest.speed_Hz, lowest, 10)
    assert reached == pytest.approx(lowest.eccentricity_max[0], abs=1e-5)
    assert integrated(4.538, fold.speed_Hz + 0.005 * UNIT_Hz, lowest, 100) > fold.eccentricity_max[0]
    assert integrated(4.538, fold.speed_Hz - 0.005 * UNIT_Hz, lowest, 200) < 0.2


def test_the_force_there_is_the_integral_of_the_short_bearing() -> None:
    """p = 3 eta / (C^2 H^3) (z^2 - L^2 / 4) (omega dH/dphi + 2 dH/dt) where it is positive, by quadrature:
    the fold does not rest on the closed form of the program alone."""
    case = rigid(4.538, 2.4, 2.9)
    (film,), omega = machine_of(case).films, 2.0 * math.pi * 2.6 * UNIT_Hz
    nodes, weights = np.polynomial.legendre.leggauss(80)
    viscosity = case.oil.viscosity
    assert isinstance(viscosity, float)
    scale = viscosity * RADIUS * WIDTH**3 / (2.0 * CLEARANCE**2)
    for x, y, u, v in np.random.default_rng(3).uniform(-0.48, 0.48, (20, 4)) * [1.0, 1.0, 0.5 * omega, 0.5 * omega]:
        a, b = omega * y + 2.0 * u, -omega * x + 2.0 * v
        phi = math.atan2(b, a) + 0.5 * math.pi * nodes
        gap = 1.0 - x * np.cos(phi) - y * np.sin(phi)
        pressed = 0.5 * math.pi * weights * (a * np.cos(phi) + b * np.sin(phi)) / gap**3
        expected = -scale * np.array([pressed @ np.cos(phi), pressed @ np.sin(phi)])
        found = np.array(film_force(film, x, y, u, v, omega)[:2])
        assert found == pytest.approx(expected, abs=1e-9 * float(np.hypot(*expected)))


def integrated(gamma: float, speed_Hz: float, start, periods: int) -> float:  # type: ignore[no-untyped-def]
    """Largest eccentricity of the last period when the motion begins on a cycle."""
    case = rigid(gamma, 2.4, 2.9)
    machine = machine_of(case)
    (film,), omega, nu = machine.films, 2.0 * math.pi * speed_Hz, 2.0 * math.pi * start.frequency_Hz
    k = np.arange(len(start.harmonics))[:, None]
    doubled = np.where(k > 0, 2.0, 1.0) * start.harmonics[:, 0]
    d, v = doubled.sum(axis=0).real, (1j * k * nu * doubled).sum(axis=0).real

    def rates(_: float, x: np.ndarray) -> list[float]:
        force = film_force(film, x[0], x[1], x[2], x[3], omega)
        scale = 2.0 / (MASS * CLEARANCE)
        return [x[2], x[3], scale * force[0], scale * force[1] - GRAVITY / CLEARANCE]

    period = 1.0 / start.frequency_Hz
    times = np.linspace((periods - 1.05) * period, periods * period, 400)
    done = solve_ivp(rates, (0.0, times[-1]), [*d, *v], rtol=1e-8, atol=1e-9, t_eval=times)
    return float(np.hypot(done.y[0], done.y[1]).max())


@pytest.mark.parametrize("damping", [100.0, 300.0])
def test_the_circle_without_gravity_solves_its_algebraic_equation(damping: float) -> None:
    """Of the two equal bearings along and across the line of centres: 2 F_r = -m nu^2 e, 2 F_t = d nu e."""
    case = rigid(4.538, 2.0, 3.0, gravity=0.0, external_damping=damping)
    machine = machine_of(case)
    asked = 2.5 * UNIT_Hz
    found = frbcli.limit_cycles(case, [asked])
    assert found.of("hopf") == ()
    (branch,) = found.branches
    (cycle,) = [point for point in branch.points if point.kind == "asked"]
    (film,), omega = machine.films, 2.0 * math.pi * asked

    def unbalanced(unknowns: np.ndarray) -> list[float]:
        eccentricity, nu = unknowns[0], unknowns[1] * omega
        radial, tangential = film_force(film, eccentricity, 0.0, 0.0, eccentricity * nu, omega)[:2]
        pull = MASS * nu**2 * eccentricity * CLEARANCE
        return [2.0 * radial / pull + 1.0, (2.0 * tangential - damping * nu * eccentricity * CLEARANCE) / pull]

    (eccentricity, ratio), _, ended, _ = fsolve(
        unbalanced, [cycle.eccentricity_max[0], 0.499], xtol=1e-13, full_output=True
    )
    assert ended == 1
    assert cycle.eccentricity_max[0] == pytest.approx(eccentricity, abs=1e-7)
    assert cycle.frequency_Hz / asked == pytest.approx(ratio, abs=1e-7)
    assert np.abs(cycle.harmonics[2:]).max() < 1e-9
    np.testing.assert_allclose(np.hypot(*cycle.orbit().T), eccentricity, atol=1e-7)


def test_forces_on_the_journals_do_what_the_gyroscopic_moments_of_a_cartridge_do() -> None:
    """P^T g of a machine that moves anyhow is -w C^T J C q' of its whole rotor. In a housing that moves the films do
    not see how the ring tilts."""
    case = cartridge()
    system, machine = make_system(case, make_plan(case)), machine_of(case)
    chance, n, c = np.random.default_rng(2), system.rotor.size - 1, machine.size
    q, v, speed = 1e-6 * chance.standard_normal(n), 1e-3 * chance.standard_normal(n), 300.0
    u, rate = np.append(machine.places @ q, speed / machine.pace), np.append(machine.places @ v, 0.0)
    with_it, without = (
        film_loads(each, u[None], rate[None], machine.pace).values[0] for each in (machine, replace(machine, cones=()))
    )
    expected = -(system.rotor.precession(np.append(np.zeros(n), speed)) @ np.append(v, 0.0))[:n]
    found = machine.pulls @ (with_it - without)[: c - 1]
    assert np.abs(expected).max() > 1e-4
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())
    assert with_it[-1] == without[-1]  # the torque on the ring is that of the films
    assert not faults(case, SPEED_CYCLES)
    mounts = [{"position": f"{position} mm", "stiffness": "1e8 N/m"} for position in (20, 80)]
    housing = {"mass": "4 kg", "inertia": "2 kg*m^2", "position": "50 mm", "mounts": mounts}
    moved = case.with_settings({"housing": housing})
    assert [fault.key for fault in faults(moved, SPEED_CYCLES)] == ["bearing.ring.spin"]


def test_harmonic_balance_agrees_with_the_time_loop(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """Jeffcott rotor, half-Sommerfeld, tabulated film: a run at constant speed after its transients."""
    speed_Hz = 190.0
    settings = [f"speed.from={speed_Hz} Hz", f"speed.to={speed_Hz} Hz", "speed.duration=2 s", "output.step=2e-5 s"]
    settings += ["accuracy.tolerance=1e-8", "accuracy.steps_per_revolution=400", "start.displacement=[0.3, -0.3]"]
    signals = frbcli.runup(
        frbcli.load_case("jeffcott", ["rotor.unbalance=0 g*mm", *settings]), tmp_path / "r.h5"
    ).signals
    last = slice(-8000, None)
    time, y = np.asarray(signals["time_s"])[last], np.asarray(signals["journal_y_m"])[last]
    motion = CubicSpline(time, y - y.mean())
    rising = [t for t in motion.roots(extrapolate=False) if motion(t, 1) > 0.0]
    largest = CubicSpline(time, np.asarray(signals["eccentricity"])[last])
    case = frbcli.load_case("jeffcott", ["rotor.unbalance=0 g*mm"])
    (cycle,) = [p for p in frbcli.limit_cycles(case, [speed_Hz]).branches[0].points if p.kind == "asked"]
    assert cycle.stable
    assert cycle.frequency_Hz == pytest.approx((len(rising) - 1) / (rising[-1] - rising[0]), rel=1e-6)
    top = largest(largest.derivative().roots(extrapolate=False)).max()
    assert cycle.eccentricity_max[0] == pytest.approx(top, abs=1e-6)


LONG = [pytest.param(each, marks=pytest.mark.nightly) for each in ("cartridge", "turbocharger")]


@pytest.mark.parametrize("name", ["jeffcott", "ring", *LONG])
def test_a_disturbance_above_the_threshold_grows_by_the_eigenvalue(name: str) -> None:
    """The growing motion at rest, 1 % above the lowest Hopf point, five periods in the time loop: asked is 1 %."""
    case = {
        "jeffcott": lambda: frbcli.load_case("jeffcott", ["rotor.unbalance=0 g*mm"]),
        "ring": ring_case,
        "cartridge": cartridge,
        "turbocharger": turbocharger,
    }[name]()
    plan = make_plan(case)
    system, machine = make_system(case, plan), machine_of(case)
    curve = resting_curve(system, machine, 0.3 * machine.pace, machine.pace)
    omega = 1.01 * curve.hopf[0].equilibrium.omega
    rest, spins, n = resting_position(system, omega), list(system.spins), machine.rotor.size
    q, v = rest.displacements, rest.velocities(system)
    space, u = state_space(machine), np.concatenate([machine.places @ q[:n], v[n:] / machine.pace])
    loads = film_loads(machine, u[None], np.zeros((1, machine.size)), omega)
    values, states = np.linalg.eig(space.matrix(omega, loads.by_u[0], loads.by_v[0]))
    oscillating = np.flatnonzero(values.imag > 1e-6 * np.abs(values))
    own = oscillating[np.argmax(values[oscillating].real)]
    value, left = values[own], np.linalg.inv(states)[own]
    mode = 1e-4 * (states[:, own] / np.abs(space.read @ states[:, own])[: 2 * machine.film_count].max()).real
    period = 2.0 * math.pi / value.imag
    profile = speed_profile([0.0, 6.0 * period], [omega, omega])
    rotor = rotor_data(system, profile)
    still = np.zeros_like(rotor.unbalance_cos)
    rotor = rotor._replace(unbalance_cos=still, unbalance_sin=still)
    control = control_of(case, plan)._replace(tolerance=1e-10, steps_per_revolution=200.0, output_step=period / 40.0)
    moved = np.concatenate([mode[:n], np.zeros(len(spins))])
    faster = np.concatenate([mode[n : 2 * n], machine.pace * mode[2 * n :]])
    state = state_at(system, profile, q + moved, v + faster)
    output = make_output(400, len(q), len(system.names))
    tableau, status, rows = METHODS[plan.method].tableau, RUNNING, []
    while status == RUNNING:
        status, count = advance(rotor, system.films.loop, tableau, control, state, 10**7, output)
        rows.append(np.hstack([output.q[:count, :n] - q[:n], output.v[:count] - v]))
    x = np.concatenate(rows)
    x[:, 2 * n :] /= machine.pace
    size = x @ left
    times = np.arange(len(size)) * control.output_step
    late = times > period
    growth = np.polyfit(times[late], np.log(np.abs(size[late])), 1)[0]
    assert growth == pytest.approx(value.real, rel=1e-3)
    assert np.polyfit(times[late], np.unwrap(np.angle(size[late])), 1)[0] == pytest.approx(value.imag, rel=1e-5)


@pytest.mark.nightly
def test_a_turbocharger_whirls_as_in_the_time_loop(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """turbocharger-heavy without feed holes and unbalance in short films, at 200 Hz after 0.8 s: asked is 1e-4."""
    case = tomllib.loads(turbocharger().source_text)
    for disk in case["disk"]:
        disk.pop("unbalance", None)
    text = frbcli.case_from_dict(case).source_text
    constant = ["speed.from=200 Hz", "speed.to=200 Hz", "speed.duration=1 s", "output.step=2e-5 s"]
    constant += ["accuracy.tolerance=1e-8", "accuracy.steps_per_revolution=100", "start.displacement=[0.3, -0.3]"]
    run_ = frbcli.runup(load_case_text(text, constant, "turbocharger"), tmp_path / "r.h5").signals
    last = slice(-10000, None)
    time, y = np.asarray(run_["time_s"])[last], np.asarray(run_["journal_compressor_y_m"])[last]
    motion = CubicSpline(time, y - y.mean())
    rising = [t for t in motion.roots(extrapolate=False) if motion(t, 1) > 0.0]
    found = frbcli.limit_cycles(load_case_text(text, [], "turbocharger"), [200.0])
    points = [p for branch in found.branches for p in branch.points if p.kind == "asked" and p.stable]
    frequency = (len(rising) - 1) / (rising[-1] - rising[0])
    cycle = min(points, key=lambda point: abs(point.frequency_Hz - frequency))
    assert cycle.frequency_Hz == pytest.approx(frequency, rel=1e-6)
    for film, name in enumerate(found.films):
        seen = CubicSpline(time, np.asarray(run_[f"eccentricity_{name}"])[last])
        top = seen(seen.derivative().roots(extrapolate=False)).max()
        assert cycle.eccentricity_max[film] == pytest.approx(top, abs=1e-5)


def test_half_of_the_drive_is_dissipated_at_rest() -> None:
    """Couette's torque on a journal in the centre of a film: eta R^3 B / C times 2 pi times the slip."""
    machine = machine_of(ring_case())
    u = np.zeros((1, machine.size))
    u[0, -1] = 0.25
    loads = film_loads(machine, u, np.zeros_like(u), machine.pace)
    expected = 2.0 * math.pi * machine.drags[0] * 0.75 * machine.pace
    assert loads.drive[0] == pytest.approx(expected)


@pytest.mark.parametrize("film", [0, 1], ids=["bores that turn", "groove"])
def test_films_on_cells_enter_by_their_mean_over_the_angle(film: int) -> None:
    """Against the steady films of the same cells with their bores at six angles, forces within the error of the cells
    up to an eccentricity of 0.6; and the derivatives are those of the force."""
    case = frbcli.load_case("floating-ring", ["film.cavitation=half-sommerfeld"])
    system = make_system(case, make_plan(case))
    mean, volume = smooth_films(system)[film]._replace(drop=0.0), system.films.with_fields[film]
    c, omega, bores = volume.section.clearance, 2000.0, len(volume.section.holes)

    def force(d: np.ndarray, v: np.ndarray) -> np.ndarray:
        return evaluate(mean, c, d, v, omega).force

    for eccentricity, v in ((0.2, (0.0, 0.0)), (0.6, (100.0, 50.0))):
        d = (eccentricity * math.cos(0.3), eccentricity * math.sin(0.3))
        found = evaluate(mean, c, np.multiply(d, c), np.multiply(v, c), omega)
        forces = []
        for j in range(6 if bores else 1):
            angle = 2.0 * math.pi / 6.0 * j / 6.0
            place, rate = (np.multiply(turned(vector, -angle), c) for vector in (d, v))
            forces.append(turned(tuple(steady_force(volume, place, rate, omega).force), angle))
        expected = np.mean(forces, axis=0)
        assert np.linalg.norm(found.force - expected) < 0.01 * np.linalg.norm(expected)
        by_d = differences(partial(force, v=np.multiply(v, c)), np.multiply(d, c), 1e-6 * c)
        np.testing.assert_allclose(found.by_displacement, by_d, atol=1e-6 * np.abs(by_d).max())


@pytest.mark.nightly
def test_where_a_branch_turns_back_it_has_a_fold() -> None:
    """Floating ring in short films: the whirl of the inner film turns back near 151 Hz, in a step on which Newton's
    method does not converge from everywhere. At a fold a second multiplier is 1: it passes from above 1 to below, from
    unstable cycles to stable ones, while that of the cycles beside it is off by 3e-3 and 4e-3."""
    found = frbcli.limit_cycles(load_case_text(ring_case().source_text, ["speed.to=170.4 Hz"], "ring"))
    (branch,) = found.branches
    speeds = np.array([point.speed_Hz for point in branch.points])
    assert np.count_nonzero(np.diff(np.sign(np.diff(speeds)))) == 1
    (fold,) = found.of("fold")
    assert fold.speed_Hz == speeds.min()
    at = speeds.argmin()
    before, here, after = branch.points[at - 1 : at + 2]
    others = [point.multipliers[1:] for point in (before, here, after)]
    second = [each[np.argmin(np.abs(each - 1.0))].real for each in others]
    assert here.kind == "fold"
    assert abs(here.multipliers[0] - 1.0) < 2e-4
    assert abs(second[1] - 1.0) < 2e-4
    assert second[0] > 1.002
    assert second[2] < 0.998
    assert not before.stable
    assert after.stable
