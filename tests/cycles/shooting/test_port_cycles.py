"""Limit cycles with forces besides those of films that are not linear: springs, stops and ball bearings."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import frbcli
from frbcli.errors import InputError
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

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
    port = make_system(case, make_plan(case)).rotor.ports[-1]
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
    (port,) = make_system(case, make_plan(case)).rotor.ports
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
