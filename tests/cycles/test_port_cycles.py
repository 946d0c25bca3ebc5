"""Limit cycles with forces that are not linear besides those of films, and with coefficients over the speed."""

import math
from pathlib import Path

import numpy as np
import pytest
from marches import planned_system
from scipy.interpolate import CubicSpline

import frbcli
from frbcli.case.reading.load import load_case_text
from frbcli.case.schema import Case
from frbcli.cycles.columns import CyclePoint, LimitCycles
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.cycles.shooting.period_map import period_map
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting
from frbcli.errors import InputError
from frbcli.linear.stability import stability
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import CYCLES, SPEED_CYCLES, WHIRLS

STILL = ["rotor.gravity=0", "rotor.unbalance=0 g*mm"]
STIFFNESS, DAMPING, MASS, CUBIC, SHARE = 1e6, 300.0, 6.0, 1e15, 0.8
STOP = 'spring=[{at="disk", stiffness="1e7 N/m", gap="30 um"}]'


def ball(cage: str) -> list[str]:
    """The rotor of `seal` on two ball bearings, its seals with q = 0.8 C Omega up to 1000 Hz."""
    q, none = SHARE * DAMPING * 2.0 * math.pi * 1000.0, '["0 N/m", "0 N/m"]'
    undamped = ", ".join(f'{key} = ["0 N*s/m", "0 N*s/m"]' for key in ("cxx", "cxy", "cyx", "cyy"))
    over = (
        f'{{speed = ["0 Hz", "1000 Hz"], kxx = {none}, kyy = {none}, kxy = ["0 N/m", "{q} N/m"], '
        f'kyx = ["0 N/m", "{-q} N/m"], {undamped}}}'
    )
    mount = (
        '{kind = "ball", name = "mount", balls = 8, ball_diameter = "3.175 mm", pitch_diameter = "14 mm", '
        'contact_angle = "15 deg", inner_curvature = 0.53, outer_curvature = 0.53, preload = "60 N", '
        f'damping = "{DAMPING} N*s/m", cage = "{cage}"}}'
    )
    return [*STILL, f'bearing=[{mount}, {{kind = "coefficients", name = "seal", over_speed = {over}}}]']


def test_a_branch_that_ends_early_does_not_deny_cycles_beyond() -> None:
    """As below, with a soft spring: at 138 Hz the rotor whirls at 20 times its length, where no branch was followed."""
    spring = f'spring=[{{at="journal", cubic="{0.01 * CUBIC} N/m^3"}}]'
    diagram = frbcli.limit_cycles(
        frbcli.load_case("seal", [*STILL, spring, "speed.from=105 Hz", "speed.to=140 Hz"]), [138.0]
    )
    assert "goes on" in diagram.branches[0].note
    assert "No cycle of those that were followed is at 138 Hz." in diagram.notes


@pytest.mark.parametrize("springs", [1, 2])
def test_a_cubic_spring_has_the_frequency_of_its_amplitude_in_a_whirl(springs: int) -> None:
    """`seal`: q = C nu across a circle of the radius r, and m nu^2 = 2 (K + c r^2) along it, so that nu = 0.8 Omega;
    the same with c of two springs."""
    spring = f'{{at="journal", cubic="{CUBIC / springs} N/m^3"}}'
    spring = f"spring=[{', '.join([spring] * springs)}]"
    case = frbcli.load_case("seal", [*STILL, spring, "speed.from=105 Hz", "speed.to=140 Hz"])
    diagram = frbcli.limit_cycles(case, [130.0])
    assert diagram.films == ("spring_1", "spring_2")[:springs]
    (hopf,), (branch,) = diagram.special, diagram.branches
    whirl = math.sqrt(2.0 * STIFFNESS / MASS) / (2.0 * math.pi)
    assert hopf.speed_Hz == pytest.approx(whirl / SHARE, rel=2e-6)
    assert hopf.criticality == "supercritical"
    port = planned_system(case).rotor.ports[-1]
    cycles = branch.points[1:]
    assert any(point.kind == "asked" for point in cycles)
    for point in cycles:
        nu = 2.0 * math.pi * point.frequency_Hz
        assert point.frequency_Hz == pytest.approx(SHARE * point.speed_Hz, rel=1e-7)
        radius = math.sqrt((0.5 * MASS * nu**2 - STIFFNESS) / CUBIC)
        # of the small ones the square of the radius is a small difference
        assert point.eccentricity_max[-1] == pytest.approx(radius / port.law.length, rel=1e-6, abs=1e-4)
        assert point.stable
        assert abs(point.multipliers[0] - 1.0) < 2e-5


