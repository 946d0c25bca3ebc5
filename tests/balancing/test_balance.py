"""Unbalances that were put in are found: by the linear response of the case of a run, and by trial runs."""

import cmath
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from commands import Frb

import frbcli
from frbcli.balancing import Balancing
from frbcli.case.reading.load import case_from_dict
from frbcli.errors import InputError
from frbcli.results.store import Run

COEFFICIENTS: list[dict[str, Any]] = [
    {"kind": "coefficients", "name": "left", "position": "20 mm", "damping": "500 N*s/m",
     "stiffness": [["2e6 N/m", "2e5 N/m"], ["-1e5 N/m", "3e6 N/m"]]},
    {"kind": "coefficients", "name": "right", "position": "280 mm", "damping": "500 N*s/m", "stiffness": "3e6 N/m"},
]  # fmt: skip
FILMS: list[dict[str, Any]] = [
    {"kind": "single-film", "name": name, "position": place, "width": "12 mm", "diameter": "20 mm",
     "clearance": "20 um", "supply": {"kind": "circumferential-groove", "pressure": "2 bar"}}
    for name, place in (("left", "20 mm"), ("right", "280 mm"))
]  # fmt: skip
OIL = {"viscosity": "10 mPa*s", "density": "850 kg/m^3", "ambient_pressure": "1 bar", "cavitation_pressure": "1 bar"}


def two_disks(bearings: list[dict[str, Any]], a: complex, b: complex, ramp: str, **tables: Any) -> frbcli.Case:
    """A shaft with two disks that have unbalances a and b in g mm, run up over a range such as "120..120 Hz, 1 s"."""
    low, _, rest = ramp.partition("..")
    high, _, duration = rest.partition(", ")
    inertias = {"polar_inertia": "2e-3 kg*m^2", "diametral_inertia": "1.2e-3 kg*m^2"}
    disks = [
        {"name": name, "position": place, "mass": mass, "unbalance": f"{abs(u)!r} g*mm",
         "phase": f"{cmath.phase(u)!r} rad"} | inertias
        for name, place, mass, u in (("a", "60 mm", "1 kg", a), ("b", "240 mm", "2 kg", b))
    ]  # fmt: skip
    case: dict[str, Any] = {
        "rotor": {"kind": "turbocharger", "modal_damping": 0.01},
        "shaft": [{"length": "300 mm", "diameter": "20 mm"}],
        "disk": disks,
        "bearing": bearings,
        "speed": {"from": f"{low} Hz", "to": high, "duration": duration},
        "start": {"position": "resting"},
    }
    return case_from_dict(case | tables, "two-disks")


def polar(size: float, degrees: float) -> complex:
    return cmath.rect(size, math.radians(degrees))


def found_in(found: Balancing) -> dict[str, complex]:
    """g mm."""
    return {plane.plane: 1e6 * plane.unbalance for plane in found.planes}


def assert_near(found: Balancing, given: Mapping[str, complex], share: float) -> None:
    """Vectors, within a share of the largest."""
    largest = max(map(abs, given.values()))
    off = {name: abs(value - given[name]) / largest for name, value in found_in(found).items()}
    assert off.keys() == given.keys()
    assert max(off.values()) < share


LINEAR = {"a": polar(3.0, 40.0), "b": polar(5.0, 200.0)}


