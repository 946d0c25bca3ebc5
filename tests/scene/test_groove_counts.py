"""Axial grooves of any number in any film of a machine: all of its films have equal numbers of cells, whatever edges
their grooves have, and no more or fewer than the plan says. Films on cells beside grooves: they start on any mesh, and
the plan holds its target."""

from pathlib import Path

import numpy as np
import pytest
from commands import Frb

from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.schema import Case
from frbcli.cli.main import run
from frbcli.film.gap import LEAST, graded_ring
from frbcli.film.kinds.cells import CellFilms
from frbcli.film.kinds.tilted import TiltedFilms
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.machine.system import make_films
from frbcli.scene.planning.plan import make_plan

TURN = 2.0 * np.pi
COUNTS = range(1, 13)
DAMPED = "bearing.damper={width='20 mm', diameter='60 mm', clearance='90 um', ends='oil-bath', mass='1 kg', "
DAMPED += "spring='5e6 N/m', cavitation='sommerfeld'}"
# Machines with other films beside the one with grooves, and the table whose supply they have
MACHINES = {
    "single": ("jeffcott", "bearing", ()),
    "damper": ("jeffcott", "bearing", (DAMPED,)),
    "inner": ("floating-ring", "bearing.inner", ()),
    "outer": ("floating-ring", "bearing.outer", ()),
    "one of two": ("turbocharger-car", "bearing.turbine.inner", ()),
    "outer of two": ("turbocharger-car", "bearing.compressor.outer", ()),
    "cartridge": ("turbocharger-car-cartridge", "bearing.inner", ()),
    "cartridge outside": ("turbocharger-car-cartridge", "bearing.outer", ()),
}
RUN = ("speed.from=20 Hz", "speed.to=22 Hz", "speed.duration=2 ms", "output.step=0.2 ms")


def settings(machine: str, count: int, share: float = 0.3) -> tuple[str, tuple[str, ...]]:
    """A shipped case, and what gives one of its films grooves that take a share of its turn."""
    source, table, others = MACHINES[machine]
    angle = 360.0 * share / count
    return source, (
        *others, f"{table}.supply={{kind='axial-grooves', count={count}, opening_angle='{angle:.6g} deg', "
        "position='17 deg', pressure='2 bar'}", "film.cavitation=reynolds",
    )  # fmt: skip


def with_grooves(machine: str, count: int, *more: str, share: float = 0.3) -> Case:
    source, given = settings(machine, count, share)
    return load_case(source, (*given, *more))


@pytest.mark.parametrize("machine", MACHINES)
def test_films_have_the_cells_of_their_plan_however_many_grooves(machine: str) -> None:
    for count in (*COUNTS, 24):
        for share, more in ((0.3, ()), (0.02, ()), (0.3, ("accuracy.mesh=[4, 12]",))):
            case = with_grooves(machine, count, *more, share=share)
            plan = make_plan(case)
            films = make_films(case, plan)
            assert isinstance(films, CellFilms | TiltedFilms)
            assert films.data.cells.shape[2] == films.cells[0] == plan.cells[0]  # type: ignore[index]
            fewer = plan.form.fewer_cells(case, plan)
            assert fewer is None or fewer[0] >= 4 * count


def test_films_that_tilt_have_the_cells_of_their_plan() -> None:
    for count in COUNTS:
        case = with_grooves("one of two", count, "film.tilt=follows")
        plan = make_plan(case)
        films = make_films(case, plan)
        assert isinstance(films, TiltedFilms)
        assert films.data.cells.shape[2] == plan.cells[0]  # type: ignore[index]


def test_a_ring_of_cells_has_its_number_and_all_edges() -> None:
    chance = np.random.default_rng(5)
    for _ in range(200):
        edges = np.cumsum(chance.uniform(0.02, 1.0, 2 * chance.integers(1, 13)))
        edges *= chance.uniform(0.5, 0.99) * TURN / edges[-1]
        cells = int(chance.integers(LEAST * len(edges), 160))
        ring = graded_ring(cells, 0.0, 1.0, edges, exact=True)
        assert len(ring) == cells + 1
        assert np.all(np.diff(ring) > 0.0)
        assert ring[-1] - ring[0] == pytest.approx(TURN, rel=1e-12)
        assert np.abs(np.remainder(ring[:, None] - edges + 1.0, TURN) - 1.0).min(axis=0).max() < 1e-9
        if cells >= 3 * LEAST * len(edges):  # no cell is much wider than an equal one: each share is met to one cell
            assert np.diff(ring).max() < 2.0 * TURN / cells


def test_round_off_does_not_choose_which_of_equal_lands_has_a_cell_more() -> None:
    edges = np.arange(5) * TURN / 5
    edges = np.sort(np.concatenate([edges, edges + 0.3]))
    whole = [np.diff(graded_ring(48, 0.0, 1.0, edges + 1e-15 * k, exact=True)) for k in range(-9, 10)]
    assert all(np.allclose(one, whole[0], atol=1e-12) for one in whole)


@pytest.mark.parametrize("machine", ["inner", "cartridge"])
def test_grooves_of_an_odd_number_are_checked(machine: str, frb: Frb) -> None:
    source, given = settings(machine, 7)
    frb("check", source, *(word for each in given for word in ("--set", each)))