def test_a_whirl_in_ball_bearings_has_their_force_over_its_amplitude() -> None:
    """m nu^2 r = 2 F(r) with nu = 0.8 Omega: a bearing softens until balls leave their races, so that the whirl begins
    hard and turns back in a fold. The force goes by r alone but for the number of balls, 5e-4 of it."""
    case = frbcli.load_case("seal", [*ball("mean"), "speed.from=510 Hz", "speed.to=800 Hz"])
    diagram = frbcli.limit_cycles(case)
    (port,) = planned_system(case).rotor.ports
    (hopf,), (fold,) = diagram.of("hopf"), diagram.of("fold")
    assert hopf.criticality == "subcritical"
    assert fold.speed_Hz < 0.7 * hopf.speed_Hz
    points = diagram.branches[0].points[1:]
    assert not points[0].stable
    assert points[-1].stable
    for point in points:
        nu, r = 2.0 * math.pi * point.frequency_Hz, float(point.eccentricity_max[0]) * port.law.length
        force = -port.law.plainly(np.array([r, 0.0, 0.0, 0.0, nu / SHARE, 0.0]))[0]
        assert MASS * nu**2 * r == pytest.approx(2.0 * force, rel=5e-4)
        assert point.frequency_Hz == pytest.approx(SHARE * point.speed_Hz, rel=1e-5)


def test_shooting_finds_what_harmonic_balance_finds() -> None:
    """`jeffcott` with a spring that hardly pushes: to 1e-5 Hopf point, fold and cycles of the same rotor without it."""
    range_, spring = ["speed.from=169 Hz", "speed.to=178 Hz"], 'spring=[{at="journal", cubic="1 N/m^3"}]'
    cases = (frbcli.load_case("jeffcott", [*range_, *more]) for more in ([], [spring]))
    own, shot = (frbcli.limit_cycles(case, [174.0]) for case in cases)
    for kind in ("hopf", "fold"):
        (one,), (other,) = own.of(kind), shot.of(kind)
        assert other.speed_Hz == pytest.approx(one.speed_Hz, rel=1e-6)
        assert other.frequency_Hz == pytest.approx(one.frequency_Hz, rel=1e-5)
        assert other.criticality == one.criticality
    asked, again = ([p for p in each.branches[0].points if p.kind == "asked"] for each in (own, shot))
    assert len(asked) == len(again) == 2
    for one, other in zip(asked, again, strict=True):
        assert other.frequency_Hz == pytest.approx(one.frequency_Hz, rel=1e-6)
        assert other.eccentricity_max[0] == pytest.approx(one.eccentricity_max[0], rel=1e-5)
        assert other.stable == one.stable
        np.testing.assert_allclose(other.multipliers[:3], one.multipliers[:3], atol=1e-4)


def test_a_whirl_in_a_stop_is_that_of_a_run(tmp_path: Path) -> None:
    """`jeffcott` at 190 Hz, its disk in a stop of 30 um: frequency and eccentricity of a run after 1.5 s."""
    case = frbcli.load_case("jeffcott", [STOP, *STILL[1:], "speed.from=175 Hz", "speed.to=195 Hz"])
    (cycle,) = [p for p in frbcli.limit_cycles(case, [190.0]).branches[0].points if p.kind == "asked" and p.stable]
    constant = ["speed.from=190 Hz", "speed.to=190 Hz", "speed.duration=2 s", "output.step=2e-5 s"]
    constant += ["accuracy.tolerance=1e-8", "accuracy.steps_per_revolution=200", "start.displacement=[0.3, -0.3]"]
    run = frbcli.runup(frbcli.load_case("jeffcott", [STOP, *STILL[1:], *constant]), tmp_path / "run.h5").signals
    last = slice(-20000, None)
    time, y = np.asarray(run["time_s"])[last], np.asarray(run["journal_y_m"])[last]
    motion = CubicSpline(time, y - y.mean())
    rising = [t for t in motion.roots(extrapolate=False) if motion(t, 1) > 0.0]
    assert cycle.frequency_Hz == pytest.approx((len(rising) - 1) / (rising[-1] - rising[0]), rel=1e-5)
    assert cycle.eccentricity_max[0] == pytest.approx(np.asarray(run["eccentricity"])[last].max(), rel=1e-4)
    assert np.hypot(run["stop_force_1_x_N"], run["stop_force_1_y_N"])[last].max() > 5.0
    assert cycle.eccentricity_max[0] < 0.6  # without the stop 0.93


def test_a_cage_that_turns_has_no_cycles() -> None:
    with pytest.raises(InputError, match="no period holds both frequencies"):
        frbcli.limit_cycles(frbcli.load_case("seal", [*ball("turning"), "speed.from=510 Hz", "speed.to=800 Hz"]))


def test_springs_that_are_not_linear_have_diagrams_over_the_speed_alone() -> None:
    with pytest.raises(InputError, match="Go over the speed alone"):
        frbcli.limit_cycles_over(frbcli.load_case("jeffcott", [STOP]), "oil.viscosity", "8 mPa*s", "14 mPa*s", 190.0)


MACHINE = """
[rotor]
kind = "jeffcott"
mass = "6 kg"
journal_mass = "100 g"
shaft_stiffness = "5000 N/mm"
[[bearing]]
kind = "single-film"
width = "20 mm"
diameter = "25 mm"
clearance = "35 um"
ends = "free-to-air"
supply = { kind = "circumferential-groove", pressure = "1 bar" }
[[bearing]]
kind = "coefficients"
name = "seal"
%s
[oil]
viscosity = "12 mPa*s"
density = "830 kg/m^3"
ambient_pressure = "1 bar"
cavitation_pressure = "1 bar"
[film]
theory = "short"
[speed]
from = "170 Hz"
to = "200 Hz"
duration = "1 s"
"""
CELLS = "film.cavitation=reynolds", "film.theory=auto", "film.solution=cells", "accuracy.mesh=[2, 24]"
LOW, HIGH = (2e5, 5e4, 20.0), (8e5, 2e5, 60.0)  # at 160 and 200 Hz: direct and cross-coupled N/m, N s/m


