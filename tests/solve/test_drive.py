"""A rotor whose speed is free: closed form of J omega' = T - c omega, and refusals."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson, solve_ivp

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.cli.transient import exit_code
from frbcli.elements.collar import collar_of
from frbcli.elements.spring import STICKS
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.plan import make_plan
from frbcli.studies.warm_up import machine_kernels, moment_of_run

TURN = 2.0 * math.pi
INERTIA, TORQUE, BRAKES = 2e-4, 0.05, 1e-4
MACHINE = {
    "rotor": {"kind": "rigid", "mass": "6 kg", "gravity": 0.0, "polar_inertia": f"{INERTIA} kg*m^2"},
    "bearing": {"kind": "coefficients", "stiffness": "1e6 N/m", "damping": "300 N*s/m"},
    "drive": {"torque": f"{TORQUE} N*m", "load": f"{BRAKES} N*m*s", "duration": "0.5 s"},
}


def test_the_speed_follows_its_closed_form(tmp_path: Path) -> None:
    run = frbcli.runup(case_from_dict(MACHINE, "drive"), tmp_path / "run.h5")
    exact = TORQUE / BRAKES * (1.0 - np.exp(-BRAKES / INERTIA * run["time_s"]))
    np.testing.assert_allclose(2.0 * math.pi * run["speed_Hz"], exact, rtol=1e-6, atol=1e-6)


# A Jeffcott rotor of stiff bearings whose disk is one mass on one spring, with an unbalance that acts on its rotation
M, K, D, U, J = 6.0, 5e6, 120.0, 2.4e-3, 0.02  # kg, N/m, N s/m, kg m, kg m^2
CRITICAL = math.sqrt(K / M)


def driven(torque: float, time: float, **drive: object) -> dict[str, object]:
    return {
        "rotor": {"kind": "rigid", "mass": f"{M} kg", "gravity": 0.0, "unbalance": f"{U!r} kg*m",
                  "polar_inertia": f"{J!r} kg*m^2"},
        "bearing": {"kind": "coefficients", "stiffness": f"{0.5 * K!r} N/m", "damping": f"{0.5 * D!r} N*s/m"},
        "drive": {"torque": f"{torque!r} N*m", "duration": f"{time} s", "reaction": True, **drive},
        "accuracy": {"target": 1e-5},
    }  # fmt: skip


def integrated(torque: float, load: float, time: float, omega: float = 0.0) -> np.ndarray:
    """(x, y, angle, their rates) at the end, by an integration of all three equations at once: the centre of mass lies
    e = U / M off the centre, and J is that about the centre."""

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        x, y, angle, v_x, v_y, speed = state
        s, c = math.sin(angle), math.cos(angle)
        # the unbalance pulls at the centre with U (a'' (c, s) + a'^2 (-s, c)), see (2.3), and is pulled at in turn
        matrix = np.array([[M, 0.0, -U * c], [0.0, M, -U * s], [-U * c, -U * s, J]])
        right = [-K * x - D * v_x - U * speed**2 * s, -K * y - D * v_y + U * speed**2 * c, torque - load * speed]
        return np.concatenate([state[3:], np.linalg.solve(matrix, right)])

    end = solve_ivp(rate, (0.0, time), np.array([0, 0, 0, 0, 0, omega]), "DOP853", rtol=1e-10, atol=1e-14)
    return np.asarray(end.y[:, -1])


@pytest.mark.parametrize(("torque", "passes"), [(16.0, False), (24.0, True)])
def test_too_little_torque_sticks_at_the_critical_speed(torque: float, passes: bool, tmp_path: Path) -> None:
    """Sommerfeld's effect: at the resonance the torque is spent on the whirl."""
    time = 2.0
    run = frbcli.runup(case_from_dict(driven(torque, time, load="1e-3 N*m*s"), "sommerfeld"), tmp_path / "run.h5")
    speed = TURN * run["speed_Hz"]
    exact = integrated(torque, 1e-3, time)
    assert (exact[5] > 1.2 * CRITICAL) == passes
    if not passes:
        assert exact[5] > 0.8 * CRITICAL
    assert speed[-1] == pytest.approx(exact[5], rel=1e-4)


