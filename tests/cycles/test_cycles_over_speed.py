"""Limit cycles beside bearings whose coefficients depend on the speed."""

import math

import numpy as np
import pytest

from frbcli.case.reading.load import load_case_text
from frbcli.case.schema import Case
from frbcli.cycles.columns import CyclePoint, LimitCycles
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.cycles.shooting.period_map import period_map
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting
from frbcli.linear.stability import stability
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import CYCLES, SPEED_CYCLES, WHIRLS

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
