"""A rotor whose speed is free: closed form of J omega' = T - c omega, and refusals."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.errors import InputError
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import CYCLES, LADDER, RUN

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


def test_a_given_and_a_free_speed_exclude_each_other() -> None:
    with pytest.raises(InputError, match="beside"):
        case_from_dict(MACHINE | {"speed": {"from": 0, "to": 1, "duration": 1}}, "both")


def test_analyses_at_given_speeds_refuse_a_free_one() -> None:
    case = case_from_dict(MACHINE, "drive")
    assert not faults(case, RUN)
    assert all("drive" in [fault.key for fault in faults(case, analysis)] for analysis in (CYCLES, LADDER))
