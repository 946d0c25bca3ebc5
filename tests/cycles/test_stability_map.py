"""Stability maps: curves of Hopf points and folds over two numbers, the speed or of the case, against diagrams."""

import math
from functools import cache

import numpy as np
import pytest
from commands import Frb
from cycle_machines import UNIT_Hz, diagram, machine_of, rigid
from marches import planned_system
from scipy.interpolate import CubicSpline

import frbcli
from frbcli.case.reading.load import load_case_text
from frbcli.cycles.method.equilibria import MachineCourse, resting_curve
from frbcli.cycles.method.follower import Cycle
from frbcli.cycles.stability_map import Across, StabilityMap
from frbcli.cycles.unbalance import Synchronous, synchronous_response


@pytest.mark.nightly  # its rows are diagrams, see the next test
def test_a_map_tells_where_the_criticality_changes(frb: Frb, tmp_path) -> None:  # type: ignore[no-untyped-def]
    """Of the rigid rotor: hard at a large viscosity, soft at a small one; each row is that of the case itself."""
    (tmp_path / "rigid.toml").write_text(rigid(1.313, 2.4, 2.9).source_text)
    low, high = (rigid(gamma, 2.4, 2.9).oil.viscosity for gamma in (1.313, 4.538))
    words = ["limit-cycles", str(tmp_path / "rigid.toml"), "--points", "2", "--json"]
    picture = tmp_path / "map.png"
    document = frb(*words, "--and", f"oil.viscosity={low!r}..{high!r} Pa*s", "-o", str(picture)).document
    first, last = document["rows"]
    assert first["special"][0]["criticality"] == "supercritical"
    assert last["special"][0]["criticality"] == "subcritical"
    assert last["special"][0]["speed_Hz"] == pytest.approx(diagram(4.538, 2.4, 2.9).of("hopf")[0].speed_Hz, rel=1e-9)
    assert picture.exists()
    for wrong in ("oil.viscosity=1 Pa*s..2 m", "oil.viscosity", "oil.viscosity=1 Pa*s", "=1..2"):
        frb(*words, "--and", wrong, code=2)


@cache
def rigid_map() -> StabilityMap:
    """Of the rigid rotor over its viscosity, Gamma = 0.8 to 5."""
    low, high = (rigid(gamma, 2.3, 2.95).oil.viscosity for gamma in (0.8, 5.0))
    return frbcli.stability_map(rigid(1.313, 2.3, 2.95), "oil.viscosity", f"{low!r} Pa*s", f"{high!r} Pa*s", 3)


def gamma_of(value: float) -> float:
    viscosity = rigid(1.0, 2.3, 2.95).oil.viscosity
    assert isinstance(viscosity, float)
    return value / viscosity


@pytest.mark.nightly  # 13 s; points of diagrams by themselves: test_limit_cycles.py
def test_curves_of_a_map_are_those_of_the_diagrams() -> None:
    """One curve of Hopf points and one of folds; Hopf points of both known values of Gamma lie on the first (by
    the parabola through three points), and the folds of a diagram that the map has not seen on the second."""
    hopf, fold = rigid_map().curves
    assert (hopf.kind, fold.kind) == ("hopf", "fold")
    for gamma, expected in ((4.538, 2.7413), (1.313, 2.6058)):
        points = sorted(hopf.points, key=lambda point: abs(gamma_of(point.value) - gamma))[:5]
        found = np.poly1d(
            np.polyfit([gamma_of(p.value) - gamma for p in points], [p.speed_Hz / UNIT_Hz for p in points], 4)
        )
        assert found(0.0) == pytest.approx(expected, abs=2e-4)
    other = diagram(4.538, 2.4, 2.9).of("fold")[0]
    near = [p for p in fold.points if abs(p.speed_Hz - other.speed_Hz) < 0.01 * other.speed_Hz]
    line = CubicSpline(*zip(*sorted((gamma_of(p.value), p.speed_Hz / UNIT_Hz) for p in near), strict=True))
    assert float(line(4.538)) == pytest.approx(other.speed_Hz / UNIT_Hz, abs=1e-4)