def test_work_of_the_drive_is_kept_or_damped(tmp_path: Path) -> None:
    """Kinetic and elastic energy and what the bearings damp are the work of the torque, through the critical speed.
    Velocities by differences of eighth order."""
    case = case_from_dict(
        driven(16.0, 1.0) | {"output": {"step": "20 us"}, "accuracy": {"tolerance": 1e-8}}, "energy"
    )
    run = frbcli.runup(case, tmp_path / "run.h5")
    step = run["time_s"][1] - run["time_s"][0]
    weights = np.array([-1 / 280, 4 / 105, -1 / 5, 4 / 5, 0, -4 / 5, 1 / 5, -4 / 105, 1 / 280]) / step
    inner = slice(4, -4)
    time, omega = run["time_s"][inner], TURN * run["speed_Hz"][inner]
    angle = cumulative_simpson(TURN * run["speed_Hz"], x=run["time_s"], initial=0.0)[inner]
    places = [run["journal_x_m"], run["journal_y_m"]]
    v_x, v_y = (np.convolve(each, weights, "valid") for each in places)
    x, y = (each[inner] for each in places)
    kinetic = 0.5 * M * (v_x**2 + v_y**2) + 0.5 * J * omega**2
    kinetic -= U * omega * (v_x * np.cos(angle) + v_y * np.sin(angle))
    damped = cumulative_simpson(D * (v_x**2 + v_y**2), x=time, initial=0.0)
    balance = kinetic + 0.5 * K * (x**2 + y**2) + damped - 16.0 * angle
    assert np.abs(balance - balance[0]).max() < 1e-8 * 16.0 * angle[-1]  # 2e-10


def test_a_rotor_under_a_constant_load_stands_still_when_its_momentum_is_used_up(tmp_path: Path) -> None:
    drive = {"load": "0.05 N*m", "start": "50 Hz", "duration": "2 s"}
    run = frbcli.runup(case_from_dict(MACHINE | {"drive": drive}, "coast"), tmp_path / "run.h5")
    stands_s = INERTIA * 2.0 * math.pi * 50.0 / 0.05
    assert run.status == "standstill"
    assert run.t_end_s == pytest.approx(stands_s, rel=1e-6)
    assert [(event["kind"], event["speed_Hz"]) for event in run.events] == [("standstill", 0.0)]
    assert run.events[0]["t_s"] == pytest.approx(stands_s, rel=1e-6)
    assert exit_code(run.status) == 0


def test_the_top_speed_is_where_the_torque_falls_to_the_load(tmp_path: Path) -> None:
    """0.05 N m for 0.2 s, then to nothing within 10 ms, against 0.01 N m."""
    torque = [["0 s", "0.05 N*m"], ["0.2 s", "0.05 N*m"], ["0.21 s", "0 N*m"]]
    drive = {"torque": torque, "load": "0.01 N*m", "duration": "0.5 s"}
    run = frbcli.runup(case_from_dict(MACHINE | {"drive": drive}, "top"), tmp_path / "run.h5")
    (event,) = run.events
    assert event["kind"] == "top-speed"
    assert event["t_s"] == pytest.approx(0.208, abs=2e-4)
    assert event["speed_Hz"] == pytest.approx((0.04 * 0.2 + 0.5 * 0.04 * 0.008) / INERTIA / (2.0 * math.pi), rel=1e-5)


def test_a_moment_of_a_driven_run_keeps_its_drive() -> None:
    driven = case_from_dict(MACHINE, "drive")
    given = case_from_dict(
        {key: table for key, table in MACHINE.items() if key != "drive"}
        | {"speed": {"from": 0, "to": "10 Hz", "duration": "0.5 s"}},
        "given",
    )
    moment = moment_of_run(driven)
    assert moment.drive is not None
    assert (moment.drive.torque, moment.drive.duration) == (TORQUE, 1e-3)
    assert machine_kernels(driven, ()) != machine_kernels(given, ())


def test_the_plan_names_the_drive_and_its_top_speed() -> None:
    drive = {"torque": "0.05 N*m", "load": {"linear": "1e-4 N*m*s"}, "to": "40 Hz", "duration": "20 s"}
    told = {made.choice: made.value for made in make_plan(case_from_dict(MACHINE | {"drive": drive}, "plan")).decisions}
    assert (told["speed"], told["drive"], told["load"]) == ("free", "0.05 N*m", "0.0001 N*m*s")
    assert told["governor"] == "40 Hz"
    drive = {"torque": [["0 s", "0.1 N*m"], ["0.1 s", "0.1 N*m"]], "duration": "0.3 s"}
    reasons = {made.choice: made.reason for made in make_plan(case_from_dict(MACHINE | {"drive": drive})).decisions}
    assert reasons["drive"] == "2 points over the time, 0 to 0.1 s, constant beyond"
    slope = TORQUE / (0.02 * 80.0 * math.pi)  # N m s: by how much the governor takes the torque away
    assert float(told["top speed"].split()[0]) == pytest.approx(40.0 * slope / (slope + BRAKES), rel=1e-3)