@pytest.fixture(scope="module")
def linear(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A run at 120 Hz in anisotropic bearings."""
    case = two_disks(COEFFICIENTS, LINEAR["a"], LINEAR["b"], "120..120 Hz, 1 s")
    return frbcli.runup(case, tmp_path_factory.mktemp("linear") / "run.h5")


def test_a_linear_rotor_has_the_unbalances_that_were_put_in(linear: Run) -> None:
    found = frbcli.balance(linear, ["a", "b"])
    assert_near(found, LINEAR, 1e-3)
    assert found.status == "good"
    assert found.residual < 1e-3
    for plane in found.planes:
        assert plane.correction == -plane.unbalance
    assert max(point.remaining / point.amplitude for point in found.points) < 1e-3


def test_one_probe_will_do_and_is_less_certain(linear: Run) -> None:
    every, one = (frbcli.balance(linear, ["b", "a"], points=points) for points in (None, ["disk_a"]))
    assert_near(one, LINEAR, 1e-2)
    assert [plane.plane for plane in one.planes] == ["b", "a"]
    assert one.condition > every.condition
    assert all(few.uncertainty > many.uncertainty for few, many in zip(one.planes, every.planes, strict=True))


def test_a_ramp_has_them_too(tmp_path: Path) -> None:
    """Through the peak at 170 Hz with 28 Hz/s, by eight speeds."""
    case = two_disks(COEFFICIENTS, LINEAR["a"], LINEAR["b"], "20..200 Hz, 6.4 s")
    found = frbcli.balance(frbcli.runup(case, tmp_path / "ramp.h5"), ["a", "b"])
    assert len(found.speeds_Hz) == 8
    assert_near(found, LINEAR, 1e-2)
    assert found.status == "good"


def test_the_run_with_the_correction_moves_as_little_as_expected(linear: Run, tmp_path: Path) -> None:
    """b alone is corrected; what is left of the run is what was said to remain."""
    found = frbcli.balance(linear, ["b"])
    left = LINEAR["b"] + 1e6 * found.planes[0].correction
    run = frbcli.runup(two_disks(COEFFICIENTS, LINEAR["a"], left, "120..120 Hz, 1 s"), tmp_path / "corrected.h5")
    after = frbcli.balance(run, ["a", "b"])
    assert [point.amplitude for point in after.points] == pytest.approx(
        [point.remaining for point in found.points], rel=1e-3
    )
    assert found.status == "doubtful"  # b does not explain what a does


def losing(time_s: float) -> frbcli.Case:
    """A Jeffcott rotor of 3 g mm at 120 Hz for 0.4 s that loses 4 g mm."""
    rotor = {"kind": "jeffcott", "mass": "2 kg", "journal_mass": "0.2 kg", "shaft_stiffness": "3e6 N/m",
             "unbalance": "3 g*mm", "external_damping": "300 N*s/m",
             "loss": {"time": f"{time_s} s", "unbalance": "4 g*mm", "phase": "-60 deg"}}  # fmt: skip
    bearing = {name: COEFFICIENTS[0][name] for name in ("kind", "stiffness", "damping")}
    speed = {"from": "120 Hz", "to": "120 Hz", "duration": "0.4 s"}
    return case_from_dict({"rotor": rotor, "bearing": bearing, "speed": speed, "start": {"position": "resting"}})


@pytest.mark.parametrize("time_s", [0.1, 0.25])
def test_after_a_loss_the_whole_unbalance_is_found(time_s: float, tmp_path: Path) -> None:
    """Also where most of the run is before it: vectors of before and after it have no unbalance in common."""
    found = frbcli.balance(frbcli.runup(losing(time_s), tmp_path / "run.h5"), ["disk"])
    assert_near(found, {"disk": 3.0 + polar(4.0, -60.0)}, 1e-2)
    assert found.status == "good"
    with pytest.raises(InputError, match=f"is not reached after the loss or the new clearance at {time_s} s"):
        frbcli.balance(found.run, ["disk"], [60.0])


def test_a_run_that_ends_soon_after_a_loss_is_not_balanced(tmp_path: Path) -> None:
    run = frbcli.runup(losing(0.39), tmp_path / "run.h5")
    with pytest.raises(InputError, match=r"too soon after the loss or the new clearance at 0\.39 s"):
        frbcli.balance(run, ["disk"])


def test_a_rotor_in_films_has_small_unbalances_that_were_put_in(tmp_path: Path) -> None:
    """Within 1 % of the largest, in short films about their resting positions."""
    given = {"a": polar(0.3, 40.0), "b": polar(0.2, 200.0)}
    tables = {"oil": OIL, "film": {"theory": "short"}}
    case = two_disks(FILMS, given["a"], given["b"], "60..60 Hz, 1 s", **tables)
    found = frbcli.balance(frbcli.runup(case, tmp_path / "films.h5"), ["a", "b"])
    assert_near(found, given, 1e-2)
    assert found.status == "good"


def test_large_motions_in_films_and_whirls_are_doubtful(tmp_path: Path) -> None:
    settings = ["film.theory=short", "speed.duration=1 s", "start.position=resting"]
    for more, word in ((["rotor.unbalance=100 g*mm", "speed.from=90 Hz", "speed.to=90 Hz"], "wrong by more than 15 %"),
                       (["speed.from=220 Hz", "speed.to=220 Hz"], "a whirl grows")):  # fmt: skip
        run = frbcli.runup(frbcli.load_case("jeffcott", [*settings, *more]), tmp_path / "run.h5", force=True)
        found = frbcli.balance(run, ["disk"])
        assert found.status == "doubtful"
        assert any(word in doubt for doubt in found.doubts)


def test_runs_serve_as_trial_runs(linear: Run, tmp_path: Path) -> None:
    trials = []
    for plane, trial in (("a", polar(6.0, 30.0)), ("b", polar(8.0, -70.0))):
        both = LINEAR | {plane: LINEAR[plane] + trial}
        case = two_disks(COEFFICIENTS, both["a"], both["b"], "120..120 Hz, 1 s")
        run = frbcli.runup(case, tmp_path / f"{plane}.h5")
        trials.append(frbcli.TrialRun(plane, run, 1e-6 * abs(trial), math.degrees(cmath.phase(trial))))
    assert_near(frbcli.balance(linear, trials=trials), LINEAR, 1e-3)


# --- measurements, in exact arithmetic ---

RATE, TIME_s, SPEED = 12800.0, 2.0, 50.0
INFLUENCE = np.array(  # um/(g mm) of x and y of two probes by each of two planes, far from alike
    [[2.1 + 0.3j, 0.4 - 0.9j], [0.2 - 2.4j, -0.8 - 0.3j], [0.5 + 0.6j, 1.7 - 0.2j], [0.7 - 0.4j, -0.1 - 1.9j]]
)
GIVEN = {"a": polar(12.0, 75.0), "b": polar(7.0, -130.0)}
TRIAL = {"a": polar(10.0, 20.0), "b": polar(9.0, 250.0)}


def recorded(
    path: Path, unbalance: Mapping[str, complex], begin: float, influence: np.ndarray = INFLUENCE, noise: float = 0.0
) -> Path:
    """A recording that begins at an angle of the rotor in revolutions, with a whirl, a run-out of the sensors, and
    pulses of which the signal rises at the angle 0."""
    time = np.arange(0.0, TIME_s, 1.0 / RATE)
    turn = 2.0 * np.pi * (begin + SPEED * time)
    vectors = influence @ np.array([unbalance["a"], unbalance["b"]])
    scatter = np.random.default_rng(len(path.name)).normal(0.0, noise, (4, len(time)))
    table = {"t": time, "key": np.sin(turn)}
    for name, vector, off in zip(("x1", "y1", "x2", "y2"), vectors, scatter, strict=True):
        table[name] = 20.0 + (vector * np.exp(1j * turn)).real + 5.0 * np.cos(0.47 * turn) + off
    pd.DataFrame(table).to_csv(path, index=False)
    return path


def recordings(folder: Path, influence: np.ndarray = INFLUENCE, noise: float = 0.0) -> list[str]:
    """The words of `frb balance` for a run and both of its trial runs."""
    words = ["balance", str(recorded(folder / "run.csv", GIVEN, 0.13, influence, noise))]
    for plane, begin in (("a", 0.61), ("b", 0.92)):
        file = recorded(folder / f"trial_{plane}.csv", GIVEN | {plane: GIVEN[plane] + TRIAL[plane]}, begin, influence,
                        noise)  # fmt: skip
        size, angle = abs(TRIAL[plane]), math.degrees(cmath.phase(TRIAL[plane]))
        words += ["--trial", f"{plane}={file}:{size} g*mm@{angle} deg"]
    return [*words, "--x", "x1,x2", "--time", "t"]


PULSES = ["--tacho", "key"]
Y = ["--y", "y1,y2"]


def balanced(words: list[str], frb: Frb, code: int = 0) -> dict[str, Any]:
    document: dict[str, Any] = frb(*words, "--json", code=code).document
    return document


def corrections(document: dict[str, Any]) -> dict[str, complex]:
    return {row["plane"]: polar(1e6 * row["correction_kg_m"], row["angle_deg"]) for row in document["planes"]}


@pytest.mark.parametrize("more", [[*PULSES, *Y], PULSES], ids=["x and y", "x alone"])
def test_trial_runs_find_the_unbalance(more: list[str], tmp_path: Path, frb: Frb) -> None:
    """The recordings begin at different angles of the rotor; the correction is opposite to the unbalance."""
    document = balanced([*recordings(tmp_path), *more], frb)
    for plane, correction in corrections(document).items():
        assert abs(correction + GIVEN[plane]) < 1e-2 * abs(GIVEN[plane])
    assert set(document) >= {"command", "run", "planes", "residual", "condition", "speeds_Hz"}
    assert set(document["planes"][0]) == {
        "plane", "correction_kg_m", "angle_deg", "correction_uncertainty_kg_m", "unbalance_kg_m",
        "unbalance_angle_deg",
    }  # fmt: skip
    assert document["speeds_Hz"] == pytest.approx([SPEED], rel=1e-4)
    assert document["status"] == "good"


def test_noise_is_in_the_uncertainty(tmp_path: Path, frb: Frb) -> None:
    document = balanced([*recordings(tmp_path, noise=10.0), *PULSES, *Y], frb)
    for row in document["planes"]:
        off = abs(corrections(document)[row["plane"]] + GIVEN[row["plane"]])
        assert off < 4e6 * row["correction_uncertainty_kg_m"]


def test_recordings_without_pulses_have_to_be_triggered(tmp_path: Path, frb: Frb) -> None:
    words = [*recordings(tmp_path), *Y, "--speed-at", "50 Hz"]
    document = balanced(words, frb, 2)
    assert "--triggered" in document["faults"][0]["remedy"]
    for name, unbalance in (("run", GIVEN), *((f"trial_{p}", GIVEN | {p: GIVEN[p] + TRIAL[p]}) for p in "ab")):
        recorded(tmp_path / f"{name}.csv", unbalance, 0.0)
    document = balanced([*words, "--triggered"], frb)
    for plane, correction in corrections(document).items():
        assert abs(correction + GIVEN[plane]) < 1e-2 * abs(GIVEN[plane])


def alike(share: float) -> np.ndarray:
    """The planes differ by a share alone."""
    return np.stack([INFLUENCE[:, 0], INFLUENCE[:, 0] + share * INFLUENCE[:, 1]], axis=1)


def test_planes_that_are_alike_are_doubtful_or_refused(tmp_path: Path, frb: Frb) -> None:
    words = recordings(tmp_path, alike(0.02))
    document = balanced([*words, *PULSES, *Y], frb)
    assert document["status"] == "doubtful"
    assert document["condition"] > 50.0
    assert any("hard to separate" in doubt for doubt in document["doubts"])
    said = frb(*words, *PULSES, *Y).out
    assert "Doubtful:" in said
    assert "doubtful corrections" in said
    assert max(map(len, said.splitlines())) <= 80
    document = balanced([*recordings(tmp_path, alike(0.0)), *PULSES, *Y], frb, 3)
    assert "cannot be separated" in document["message"]


def test_a_feeble_trial_is_doubtful(tmp_path: Path, frb: Frb) -> None:
    words = recordings(tmp_path)
    file = recorded(tmp_path / "trial_b.csv", GIVEN | {"b": GIVEN["b"] + 0.01 * TRIAL["b"]}, 0.2)
    words[words.index("--time") - 3] = f"b={file}:{0.01 * abs(TRIAL['b'])} g*mm@250 deg"
    document = balanced([*words, *PULSES, *Y], frb)
    assert document["status"] == "doubtful"
    assert any("take more" in doubt for doubt in document["doubts"])


@pytest.mark.parametrize(("words", "problem"), [
    (["--planes", "c"], "is no disk of"), ([], "are missing"),
    (["--planes", "a", "--speed", "400 Hz"], "is not reached"), (["--planes", "a,b,a"], "names a plane twice"),
    (["--planes", "a", "--probe", "disk_c"], "is not a point"), (["--trial", "a=trial.csv"], "is no trial run"),
    (["--trial", "a=trial.csv:5 g@30 deg"], "kg*m"), (["--trial", "a=trial.csv:0 g*mm@30 deg"], "no unbalance above 0"),
    (["--trial", "a=trial.csv:5 g*mm@30 mm"], "does not fit"),
])  # fmt: skip
def test_what_cannot_be_balanced_is_refused(words: list[str], problem: str, linear: Run, frb: Frb) -> None:
    assert problem in frb("balance", str(linear.path), *words, code=2).err


def test_measurements_that_say_too_little_are_refused(tmp_path: Path, frb: Frb) -> None:
    words = [*recordings(tmp_path), *PULSES]
    few = [word.replace("x1,x2", "x1") for word in words]
    assert "more than the 1 vectors" in balanced(few, frb, 2)["faults"][0]["problem"]
    assert "has no trial run" in balanced([*words, "--planes", "a,c"], frb, 2)["faults"][0]["problem"]
    alone = ["balance", str(tmp_path / "run.csv"), "--planes", "a", *words[-6:]]
    assert "carries no case" in balanced(alone, frb, 2)["faults"][0]["problem"]
    assert "2 columns" in frb(*words, "--y", "y1", code=2).err
