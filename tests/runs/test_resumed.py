"""Runs of machines that tilt, move along their axis or drive themselves: interrupted, or killed at random times, they
are those in one piece."""

import multiprocessing
import random
import signal
import time
from dataclasses import dataclass
from pathlib import Path

import pytest
from marches import rigid_shaft
from resumed import assert_resumable, assert_same

import frbcli.runs.run as solve_run
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.results.store import read_run
from frbcli.runs import march
from frbcli.runs.run import runup

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


@dataclass(frozen=True)
class Machine:
    """A case that takes some seconds; kills: how often; budget: steps between two looks at the clock."""

    name: str
    base: str
    settings: tuple[str, ...]
    kills: int
    budget: int


SHORTEST_LIFE_s = 0.3  # a process has read its case and its run by then
SHORTEST_TIMER_s = 1e-3  # a timer of no time never ends
SHORT = ("film.theory=short", "speed.to=200 Hz", "speed.duration=40 s", "output.step=3 ms")
ON_CELLS = ("speed.from=100 Hz", "speed.to=110 Hz", "speed.duration=2 s", "output.step=1 ms")
APART = ("film.coupling=co-simulation", "accuracy.macro_step=1e-6 s", "speed.from=50 Hz", "speed.to=60 Hz",
         "speed.duration=0.2 s", "output.step=1 ms")  # fmt: skip
KILLED = [
    Machine("table", "jeffcott", SHORT, 30, 400),
    Machine("cells", "axial-groove-two-phase", ON_CELLS, 12, 20),
    Machine("co-simulation", "jeffcott", APART, 12, 400),
]


def go_on(machine: Machine, path: Path, life: float) -> None:
    """Go on with the run, with a checkpoint after each look at the clock, until a signal ends the process.

    life: CPU time in s, which is the same part of a run on a busy machine.
    """
    signal.setitimer(signal.ITIMER_PROF, life)
    solve_run.CHECKPOINT_EVERY_s, solve_run.CHECKPOINT_SHARE = 0.0, 1.0
    runup(load_case(machine.base, machine.settings), path, resume=True)


@pytest.mark.nightly
@pytest.mark.parametrize("machine", KILLED, ids=lambda machine: machine.name)
def test_killed_at_random_times_it_resumes_to_equal_results(
    machine: Machine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The error that a run states is read at each look at the clock: all have to look at the same steps.
    monkeypatch.setattr(march, "BUDGET", machine.budget)
    case = load_case(machine.base, machine.settings)
    runup(case, tmp_path / "first.h5")  # compiled or loaded, then it is quick
    begun = time.process_time()
    whole = runup(case, tmp_path / "whole.h5")
    pace, chance = max(SHORTEST_LIFE_s, (time.process_time() - begun) / 2), random.Random(11)
    context = multiprocessing.get_context("fork")  # the kernels are loaded already
    killed, within = 0, 0
    while killed < machine.kills:
        path, reached = tmp_path / f"{killed}.h5", 0.0
        while killed < machine.kills and not (path.exists() and read_run(path).status == "finished"):
            process = context.Process(target=go_on, args=(machine, path, chance.uniform(SHORTEST_TIMER_s, pace)))
            process.start()
            process.join()
            assert process.exitcode in (0, -signal.SIGPROF)
            killed += process.exitcode != 0
            now = read_run(path).t_end_s if path.exists() else 0.0
            assert now >= reached
            within += now > reached
            reached = now
        assert_same(runup(case, path, resume=True), whole)
    assert within > machine.kills // 4  # the kills fell in the runs, not before them
    assert not list(tmp_path.glob("*.part"))