def test_oil_brakes_a_coasting_rotor_by_the_law_of_petroff(tmp_path: Path) -> None:
    """On both journals pi mu D^3 B omega / (2 C) where they are in their middles, and 1 / sqrt(1 - eps^2) of it beside
    them; the pressure adds less than 1 % below an eccentricity of 0.2."""
    case = frbcli.load_case("coast-down", ["drive.duration=2 s", "output.step=1 ms"])
    run = frbcli.runup(case, tmp_path / "run.h5")
    film, omega = case.films[0], 2.0 * math.pi * run["speed_Hz"]
    centred = math.pi * case.oil.viscosity * film.diameter**3 * 0.02 * omega / (2.0 * film.clearance)
    over = run["friction_torque_N_m"] / centred * np.sqrt(1.0 - run["eccentricity"] ** 2)
    assert 0.9999 < over.min() <= over.max() < 1.01
    # beside it, 1 and 0.1 N s/m of damping take nothing from the rotation
    gone = case.polar_inertia * (omega[0] - omega[-1])
    assert gone == pytest.approx(np.trapezoid(run["friction_torque_N_m"], run["time_s"]), rel=1e-4)


# A Jeffcott rotor on springs whose shaft is damped inside and outside of it; its speed is free
INSIDE = {
    "rotor": {"kind": "jeffcott", "mass": "6 kg", "journal_mass": "0.5 kg", "shaft_stiffness": "2e6 N/m",
              "gravity": 0.0, "unbalance": "60 g*mm", "internal_damping": "40 N*s/m", "external_damping": "60 N*s/m",
              "polar_inertia": "0.002 kg*m^2"},
    "bearing": {"kind": "coefficients", "stiffness": "4e6 N/m", "damping": "200 N*s/m"},
    "drive": {"torque": "2 N*m", "load": "1e-3 N*m*s", "start": "60 Hz", "duration": "0.4 s", "reaction": True},
    "accuracy": {"tolerance": 1e-8},
}  # fmt: skip


