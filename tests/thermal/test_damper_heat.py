"""Heat of squeeze film dampers: what squeezing dissipates, and the way of the heat through shell and damper."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from test_heat import single

from frbcli.equilibrium.static_machine import warm_machine
from frbcli.runs.run import runup
from frbcli.scene.machine.heat import heat_of

WIDTH, DIAMETER, CLEARANCE, MASS = 20e-3, 50e-3, 80e-6, 0.5
DAMPER = (
    'bearing.damper={width="20 mm", diameter="50 mm", clearance="80 um", mass="500 g", spring="2e6 N/m", '
    'cavitation="sommerfeld"}'
)
HOUSING = "thermal.housing=40 degC"
STEEL = 434.0  # J/(kg K)


def test_heat_passes_through_shell_and_damper_to_the_housing() -> None:
    """A damper at rest without supply neither heats nor feeds: film, shell, its film and housing lie in series."""
    case = single(DAMPER, HOUSING)
    found, heat = warm_machine(case, 200.0), heat_of(case)
    t = dict(zip(heat.nodes, found.steady.temperatures, strict=True))
    film, damper = found.films
    assert (damper.power, damper.flow) == (0.0, 0.0)
    oil = case.oil
    transfer = [3.77 * oil.thermal_conductivity / c * math.pi * d * b
                for c, d, b in ((35e-6, 25e-3, 20e-3), (CLEARANCE, DIAMETER, WIDTH))]  # fmt: skip
    passed = transfer[0] * (t["film"] - t["shell"])
    assert passed > 10.0
    assert transfer[1] * (t["shell"] - t["damper"]) == pytest.approx(passed, rel=1e-6)
    assert transfer[1] * (t["damper"] - t["housing"]) == pytest.approx(passed, rel=1e-6)
    assert found.steady.given == pytest.approx(passed, rel=1e-6)
    assert heat.model.capacity[heat.nodes.index("shell")] == pytest.approx(MASS * STEEL)
    assert film.temperature == t["film"]


@pytest.mark.nightly  # compiles a time loop that no other test has
def test_squeezing_heats_a_damper_by_the_closed_form(tmp_path: Path) -> None:
    """Power of a short film without rotation: pi eta R (B/C)^3 (r'^2 (1 + 2 eps^2)/(1 - eps^2)^2.5 + (r phi')^2/(1 -
    eps^2)^1.5), the integral of its pressure over the rate of the gap."""
    settings = ["rotor.unbalance=300 g*mm", "speed.from=250 Hz", "speed.to=250 Hz", "speed.duration=0.03 s"]
    run = runup(single(DAMPER, *settings, "output.step=1e-5 s"), tmp_path / "run.h5")
    t, x, y = (run[name] for name in ("time_s", "shell_x_m", "shell_y_m"))
    v_x, v_y, r = np.gradient(x, t), np.gradient(y, t), np.maximum(np.hypot(x, y), 1e-12)
    radial, across, rest = (x * v_x + y * v_y) / r, (x * v_y - y * v_x) / r, 1.0 - (r / CLEARANCE) ** 2
    damping = math.pi * run["viscosity_damper_Pa_s"] * 0.5 * DIAMETER * (WIDTH / CLEARANCE) ** 3
    power = damping * (radial**2 * (3.0 - 2.0 * rest) / rest**2.5 + across**2 / rest**1.5)
    late = t > 0.01
    assert np.max(r[late]) > 0.05 * CLEARANCE
    assert np.mean(run["power_damper_W"][late]) == pytest.approx(np.mean(power[late]), rel=5e-3)
    assert run["temperature_damper_K"][-1] > run["temperature_damper_K"][0]
    # the balance compares sums of heat, of which the temperatures are known to round-off of their absolute size
    temperature, steps = run["temperature_damper_K"], run.cost["steps"]
    round_off = np.finfo(float).eps * temperature[-1] / (temperature[-1] - temperature[0])
    assert run.error["heat_balance_relative"] < math.sqrt(steps) * round_off