@pytest.mark.nightly  # five more diagrams
def test_folds_end_where_the_criticality_changes_and_turn_back_in_a_cusp() -> None:
    """Soft below, hard above Gamma = 3.167, where the curve of folds begins; and one fold vanishes with another in a
    cusp at Gamma = 1.06."""
    found = rigid_map()
    kinds = {point.kind: point for point in found.special}
    assert set(kinds) == {"bautin", "cusp"}
    change = gamma_of(kinds["bautin"].value)
    for gamma, criticality in ((change - 0.02, "supercritical"), (change + 0.02, "subcritical")):
        assert diagram(gamma, 2.6, 2.8).of("hopf")[0].criticality == criticality
    fold = found.curves[1]
    assert "It meets the curve of Hopf points." in fold.notes
    ends = [(gamma_of(p.value), p.speed_Hz / UNIT_Hz) for p in (fold.points[0], fold.points[-1])]
    nearest = min(ends, key=lambda end: abs(end[0] - change))
    assert nearest[0] == pytest.approx(change, abs=0.02)
    assert nearest[1] == pytest.approx(kinds["bautin"].speed_Hz / UNIT_Hz, abs=1e-3)
    cusp = gamma_of(kinds["cusp"].value)
    assert len(diagram(cusp - 0.05, 2.6, 2.9).of("fold")) == 0
    assert len(diagram(cusp + 0.15, 2.6, 2.9).of("fold")) == 2
    frame = found.to_pandas()
    assert {"bautin", "cusp", "hopf", "fold"} == set(frame["kind"])


@pytest.mark.nightly
def test_films_with_tables_have_curves_of_folds_as_well() -> None:
    """Jeffcott rotor in finite films: the fold of a diagram that the map has not seen lies on its curve; films of
    other clearances share their table, whose making was most of the cost."""
    found = frbcli.stability_map(frbcli.load_case("jeffcott"), "bearing.clearance", "35 um", "37 um", 2)
    (fold,) = (curve for curve in found.curves if curve.kind == "fold")
    assert fold.notes == ()
    case = frbcli.load_case("jeffcott", ["bearing.clearance=36.2 um", "rotor.unbalance=0 g*mm", "speed.to=200 Hz"])
    places = {round(point.value, 6): point.speed_Hz for point in fold.points}  # curves begin on the border
    line = CubicSpline(*zip(*sorted(places.items()), strict=True))
    assert float(line(36.2)) == pytest.approx(frbcli.limit_cycles(case).of("fold")[0].speed_Hz, rel=1e-4)
    tables = [planned_system(one).films.loop[0].table for one in (case, frbcli.load_case("jeffcott"))]
    assert tables[0] is tables[1]


def response_of(gamma: float, unbalance: str) -> dict[str, Cycle]:
    """Where the synchronous response changes its stability, by the kind."""
    case = rigid(gamma, 2.5, 2.72).with_settings(unbalance)
    machine, speeds = machine_of(case), (2.0 * math.pi * 2.5 * UNIT_Hz, 2.0 * math.pi * 2.72 * UNIT_Hz)
    resting = resting_curve(planned_system(case), machine, *speeds)
    follower = Synchronous(MachineCourse(machine), *(speed / machine.pace for speed in speeds))
    found = synchronous_response(follower, resting.points[-1])
    assert found is not None
    return {cycle.kind: cycle for cycle in found.cycles if cycle.kind}


def w_of(cycle: Cycle) -> float:
    return float(cycle.y[-1] * cycle.machine.pace) / (2.0 * math.pi * UNIT_Hz)


def test_torus_points_of_little_unbalance_come_to_the_hopf_point() -> None:
    """With the square of the unbalance: the whirl of a response of no size is that of the resting position."""
    w = 2.605840  # Hopf point of Gamma = 1.313 by its eigenvalues
    far, near = (w_of(response_of(1.313, f"rotor.unbalance={size} g*mm")["torus"]) - w for size in (4.0, 2.0))
    assert far / near == pytest.approx(4.0, rel=0.05)