def test_internal_damping_acts_on_the_rotation(tmp_path: Path) -> None:
    """Against an integration of all equations, in which no energy is lost but in the dampers: what the rotation gives
    to the whirl through the shaft is the damping seen on the shaft."""
    case = case_from_dict(INSIDE, "inside")
    rotor = make_rotor(case, free_speed=True)
    inside = shaft_of(case).body().internal
    n = rotor.size - 1
    fixed, quarter = np.kron(np.eye(2), inside), np.kron([[0.0, -1.0], [1.0, 0.0]], np.eye(n // 2))
    at_rest = rotor.over_speed.at(0.0)
    mass, stiffness = rotor.mass[:n, :n], rotor.stiffness[:n, :n] + at_rest[0][:n, :n]
    outer = rotor.damping[:n, :n] + at_rest[1][:n, :n] - fixed
    cos, sin = rotor.unbalance_cos[:n], rotor.unbalance_sin[:n]
    inertia, torque, load = 0.002, 2.0, 1e-3

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        q, v, angle, omega = state[:n], state[n : 2 * n], state[2 * n], state[2 * n + 1]
        arm, ahead = np.cos(angle) * cos + np.sin(angle) * sin, np.cos(angle) * sin - np.sin(angle) * cos
        slip = v - omega * quarter @ q
        # the unbalance pulls with d2/dt2 (C sin - S cos), and its arm is pulled by the acceleration in turn
        matrix = np.block([[mass, -arm[:, None]], [-arm[None], np.array([[inertia]])]])
        force = -outer @ v - fixed @ slip - stiffness @ q + omega**2 * ahead
        on_rotation = torque - load * omega + (quarter @ q) @ fixed @ slip
        a = np.linalg.solve(matrix, np.append(force, on_rotation))
        losses = v @ outer @ v + slip @ fixed @ slip
        return np.concatenate([v, a[:n], [omega, a[n], (torque - load * omega) * omega - losses]])

    start = np.zeros(2 * n + 3)
    start[2 * n + 1] = TURN * 60.0
    end = solve_ivp(rate, (0.0, 0.4), start, "DOP853", rtol=1e-10, atol=1e-14)
    q, v, angle, omega, work = np.split(end.y[:, -1], [n, 2 * n, 2 * n + 1, 2 * n + 2])
    arm = np.cos(angle) * cos + np.sin(angle) * sin
    energy = 0.5 * (v @ mass @ v + q @ stiffness @ q) - omega[0] * (arm @ v)
    energy += 0.5 * inertia * (omega[0] ** 2 - start[2 * n + 1] ** 2)
    assert energy == pytest.approx(work[0], rel=1e-7)
    run = frbcli.runup(case, tmp_path / "run.h5")
    assert TURN * run["speed_Hz"][-1] == pytest.approx(omega[0], rel=1e-6)


def test_a_thrust_bearing_brakes_a_coasting_rotor(tmp_path: Path) -> None:
    """J omega' = -T(omega) with the torque of the sheet, down to the speed at which no film carries the load."""
    inertia = 5e-6
    thrust = {"inner_radius": "6 mm", "outer_radius": "12 mm", "pads": 4, "pad_angle": "70 deg",
              "taper_angle": "50 deg", "taper": "30 um", "side": "right"}  # fmt: skip
    case = case_from_dict(
        {
            "rotor": MACHINE["rotor"] | {"polar_inertia": f"{inertia} kg*m^2"},
            "bearing": MACHINE["bearing"],
            "oil": {"viscosity": "10 mPa*s", "density": "850 kg/m^3"},
            "thrust_bearing": [thrust],
            "axial": {"load": "20 N"},
            "drive": {"start": "800 Hz", "duration": "0.5 s"},
        },
        "thrust",
    )
    run = frbcli.runup(case, tmp_path / "run.h5")
    collar = collar_of(case)
    assert collar is not None
    exact = solve_ivp(lambda _, omega: [-collar.rest(float(omega[0])).torque / inertia], (0.0, run.t_end_s),
                      [TURN * 800.0], rtol=1e-8)  # fmt: skip
    assert TURN * run["speed_Hz"][-1] == pytest.approx(float(exact.y[0, -1]), rel=1e-4)
    assert run["speed_Hz"][-1] < 600.0
    rest = collar.rest(TURN * run["speed_Hz"][-1])
    assert run["thrust_film_thickness_m"][-1] == pytest.approx(rest.gap, rel=1e-3)


# A rotor of free speed that rubs in a stop, and one on ball bearings whose friction is known
STOP, GAP, MU, RADIUS = 5e6, 30e-6, 0.15, 0.02  # N/m at each of two journals together, m, m
RUBS = {
    "rotor": {"kind": "rigid", "mass": "2 kg", "gravity": 0.0, "unbalance": "2e-4 kg*m",
              "polar_inertia": "5e-4 kg*m^2"},
    "bearing": {"kind": "coefficients", "stiffness": "5e5 N/m", "damping": "150 N*s/m"},
    "spring": [{"at": "journal", "stiffness": f"{0.5 * STOP!r} N/m", "gap": f"{GAP!r} m", "friction": MU,
                "radius": f"{RADIUS!r} m"}],
    "drive": {"start": "100 Hz", "duration": "0.1 s", "reaction": True},
    "accuracy": {"tolerance": 1e-8},
}  # fmt: skip


def test_a_stop_takes_from_the_rotation_what_its_friction_loses(tmp_path: Path) -> None:
    """Against an integration in which the energy of motion, rotation and springs falls by dampers and sliding alone:
    with mu N against u = R omega + v_t the stop takes mu N u."""
    mass, stiffness, damping, unbalance, inertia = 2.0, 1e6, 300.0, 2e-4, 5e-4

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        q, angle, v, omega = state[:2], state[2], state[3:5], state[5]
        s, c = math.sin(angle), math.cos(angle)
        r = float(np.hypot(*q))
        n = q / max(r, 1e-300)
        t = np.array([-n[1], n[0]])
        pushed = STOP * max(r - GAP, 0.0)
        sliding = RADIUS * omega + t @ v
        rub = MU * math.tanh(sliding / STICKS)
        force = -stiffness * q - damping * v - pushed * (n + rub * t)
        matrix = np.array([[mass, 0.0, -unbalance * c], [0.0, mass, -unbalance * s],
                           [-unbalance * c, -unbalance * s, inertia]])  # fmt: skip
        right = [force[0] - unbalance * omega**2 * s, force[1] + unbalance * omega**2 * c, -RADIUS * rub * pushed]
        lost = damping * v @ v + rub * pushed * sliding
        return np.concatenate([v, [omega], np.linalg.solve(matrix, right), [lost]])

    begin = np.array([0.0, 0.0, 0.0, 0.0, 0.0, TURN * 100.0, 0.0])
    end = solve_ivp(rate, (0.0, 0.1), begin, "DOP853", rtol=1e-11, atol=1e-14, max_step=1e-4).y[:, -1]
    q, v, omega = end[:2], end[3:5], end[5]
    arm = np.array([math.cos(end[2]), math.sin(end[2])])
    beyond = max(float(np.hypot(*q)) - GAP, 0.0)
    energy = 0.5 * (mass * v @ v + stiffness * q @ q + inertia * omega**2 + STOP * beyond**2)
    energy -= unbalance * omega * arm @ v
    first = 0.5 * inertia * begin[5] ** 2
    assert energy + end[6] == pytest.approx(first, rel=1e-6)
    assert end[6] > 0.1 * first
    run = frbcli.runup(case_from_dict(RUBS, "rubs"), tmp_path / "run.h5")
    assert TURN * run["speed_Hz"][-1] == pytest.approx(omega, rel=1e-6)
    assert run["friction_torque_N_m"].max() > 0.1


BALLS = {"kind": "ball", "balls": 9, "ball_diameter": "4 mm", "pitch_diameter": "20 mm", "contact_angle": "20 deg",
         "preload": "80 N", "damping": "100 N*s/m"}  # fmt: skip


def on_balls(friction: dict[str, object], start: str, duration: str, **bearing: object) -> frbcli.Case:
    data = {"rotor": MACHINE["rotor"] | {"polar_inertia": "4e-5 kg*m^2"},
            "bearing": BALLS | {"friction": friction} | bearing,
            "drive": {"start": start, "duration": duration}}  # fmt: skip
    return case_from_dict(data, "balls")


def test_loaded_balls_brake_a_rotor_that_also_moves(tmp_path: Path) -> None:
    """J omega' = T - 2 f_1 D F with unbalance and weight: the sum F of the ball loads hardly changes with them."""
    case = on_balls({"f1": 1e-3}, "1 Hz", "0.05 s")
    case = case.with_settings("rotor.unbalance=5e-6 kg*m", "rotor.gravity=9.81 m/s^2", "rotor.mass=2 kg",
                              "rotor.polar_inertia=1e-3 kg*m^2", "drive.torque=0.05 N*m")  # fmt: skip
    run = frbcli.runup(case, tmp_path / "run.h5")
    braked = 2.0 * 1e-3 * 0.02 * 80.0 / math.sin(run["ball_contact_angle_rad"][-1])
    assert run.status == "finished"
    assert run["speed_Hz"][-1] == pytest.approx(1.0 + (0.05 - braked) / 1e-3 * 0.05 / TURN, rel=0.02)


@pytest.mark.parametrize("rows", ["single", "tandem"])
def test_loaded_balls_brake_a_rotor_until_it_stands(rows: str, tmp_path: Path) -> None:
    """Both bearings by f_1 D F, F = Fa / sin(alpha) on each row at low speeds: omega falls linearly."""
    run = frbcli.runup(on_balls({"f1": 8e-4}, "40 Hz", "3 s", arrangement=rows), tmp_path / "run.h5")
    loads = 80.0 / math.sin(run["ball_contact_angle_rad"][-1]) * (1 if rows == "single" else 2)
    braked = 2.0 * 8e-4 * 0.02 * loads
    assert run.status == "standstill"
    assert run["friction_torque_N_m"][-1] == pytest.approx(braked, rel=1e-6)
    assert run.t_end_s == pytest.approx(4e-5 * TURN * 40.0 / braked, rel=1e-3)  # centrifugal forces relieve the balls
    gone = cumulative_simpson(run["friction_torque_N_m"] * TURN * run["speed_Hz"], x=run["time_s"])[-1]
    assert gone == pytest.approx(0.5 * 4e-5 * (TURN * 40.0) ** 2, rel=1e-6)


def test_a_lubricant_brakes_balls_with_the_two_thirds_power_of_the_speed(tmp_path: Path) -> None:
    """Palmgren's M_0 = 1e-7 f_0 (nu n)^(2/3) D^3, N mm of mm^2/s, rpm, mm: the cube root of the speed falls evenly."""
    run = frbcli.runup(on_balls({"f0": 1.5, "viscosity": "20 mm^2/s"}, "800 Hz", "1 s"), tmp_path / "run.h5")
    at_start = 1e-3 * 1e-7 * 1.5 * (20.0 * 60.0 * 800.0) ** (2.0 / 3.0) * 20.0**3  # N m of one bearing
    fall = 2.0 * at_start / 4e-5 / (TURN * 800.0) / 3.0  # 1/s
    np.testing.assert_allclose(run["speed_Hz"], 800.0 * (1.0 - fall * run["time_s"]) ** 3, rtol=1e-6)