def at(speed: float) -> tuple[float, float, float]:
    share = (speed - 160.0) / 40.0
    k, q, c = (low + share * (high - low) for low, high in zip(LOW, HIGH, strict=True))
    return k, q, c


def tables(*pairs: tuple[float, tuple[float, float, float]]) -> str:
    rows = {
        "speed": [f"{speed} Hz" for speed, _ in pairs],
        **{key: [f"{k} N/m" for _, (k, _, _) in pairs] for key in ("kxx", "kyy")},
        **{key: [f"{sign * q} N/m" for _, (_, q, _) in pairs] for key, sign in (("kxy", 1.0), ("kyx", -1.0))},
        **{key: [f"{c} N*s/m" for _, (_, _, c) in pairs] for key in ("cxx", "cyy")},
        **{key: ["0 N*s/m"] * len(pairs) for key in ("cxy", "cyx")},
    }
    return "[bearing.over_speed]\n" + "\n".join(f"{key} = {values!r}" for key, values in rows.items())


def constant(k: float, q: float, c: float) -> str:
    return f'stiffness = [["{k} N/m", "{q} N/m"], ["{-q} N/m", "{k} N/m"]]\ndamping = "{c} N*s/m"'


def case(coefficients: str, *settings: str) -> Case:
    return load_case_text(MACHINE % coefficients, settings)


def asked(found: LimitCycles, speed: float) -> CyclePoint:
    (point,) = (p for b in found.branches for p in b.points if p.kind == "asked" and abs(p.speed_Hz - speed) < 1e-6)
    return point


def test_a_cycle_is_that_of_the_machine_with_the_coefficients_of_its_speed() -> None:
    near = "speed.from=193.5 Hz", "speed.to=195 Hz"
    found = limit_cycles(case(tables((160.0, LOW), (200.0, HIGH)), *near), [194.0])
    (hopf,) = found.of("hopf")
    alone = limit_cycles(case(constant(*at(194.0)), "speed.from=193 Hz", "speed.to=195 Hz"), [194.0])
    ours, others = asked(found, 194.0), asked(alone, 194.0)
    assert ours.frequency_Hz == pytest.approx(others.frequency_Hz, rel=1e-9)
    assert ours.eccentricity_max == pytest.approx(others.eccentricity_max, rel=1e-6)
    assert ours.multipliers[1:3] == pytest.approx(others.multipliers[1:3], rel=1e-6)
    (alone,) = limit_cycles(case(constant(*at(hopf.speed_Hz)), *near)).of("hopf")
    assert alone.speed_Hz == pytest.approx(hopf.speed_Hz, rel=1e-8)
    assert alone.frequency_Hz == pytest.approx(hopf.frequency_Hz, rel=1e-8)
    assert np.isfinite(hopf.lyapunov)


def test_the_map_over_a_period_has_the_coefficients_of_its_speed() -> None:
    """As of a machine with these coefficients, and of one with another speed's as a check; with a damping that turns,
    c dx/dt + c omega x across it. Of films on cells, too, to what differences on cells leave."""
    omega = 2.0 * math.pi * 194.0
    turning = "rotor.internal_damping=100 N*s/m"
    table, alone = tables((160.0, LOW), (200.0, HIGH)), constant(*at(194.0))
    for settings, close in (((), 1e-7), (CELLS, 5e-4)):
        eigenvalues = [
            settled(Shooting(period_map(case(seal, *settings, *more)), omega), omega).eigenvalues[0]  # type: ignore[union-attr]
            for seal, more in ((table, ()), (alone, ()), (constant(*at(190.0)), ()), (alone, (turning,)))
        ]
        assert eigenvalues[0] == pytest.approx(eigenvalues[1], rel=close)
        assert abs(eigenvalues[2] - eigenvalues[1]) > 1e-3 * omega
        assert eigenvalues[3].real > eigenvalues[1].real  # above the natural frequency it drives
    linear = stability(case(alone, turning), [194.0]).points[0].eigenvalues
    own = settled(Shooting(period_map(case(alone, turning)), omega), omega)
    assert own is not None
    assert min(abs(linear - own.eigenvalues[0])) < 1e-6 * omega


def test_films_on_cells_have_cycles_beside_what_depends_on_the_speed() -> None:
    settings = *CELLS, "rotor.internal_damping=100 N*s/m", "rotor.unbalance=3 g*mm"
    machine = case(tables((160.0, LOW), (200.0, HIGH)), *settings)
    assert faults(machine, SPEED_CYCLES) == []
    assert faults(machine, WHIRLS) == []
    assert "constant coefficients" in faults(machine, CYCLES)[0].problem
