"""The gate: every public function that takes a case, and every command that takes CASE, refuses the same faulty cases
with the same sentence, before anything is computed. Both lists are made from the code."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from commands import Frb

import frbcli
from frbcli.case.schema import Case
from frbcli.cli.main import COMMANDS, command_named
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import InputError
from frbcli.scene.gate.gate import faults, require
from frbcli.scene.gate.rule import ALL
from frbcli.scene.machine.system import make_system

MOTION = 'motion = { eccentricity = 0.5, angle = "-60 deg", speed = "20 Hz", frequency = "20 Hz" }'
GROOVE = ("jeffcott", ("bearing.supply.axial_position=0.3",), "bearing.supply.axial_position = 0.3: is neither in the")
# Channels of a ring beside the end of a narrower outer film, a faulty opening that no rule of one table sees
BEYOND = (
    "floating-ring",
    ("bearing.channels=coupled", "bearing.inner.supply.axial_position=0.07", "bearing.outer.width=10 mm",
     "bearing.outer.supply.axial_position=0"),
    "out of the film of 0 to 10 mm",
)  # fmt: skip
DRY = ("jeffcott", ("bearing.supply={kind='none'}", "bearing.ends=free-to-air", "film.cavitation=elrod"),
       "both ends are free to air and nothing supplies oil")  # fmt: skip
APART = ("turbocharger-car", ("bearing.1.outer.supply.axial_position=0.3",), "bearing.1.outer.supply.axial_position")
FAULTY = pytest.mark.parametrize("faulty", [GROOVE, BEYOND, DRY, APART], ids=["groove", "beyond", "dry", "second"])
Faulty = tuple[str, tuple[str, ...], str]

FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "accuracy": (),
    "balance_quality": ("G2.5",),
    "bearing_sheet": ([20.0], 30.0),
    "compare": (),
    "critical_map": (),
    "damped_modes": (20.0,),
    "fit": (None, ["oil.viscosity"]),
    "limit_cycles": (),
    "limit_cycles_over": ("bearing.clearance", "30 um", "40 um", 200.0),
    "make_plan": (),
    "natural_modes": (),
    "response": (),
    "rotation": (),
    "rundown": ("run.h5",),
    "runup": ("run.h5",),
    "sommerfeld_chart": (),
    "squeeze": (),
    "stability": (),
    "stability_map": ("bearing.clearance", "30 um", "40 um"),
    "sweep": ({"speed.to": ["200 Hz", "210 Hz"]}, "study"),
    "warm_machine": (),
    "whirl": (),
}
WORDS: dict[str, tuple[str, ...]] = {
    "bearing": ("--load", "30 N", "--speed", "50 Hz"),
    "fit": ("--measured", "measured.csv", "--time", "t", "--speed-column", "n", "--x", "x", "--y", "y", "--clearance",
            "35 um", "--vary", "oil.viscosity"),
    "plot": ("--what", "law"),
    "sweep": ("--set", "speed.to=200 Hz,210 Hz"),
}  # fmt: skip
NO_CASE = {"balance", "waterfall", "report", "export", "schema"}  # of runs and measurements
THRUST = {"thrust", "thrust_sheet", "ball_bearing_sheet"}  # of bearings that have no film of these cases
TEXTS = {"cases", "docs"}  # copy texts, compute nothing


def public_functions() -> list[str]:
    """The public functions that take a case."""
    found = {name: getattr(frbcli, name) for name in frbcli.__all__}
    functions = {name: each for name, each in found.items() if inspect.isfunction(each) and name not in THRUST}
    return [name for name, each in functions.items() if _takes_a_case(each)]


def _takes_a_case(function: Callable[..., Any]) -> bool:
    return any(parameter.annotation in ("Case", Case) for parameter in inspect.signature(function).parameters.values())


def case_commands() -> list[str]:
    """The commands with an argument CASE."""
    return [name for name in COMMANDS if name not in THRUST and any(map(_is_case, command_named(name).params))]


def _is_case(parameter: click.Parameter) -> bool:
    return isinstance(parameter, click.Argument) and "CASE" in (parameter.metavar or "")


def test_every_function_and_command_has_its_trial() -> None:
    assert set(public_functions()) == set(FUNCTIONS)
    assert set(COMMANDS) - set(case_commands()) == NO_CASE | TEXTS | (THRUST & set(COMMANDS))


@FAULTY
@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_refuse(name: str, faulty: Faulty, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    source, settings, sentence = faulty
    case = frbcli.load_case(source, [*settings, MOTION])
    with pytest.raises(InputError) as caught:
        getattr(frbcli, name)(case, *FUNCTIONS[name])
    assert sentence in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@FAULTY
@pytest.mark.parametrize("name", case_commands())
def test_commands_refuse(name: str, faulty: Faulty, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, frb: Frb) -> None:
    monkeypatch.chdir(tmp_path)
    if "measured.csv" in WORDS.get(name, ()):
        _measured(tmp_path / "measured.csv")
    source, settings, sentence = faulty
    words = [word for setting in (*settings, MOTION) for word in ("--set", setting)]
    before = set(tmp_path.iterdir())
    assert sentence in frb(name, source, *words, *WORDS.get(name, ()), code=2).err
    assert set(tmp_path.iterdir()) == before


def _measured(path: Path) -> None:
    t = np.linspace(0.0, 10.0, 20_001)
    speed = 30.0 * t
    angle = np.pi * speed * t
    table = np.stack([t, speed, 5e-6 * np.cos(angle), 5e-6 * np.sin(angle)], axis=1)
    np.savetxt(path, table, delimiter=",", header="t,n,x,y", comments="")


@pytest.mark.parametrize("analysis", ALL)
def test_a_mesh_the_wrong_way_round_is_refused(analysis: str) -> None:
    """The elements along come first: 12 cells around leave a journal near contact 200 nm from its place, 96 4 nm."""
    with pytest.raises(InputError) as caught:
        require(frbcli.load_case("jeffcott", ["accuracy.mesh=[96, 12]", MOTION]), analysis)
    told = {fault.key: str(fault) for fault in caught.value.faults}["accuracy.mesh"]
    assert "accuracy.mesh = [96, 12]: has more elements along the axis than around" in told
    assert "Write [12, 96]" in told
    assert faults(frbcli.load_case("jeffcott", ["accuracy.mesh=[12, 12]"])) == []


BLOCKED = ["bearing.ring.spin=blocked", "film.cavitation=half-sommerfeld"]


def test_a_ring_that_stands_still_under_a_weight_is_refused_where_it_would_have_to_rest() -> None:
    """Without a weight it rests in the middle."""
    case = frbcli.load_case("floating-ring", BLOCKED)
    for name, given in (("stability", ()), ("response", ([100.0],)), ("bearing_sheet", ([100.0],))):
        with pytest.raises(InputError, match="the ring sinks until it touches its shell"):
            getattr(frbcli, name)(case, *given)
    weightless = frbcli.load_case("floating-ring", [*BLOCKED, "rotor.gravity=0 m/s^2"])
    assert np.allclose(resting_position(make_system(weightless, frbcli.make_plan(weightless)), 600.0).journals, 0.0)


def test_speeds_that_leave_no_range_are_refused_where_the_range_is_asked_for() -> None:
    case = frbcli.load_case("jeffcott", ["speed.from=-20 Hz", "speed.to=0 Hz", "film.theory=short"])
    for name in ("stability", "response", "limit_cycles"):
        with pytest.raises(InputError, match="above zero"):
            getattr(frbcli, name)(case)
    assert frbcli.stability(case, [20.0]).points[0].rests


def test_a_fault_of_channels_names_their_bearing_among_several() -> None:
    groove = 'bearing.1.inner.supply={kind="circumferential-groove", pressure="3 bar"}'
    found = faults(frbcli.load_case("turbocharger-car", ["bearing.1.channels=coupled", groove]))
    assert [(fault.key, fault.value) for fault in found] == [("bearing.1.channels", "coupled")]
