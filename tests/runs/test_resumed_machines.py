"""Runs of machines that tilt or move along their axis: interrupted and resumed they are those in one piece."""

from __future__ import annotations

from pathlib import Path

import pytest
from marches import rigid_shaft
from resumed import assert_resumable

from frbcli.case.reading.load import case_from_dict

LOOKS = 8  # steps between two looks at the clock
TIMES = ("speed.from=250 Hz", "speed.duration=10 ms", "output.step=50 us")
CELLS = ("film.solution=cells", "accuracy.mesh=[4, 24]")
TILT = (*CELLS, "film.tilt=follows")
FED = tuple(f'bearing.{side}.supply={{kind="circumferential-groove", pressure="2 bar"}}' for side in (0, 1))
COLLAR = (
    'thrust_bearing=[{position="2 mm", inner_radius="5.5 mm", outer_radius="11 mm", pads=4, pad_angle="75 deg", '
    'taper_angle="50 deg", taper="20 um", end_play="100 um"}]',
    'axial.load=[["0 s", "10 N"], ["4 ms", "20 N"], ["10 ms", "12 N"]]',
)
HEAT = ('oil.viscosity={grade="SAE 10W-40"}', "thermal.supply_temperature=60 degC", "thermal.housing=70 degC")
MACHINES = {
    "collar and heat": ("film.theory=short", *COLLAR, *HEAT),
    "tilt and oil": (*TILT, "film.cavitation=elrod", *FED),
    "tilt and collar": (*TILT, *COLLAR),
}


@pytest.mark.parametrize(
    "settings",
    [  # what goes on of tilts and of a collar goes on of both
        pytest.param(settings, id=name, marks=[pytest.mark.nightly] * (name != "tilt and collar"))
        for name, settings in MACHINES.items()
    ],
)
def test_a_resumed_run_is_bit_equal(settings: tuple[str, ...], tmp_path: Path) -> None:
    assert_resumable(rigid_shaft(*TIMES, *settings), tmp_path, 2e-3, 5e-3, steps=LOOKS)


def test_a_resumed_run_of_a_free_speed_is_bit_equal(tmp_path: Path) -> None:
    """Its speed and angle are part of the state: a torque that changes, a load, the reaction of the whirl."""
    data = {
        "rotor": {"kind": "rigid", "mass": "6 kg", "unbalance": "2 g*m", "polar_inertia": "0.02 kg*m^2"},
        "bearing": {"kind": "coefficients", "stiffness": "2e6 N/m", "damping": "100 N*s/m"},
        "drive": {"torque": [["0 s", "30 N*m"], ["0.2 s", "10 N*m"]], "load": "1e-3 N*m*s", "duration": "0.2 s",
                  "start": "20 Hz", "reaction": True},
    }  # fmt: skip
    assert_resumable(case_from_dict(data, "driven"), tmp_path, 0.05, 0.12, steps=LOOKS)