@pytest.mark.nightly  # each machine compiles its time loop; its cells by all numbers are above
@pytest.mark.parametrize(
    ("machine", "count"), [(machine, (k + n) % 12 + 1) for k, machine in enumerate(MACHINES) for n in (0, 7)]
)
def test_every_number_of_grooves_in_every_command(
    machine: str, count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    source, given = settings(machine, count)
    words = [word for each in (*given, "accuracy.mesh=[4, 48]") for word in ("--set", each)]
    short = [word for each in RUN for word in ("--set", each)]
    for command in (["check", source], ["bearing", source, "--no-picture", "--speed", "30 Hz"],
                    ["stability", source, "--no-picture", "--speed", "30 Hz"],
                    ["runup", source, *short, "--no-picture", "-o", "run.h5"]):  # fmt: skip
        code = run([*command, *words])
        said = capsys.readouterr()
        assert code in (0, 3), (command, said.err)
        assert "Traceback" not in said.err


GROOVED = """
[rotor]
kind = "rigid"
mass = "4 kg"
[bearing]
kind = "single-film"
width = "22 mm"
diameter = "30 mm"
clearance = "40 um"
ends = "free-to-air"
supply = { kind = "axial-grooves", count = 1, position = "30 deg", opening_angle = "25 deg", pressure = "1.8 bar" }
[oil]
viscosity = "18 mPa*s"
density = "830 kg/m^3"
ambient_pressure = "1 bar"
cavitation_pressure = "1 bar"
[film]
cavitation = "elrod"
[speed]
from = "0 Hz"
to = "20 Hz"
duration = "0.5 s"
[accuracy]
target = 3e-3
"""
THREE_GROOVES = (
    'bearing.supply={ kind = "axial-grooves", count = 3, position = "275 deg", opening_angle = "10 deg", '
    'pressure = "1.82 bar" }'
)
NARROW = [
    "rotor.mass=0.93 kg", "bearing.width=8.9 mm", "bearing.diameter=12 mm", "bearing.clearance=14 um", THREE_GROOVES,
    "oil.viscosity=40 mPa*s", "oil.cavitation_pressure=0.7 bar", "speed.to=80 Hz", "speed.duration=0.1 s",
    "film.cavitation=reynolds", "film.solution=cells",
]  # fmt: skip


def case_of(*settings: str) -> Case:
    return load_case_text(GROOVED, settings)


def started(folder: Path, *settings: str) -> Run:
    return runup(case_of(*settings), folder / "run.h5", force=True)


@pytest.mark.parametrize("mesh", ["[4,192]", "[4,1000]"])
def test_a_film_beside_a_groove_starts_on_any_mesh(mesh: str, tmp_path: Path) -> None:
    """It is full at p_cav. From the cavity's side of that, each iteration raises the pressure of one more column of
    cells beside the groove: of 144 around that takes more iterations than a stage has, whatever the step."""
    run = started(tmp_path, f"accuracy.mesh={mesh}", "speed.duration=2 ms")
    assert run.status == "finished"
    assert run.cost["steps"] < 25
    assert run.cost["film_solves"] < 30 * run.cost["steps"]


def test_a_cavity_at_free_ends_opens_on_fine_cells(tmp_path: Path) -> None:
    """Its first cells went to and fro between a source and a pressure of 25 bar, at which the ends let oil out."""
    run = started(tmp_path, *NARROW, "accuracy.mesh=[4,192]", "accuracy.tolerance=7.5e-5")
    assert run.status == "finished"
    assert run.cost["rejected_steps"] == 0
    assert run["eccentricity"].max() < 0.2


def test_a_clipped_film_without_supply_starts_at_rest(tmp_path: Path) -> None:
    """Its pressures are 1e-300 of their scale then; their squares underflow, and derivatives were not a number."""
    settings = ("film.cavitation=half-sommerfeld", 'bearing.supply={kind="none"}', "speed.duration=10 ms")
    settings += ("bearing.ends=free-to-air",)
    table = started(tmp_path, *settings)["eccentricity"]
    run = started(tmp_path, *settings, "film.solution=cells", "accuracy.mesh=[8, 64]")
    assert run.status == "finished"
    assert run["eccentricity"] == pytest.approx(table, abs=0.01 * table[-1])


def test_the_plan_holds_its_target_beside_a_groove(tmp_path: Path) -> None:
    planned, fine = started(tmp_path), started(tmp_path, "accuracy.mesh=[8,144]", "accuracy.tolerance=2e-5")
    apart = np.abs(planned["eccentricity"] - fine["eccentricity"]).max()
    assert apart < 3e-3
    assert apart < planned.error["eccentricity"] < 6.0 * apart


def test_more_grooves_take_more_cells() -> None:
    """Their lands are shorter: of three grooves, 32 around had an error of 2e-2 where 3e-3 was asked for."""
    one, three = (make_plan(case_of(f"bearing.supply.count={count}")).cells for count in (1, 3))
    assert one is not None
    assert three is not None
    assert three[0] > 1.5 * one[0]
