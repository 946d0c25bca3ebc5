"""Kernels are compiled ahead of time, once, and not by a check: with an empty cache of their own."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from commands import Frb
from marches import rigid_shaft
from numba import typeof

import frbcli
from frbcli.runs.inputs import RunInputs
from frbcli.runs.start import control_of, rotor_data
from frbcli.scene.machine.system import make_segments
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.studies.warm_up import ShortAnalysis, _compile, machine_kernels, short_analyses

# A run-up in which nothing may be compiled
RUN = """
import sys, frbcli
from frbcli.compiled import counted
with counted() as compilations:
    frbcli.runup(frbcli.load_case("seal", ["speed.duration=0.01 s"]), sys.argv[1])
assert compilations.functions == 0, compilations.functions
"""


def cold(words: list[str], cache: Path) -> Any:
    """The JSON document of a command whose kernels lie in `cache`."""
    done = subprocess.run(
        [sys.executable, "-m", "frbcli", *words, "--json"],
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache)}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return json.loads(done.stdout)


@pytest.mark.nightly  # compiles a time loop in a process of its own
def test_kernels_are_compiled_once(tmp_path: Path) -> None:
    """The machine without films has the fewest kernels. Afterwards nothing is missing, also not in a longer run."""
    cache = tmp_path / "cache"
    first = cold(["warm-up", "seal"], cache)
    assert first["cases"] == ["seal"]
    assert first["functions"] == sum(each["functions"] for each in first["compiled"]) > 20
    assert 0.0 < first["cpu_s"] == pytest.approx(sum(each["cpu_s"] for each in first["compiled"]))
    again = cold(["warm-up", "seal"], cache)
    assert (again["compiled"], again["functions"]) == ([], 0)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    subprocess.run([sys.executable, "-c", RUN, str(tmp_path / "run.h5")], env=environment, check=True)


def test_a_check_for_people_compiles_nothing(tmp_path: Path) -> None:
    """Not with heat either, whose films it would have to solve: it names the command that compiles their kernels."""
    words = [sys.executable, "-m", "frbcli", "check", "turbocharger-car-heat"]
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
    assert "frb warm-up compiles" in done.stdout
    assert "heat at the top speed" not in done.stdout
    assert "Compiling" not in done.stderr
    assert not list(tmp_path.rglob("*.nbc"))


SUMMITS = ("contact.model=asperities", "contact.roughness=0.5 um", "contact.summit_radius=20 um",
           "contact.summit_density=4e10 1/m^2")  # fmt: skip
# A case, what it is set to, and settings of which each has other kernels
OTHER_KERNELS = [
    ("jeffcott", (), SUMMITS),
    ("jeffcott", (), ("film.theory=short",)),
    ("jeffcott", (), ("start.position=resting",)),
    ("jeffcott", (), ("film.coupling=co-simulation",)),
    ("jeffcott", ("film.solution=cells",), ("film.cavitation=elrod",)),
    ("turbocharger-car-heat", (), ("thermal.model=none",)),
    ("turbocharger-car-heat", (), ('thermal.supply_temperature=[["0 s", "100 degC"], ["2 s", "120 degC"]]',)),
    ("floating-ring", (), ("bearing.channels=coupled",)),
]


def kernels(name: str, settings: Sequence[str] = ()) -> tuple[object, ...]:
    return kernels_of(frbcli.load_case(name, settings))


def kernels_of(case: frbcli.Case) -> tuple[object, ...]:
    return machine_kernels(case, frbcli.make_plan(case).decisions)


@pytest.mark.parametrize(("name", "given", "other"), OTHER_KERNELS)
def test_what_changes_the_kernels_of_a_machine_is_told_apart(
    name: str, given: tuple[str, ...], other: tuple[str, ...]
) -> None:
    """They are compiled beside those of the same machine without it, and not by many processes at once."""
    assert kernels(name, (*given, *other)) != kernels(name, given)


def test_cells_that_follow_a_tilt_have_kernels_of_their_own() -> None:
    """Their plan says as much of the film as that of cells which do not: those are counted over half the width."""
    flat = rigid_shaft("film.solution=cells", "accuracy.mesh=[12, 48]")
    tilted = rigid_shaft("film.tilt=follows", "accuracy.mesh=[6, 48]")
    for case in (flat, tilted):
        assert "film: 48 x 12 cells" in repr(frbcli.make_plan(case))
    assert kernels_of(flat) != kernels_of(tilted)


def test_numbers_change_no_kernels() -> None:
    numbers = ["bearing.clearance=30 um", "oil.viscosity=20 mPa*s", "rotor.unbalance=2 g*mm", "speed.to=250 Hz"]
    assert kernels("jeffcott", numbers) == kernels("jeffcott")


def loop_types(settings: Sequence[str]) -> str:
    """The types for which the time loop of a run of `jeffcott` is compiled."""
    case = frbcli.load_case("jeffcott", settings)
    plan = frbcli.make_plan(case)
    system = make_segments(case, plan)[0].system
    films, inputs = system.films, RunInputs.of(case, system)
    rotor = rotor_data(system, run_up_profile(case), inputs.loop(system))
    control = control_of(case, plan, system.asperities)
    return str(typeof((rotor, (films.changeable() if inputs.change_films else films).loop, control)))


def test_machines_with_the_same_kernels_have_the_same_types_in_the_time_loop() -> None:
    short = "film.theory=short"
    force = "force=[{{ at = 'disk', force = ['1 N', '0 N']{} }}]"
    settings = [
        (short,), (short, "bearing.clearance=30 um"), (short, *SUMMITS), (short, *SUMMITS, "contact.friction=0.2"),
        (short, "bearing.supply.pressure=2 bar"), (short, "film.cavitation=sommerfeld"),
        (short, force.format("")), (short, force.format(", order = 2")),
        (short, "rotor.gravity=0 m/s^2"), ("film.solution=cells", "accuracy.mesh=[4, 16]"),
        ("film.cavitation=elrod", "accuracy.mesh=[4, 16]"),
    ]  # fmt: skip
    types: dict[object, set[str]] = {}
    for each in settings:
        types.setdefault(kernels("jeffcott", each), set()).add(loop_types(each))
    assert {len(found) for found in types.values()} == {1}
    assert len(types) > 5


def test_a_moment_without_a_solution_has_compiled_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    def compute(_: ShortAnalysis) -> None:
        raise frbcli.NotConverged("nowhere")

    monkeypatch.setattr(ShortAnalysis, "compute", compute)
    (short, *_) = short_analyses(frbcli.load_case("jeffcott"))
    assert _compile(short).functions == 0


def test_what_is_no_case_is_refused(frb: Frb) -> None:
    assert "neither a file nor a shipped case" in frb("warm-up", "nothing", code=2).err
