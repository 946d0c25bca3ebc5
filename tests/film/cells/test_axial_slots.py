"""Axial slots over a part of the width: against pockets and symmetries, and through the program to a run."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from frbcli import load_case
from frbcli.case.schema import Case
from frbcli.cli.main import run
from frbcli.film.cells.film import Motion
from frbcli.film.cells.loads import loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.section_faults import section_faults
from frbcli.report.sketch import film_sketches, rotor_sketch
from frbcli.runs.run import runup
from frbcli.scene.films import film_places, film_section, volume_film

CELLS, FINE = (48, 6), (192, 24)


def case_of(*settings: str, count: int = 2, length: str = "10 mm", angle: str = "10 deg") -> Case:
    sizes = f'position = "0 deg", opening_angle = "{angle}", length = "{length}", pressure = "2 bar"'
    return load_case("rigid", [f'bearing.supply={{ kind = "axial-slots", count = {count}, {sizes} }}', *settings])


def pocket_of(length: str) -> Case:
    sizes = f'position = "0 deg", opening_angle = "10 deg", width = "{length}", pressure = "2 bar"'
    return load_case("rigid", [f'bearing.supply={{ kind = "pocket", {sizes} }}'])


def force(
    case: Case, d: tuple[float, float], v: tuple[float, float], omega: float, cells: tuple[int, int] = CELLS
) -> np.ndarray:
    film, motion = volume_film(case, film_places(case)[0], cells), Motion(d, v, omega)
    return np.array(loads(film, motion, FilmSolver(film).steady(motion)).force)


@pytest.mark.parametrize("length", ["10 mm", "20 mm"])
def test_one_slot_is_a_pocket_of_the_same_size(length: str) -> None:
    """20 mm is the whole width of the bearing."""
    slot, pocket = case_of(count=1, length=length), pocket_of(length)
    sections = [film_section(case, case.bearings[0]) for case in (slot, pocket)]  # type: ignore[arg-type]
    assert sections[0] == sections[1]
    assert section_faults(sections[0]) == []
    motion = ((0.4, -0.3), (2.0, 5.0), 300.0)
    assert force(slot, *motion) == pytest.approx(force(pocket, *motion), rel=1e-12)


def test_two_slots_have_the_symmetry_of_a_half_turn() -> None:
    """The force turns with a motion that is turned by half a turn. One slot pushes the journal away from it."""
    d, v, omega = (0.4, -0.3), (2.0, 5.0), 300.0
    turned = (-d[0], -d[1]), (-v[0], -v[1]), omega
    found = force(case_of(), d, v, omega)
    assert force(case_of(), *turned) == pytest.approx(-found, rel=1e-9, abs=1e-9 * float(np.linalg.norm(found)))
    still = (0.0, 0.0), (0.0, 0.0), 0.0
    one = force(case_of(count=1), *still)
    assert one[1] < -1.0
    assert abs(one[0]) < 1e-9 * abs(one[1])
    assert np.abs(force(case_of(), *still)).max() < 1e-9 * abs(one[1])


def test_force_of_a_slot_over_the_width_is_its_closed_form() -> None:
    """Laplace's equation on the gap of a journal at rest: beside the slot the modes sin(n pi z / B) with odd n decay
    with exp(-n pi R phi / B)."""
    radius, width, half, gauge = 12.5e-3, 20e-3, math.radians(5.0), 1e5
    n = np.arange(1.0, 4001.0, 2.0)
    a = n * math.pi * radius / width
    beside = 2.0 * (8.0 * width / (math.pi * n) ** 2) @ ((a * math.cos(half) - math.sin(half)) / (a**2 + 1.0))
    expected = gauge * radius * (2.0 * width * math.sin(half) + beside)
    still = (0.0, 0.0), (0.0, 0.0), 0.0
    errors = [-force(case_of(count=1, length="20 mm"), *still, cells)[1] / expected - 1.0 for cells in (CELLS, FINE)]
    assert abs(errors[0]) < 1e-2
    assert abs(errors[1]) < 1e-3
    shorter = [-force(case_of(count=1, length=f"{mm} mm"), *still)[1] for mm in (1, 5, 10, 15, 20)]
    assert np.diff(shorter).min() > 1.0


def test_check_and_sketch_tell_of_slots(capsys: pytest.CaptureFixture[str]) -> None:
    case = case_of()
    slots = 'bearing.supply={kind="axial-slots", count=2, opening_angle="10 deg", length="10 mm", pressure="2 bar"}'
    assert run(["check", "rigid", "--set", slots]) == 0
    assert "2 axial slots, 2 bar" in capsys.readouterr().out
    (_, around), = film_sketches(case)
    (_, around_one), = film_sketches(case_of(count=1))
    assert around.count('"oil"') == 2 * around_one.count('"oil"') == 2
    assert rotor_sketch(case)[0].count('"oil"') == 4  # above and below the axis, in both bearings


def test_a_rotor_runs_on_slots(tmp_path: Path) -> None:
    found = runup(case_of("speed.duration=0.02 s"), tmp_path / "run.h5")
    assert found.status == "finished"