@cache
def map_of_two_keys() -> StabilityMap:
    """Of the rigid rotor at w = 2.72 over viscosity and clearance."""
    case = rigid(4.538, 2.4, 2.9)
    viscosity = case.oil.viscosity
    assert isinstance(viscosity, float)
    across = Across("oil.viscosity", f"{0.6 * viscosity!r} Pa*s", f"{1.1 * viscosity!r} Pa*s", 2.72 * UNIT_Hz)
    return frbcli.stability_map(case, "bearing.clearance", "49.9 um", "50.1 um", 3, across=across)


@pytest.mark.nightly
@pytest.mark.parametrize("kind", ["hopf", "fold"])
def test_a_map_over_two_keys_meets_diagrams_over_the_speed(kind: str) -> None:
    """A machine with both numbers of a point of a curve has its Hopf point, or its fold, at the speed of the map."""
    found = map_of_two_keys()
    assert (found.over, found.over_unit, found.key, found.unit) == ("oil.viscosity", "Pa*s", "bearing.clearance", "um")
    curve = next(curve for curve in found.curves if curve.kind == kind)
    assert curve.points[0].value != pytest.approx(curve.points[-1].value, rel=1e-3)
    for point in [point for point in curve.points if not point.kind][1:-1:2]:
        assert point.speed_Hz == pytest.approx(2.72 * UNIT_Hz)
        settings = [f"oil.viscosity={point.over!r} Pa*s", f"bearing.clearance={point.value!r} um"]
        case = load_case_text(rigid(4.538, 2.4, 2.9).source_text, settings, "rigid")
        other = min(frbcli.limit_cycles(case).of(kind), key=lambda one: abs(one.speed_Hz - point.speed_Hz))
        assert other.speed_Hz == pytest.approx(point.speed_Hz, rel=1e-6 if kind == "hopf" else 1e-5)
        assert other.frequency_Hz == pytest.approx(point.frequency_Hz, rel=1e-5)
        assert other.criticality == point.criticality


def test_the_command_draws_maps_over_two_keys(frb: Frb, tmp_path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "rigid.toml").write_text(rigid(1.313, 2.4, 2.9).source_text)
    over = ["limit-cycles", str(tmp_path / "rigid.toml"), "--parameter", "bearing.clearance=48..52 um"]
    over += ["--points", "2", "--speed", f"{2.65 * UNIT_Hz} Hz", "--json", "-o", str(tmp_path / "map.png")]
    words = [*over, "--and", "bearing.width=9..11 mm", "--csv", str(tmp_path / "map.csv")]
    document = frb(*words).document
    assert (document["over"], document["and"]) == ("bearing.clearance", "bearing.width")
    point = document["curves"][0]["points"][0]
    assert 47.9 < point["over_value"] < 52.1
    assert 8.9 < point["value"] < 11.1
    assert (tmp_path / "map.png").exists()
    assert (tmp_path / "map.csv").read_text().startswith("bearing.clearance,over_unit,bearing.width,unit")
    frb(*words, "--with-unbalance", code=2)
    assert "both numbers of the map" in frb(*over, "--and", "bearing.clearance=48 um .. 52 um", code=2).err


@pytest.mark.nightly
def test_a_branch_over_a_force_turns_back_where_its_range_ends_near_the_fold() -> None:
    """Jeffcott rotor in short bearings at 200 Hz under a force across its weight: the whirl that begins with the force
    is that with the speed, and the branch has its fold although its film nearly rests for a moment there, where 80
    harmonics leave more than 1e-7 of the clearance."""
    side = 'force = [{ at = "disk", force = ["%r N", "0 N"] }]'
    case = frbcli.load_case("jeffcott", ["film.theory = short", side % 10.0])
    found = frbcli.limit_cycles_over(case, "force.0.force.0", "60 N", "85 N", 200.0)
    (hopf,), (fold,) = found.of("hopf"), found.of("fold")
    with_it = frbcli.stability(frbcli.load_case("jeffcott", ["film.theory = short", side % hopf.value]))
    assert with_it.threshold is not None
    assert with_it.threshold.speed_Hz == pytest.approx(200.0, rel=1e-6)
    assert hopf.value < fold.value < 85.0
    assert max(cycle.value for cycle in found.branches[0].points) == pytest.approx(fold.value, rel=1e-6)
