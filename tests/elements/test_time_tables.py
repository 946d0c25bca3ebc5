"""Forces from tables over time: exact motions, resume, files of each kind, and faults with their rows."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from resumed import assert_resumable
from scipy.io import savemat, wavfile
from scipy.signal import lsim

import frbcli
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.errors import InputError
from frbcli.linear.response import response
from frbcli.runs.run import rundown, runup
from frbcli.scene.planning.plan import make_plan

M, K, C = 6.0, 1e6, 300.0  # kg; N/m and N s/m of one bearing
RIGID = {"kind": "rigid", "mass": f"{M} kg", "gravity": 0.0}
BEARING = {"kind": "coefficients", "stiffness": f"{K!r} N/m", "damping": f"{C!r} N*s/m"}
SPEED = {"from": "10 Hz", "to": "20 Hz", "duration": "100 ms"}
TIMES = np.linspace(0.0, 0.1, 41)  # 2.5 ms apart


def written(folder: Path, *columns: Any, head: str = "time,x,y", name: str = "force.csv") -> str:
    np.savetxt(folder / name, np.column_stack(columns), delimiter=",", header=head, comments="", fmt="%.17g")
    return name


def machine(folder: Path, file: str, **keys: object) -> frbcli.Case:
    tables = {"rotor": RIGID, "bearing": BEARING, "speed": SPEED}
    return case_from_dict(tables | {"force": [{"at": "journal", "file": file, **keys}]}, "table", folder=folder)


def random_force(folder: Path) -> tuple[frbcli.Case, np.ndarray]:
    """A force of 100 N with kinks at its rows, and the exact motion at these."""
    x = np.random.default_rng(3).uniform(-100.0, 100.0, len(TIMES))
    x[0] = 0.0
    case = machine(folder, written(folder, TIMES, x, 0.0 * x))
    system = [[0.0, 1.0], [-2.0 * K / M, -2.0 * C / M]], [[0.0], [2.0 / M]], [[1.0, 0.0]], [[0.0]]
    return case, lsim(system, x, TIMES, interp=True)[1]


def test_a_force_with_kinks_is_followed_to_the_order_of_the_method(tmp_path: Path) -> None:
    """Steps end at the rows: against the exact motion, four times the steps leave nearly 4^-4 of the error."""
    case, exact = random_force(tmp_path)
    errors = []
    for steps in (200, 800):
        settings = {"accuracy.tolerance": 1e-2, "accuracy.steps_per_revolution": steps, "speed.to": "10 Hz"}
        run = runup(case.with_settings(settings), tmp_path / f"{steps}.h5")
        found = np.interp(TIMES, run["time_s"], run["journal_x_m"])
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert errors[1] < errors[0] / 4.0**3.5


def test_a_run_resumed_within_a_table_is_bit_equal(tmp_path: Path) -> None:
    """Also when the file is gone: the run has its numbers."""
    case, _ = random_force(tmp_path)
    (tmp_path / "force.csv").unlink()
    assert_resumable(case, tmp_path, 0.03)


def test_files_of_all_kinds_give_the_same_numbers(tmp_path: Path) -> None:
    """Names and units as instruments write them; `force` multiplies; one column is for both directions."""
    x, y = np.round(50.0 * np.sin(100.0 * TIMES), 6), np.round(20.0 * TIMES, 6)
    plain = machine(tmp_path, written(tmp_path, TIMES, x, y))
    kilo = written(tmp_path, 1e3 * TIMES, 1e-3 * x, 1e-3 * y, head="Time [ms],x [kN],y [kN]", name="units.csv")
    suffix = written(tmp_path, TIMES, x, y, head="time_s,force_x_N,force_y_N", name="suffix.csv")
    savemat(tmp_path / "force.mat", {"t": TIMES, "x": x, "y": y})
    savemat(tmp_path / "rate.mat", {"fs": 400.0, "x": x, "y": y})
    for file in (kilo, suffix, "force.mat", "rate.mat"):
        (other,) = machine(tmp_path, file).forces
        for mine, its in zip(plain.forces[0].over_time.both, other.over_time.both, strict=True):  # type: ignore[union-attr]
            np.testing.assert_allclose(its, mine, rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(other.over_time.time, TIMES, atol=1e-15)  # type: ignore[union-attr]
    wavfile.write(tmp_path / "force.wav", 8000, np.linspace(-0.5, 0.5, 900).astype(np.float32))
    (wave,) = machine(tmp_path, "force.wav", force=["100 N", "10 N"]).forces
    assert wave.amplitude == (100.0, 10.0)
    assert wave.over_time is not None
    assert wave.over_time.y == ()
    np.testing.assert_allclose(wave.over_time.time[:3], np.arange(3) / 8000.0)


def test_plan_list_and_text_of_a_table(tmp_path: Path) -> None:
    case, _ = random_force(tmp_path)
    told = [(each.value, each.reason) for each in make_plan(case).decisions if each.choice == "force"]
    assert told[0][1].startswith("41 rows of force.csv")
    assert load_case_text(case.source_text, name="table") == case
    assert [each.shown for each in values(case) if each.key == "force.0.over_time.x"] == ["41 values"]


def row(place: int, **values: float) -> tuple[Any, ...]:
    """Time, x, y as columns, with other values in one row."""
    columns = {"t": TIMES.copy(), "x": np.cos(TIMES), "y": np.sin(TIMES)}
    for name, value in values.items():
        columns[name][place] = value
    return tuple(columns.values())


GAP = np.concatenate([TIMES[:20], TIMES[30:]])
UNEVEN = np.cumsum(np.where(np.arange(40) == 25, 0.05, 1e-3 * (1.0 + 0.5 * np.sin(np.arange(40.0)))))
FAULTS: dict[str, tuple[tuple[Any, ...], str, str]] = {
    "falling time": (row(7, t=0.001), "time,x,y", "row 8"),
    "not a number": (row(4, x=np.nan), "time,x,y", "no number in row 5"),
    "gap": ((GAP, GAP, GAP), "time,x,y", "gap of 0.0275 s before row 21"),
    "gap of an uneven table": ((UNEVEN, UNEVEN, 0.0 * UNEVEN), "time,x,y", "gap of 0.05 s before row 26"),
    "no time": (row(0), "a,x,y", 'no column "time"'),
    "which column": (row(0), "time,left,right", "no columns of the values"),
    "unit": (row(0), "time,x [mm],y [mm]", '"mm" as unit'),
    "single row": ((TIMES[:1], TIMES[:1], TIMES[:1]), "time,x,y", "no rows of numbers"),
}


@pytest.mark.parametrize("given", FAULTS.values(), ids=FAULTS.keys())
def test_bad_tables_are_refused_with_their_row(given: tuple[tuple[Any, ...], str, str], tmp_path: Path) -> None:
    columns, head, problem = given
    with pytest.raises(InputError) as caught:
        machine(tmp_path, written(tmp_path, *columns, head=head))
    (fault,) = caught.value.faults
    assert (fault.key, problem in fault.problem, bool(fault.remedy)) == ("force.0.file", True, True), fault


def test_a_long_interval_between_equal_values_is_no_gap(tmp_path: Path) -> None:
    """A recorder that writes a row where its value has changed."""
    held = np.arange(40.0) - (np.arange(40) >= 25)
    assert machine(tmp_path, written(tmp_path, UNEVEN, held, held)).forces[0].over_time is not None


@pytest.mark.parametrize("keys", [{"order": 2.0}, {"rotating": True}])
def test_a_table_is_refused_beside_what_makes_a_force_harmonic(keys: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="with file"):
        machine(tmp_path, written(tmp_path, *row(0)), **keys)


def test_a_table_must_last_as_long_as_the_run(tmp_path: Path) -> None:
    """Both times are told; a run-down is longer than its run-up."""
    case = machine(tmp_path, written(tmp_path, *row(0)))
    longer = case.with_settings({"speed.duration": "250 ms"})
    with pytest.raises(InputError, match=r"ends at 0\.1 s, and the run ends at 0\.25 s"):
        runup(longer, tmp_path / "run.h5")
    with pytest.raises(InputError, match=r"ends at 0\.1 s, and the run ends at"):
        rundown(case, tmp_path / "run.h5")
    late = machine(tmp_path, written(tmp_path, TIMES + 0.05, TIMES, TIMES))
    with pytest.raises(InputError, match=r"begins at 0\.05 s"):
        runup(late.with_settings({"speed.duration": "50 ms"}), tmp_path / "run.h5")
    assert not (tmp_path / "run.h5").exists()


def test_what_knows_no_table_refuses_it(tmp_path: Path) -> None:
    (over_time,) = (each.over_time for each in machine(tmp_path, written(tmp_path, *row(0))).forces)
    table = {"time": over_time.time, "x": over_time.x, "y": over_time.y}  # type: ignore[union-attr]
    film = load_case("rigid", ["film.theory=short"]).with_settings({"force": [{"at": "journal", "over_time": table}]})
    with pytest.raises(InputError, match="changes with time"):
        limit_cycles(film)
    with pytest.raises(InputError, match="is no load of the case"):
        response(film, [50.0], excitation="force 1")
