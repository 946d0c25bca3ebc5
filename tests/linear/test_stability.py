"""`stability` against an independent program, closed forms and limits."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from films import system_of
from paths import DATA

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.equilibrium import static_films
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.static_machine import MachineAtRest
from frbcli.errors import InputError
from frbcli.film.rectangles.film import evaluate
from frbcli.linear import stability as stability_room
from frbcli.linear.stability import Stability, stability
from frbcli.linear.stability_point import StabilityPoint
from frbcli.rotor.assembly import LinearRotor
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

EQUILIBRIUM = DATA / "equilibrium.csv"
CASES = {("40", "10"): "jeffcott-table-4-1", ("35", "12"): "jeffcott"}


def reference() -> list[dict[str, str]]:
    lines = [line for line in EQUILIBRIUM.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def name_of(row: dict[str, str]) -> str:
    return f"{row['clearance_um']}um-{row['theory']}-{row['speed_Hz']}Hz"


def matrix(row: dict[str, str], name: str, unit: str) -> np.ndarray:
    return np.array([[float(row[f"{name}{a}{b}_{unit}"]) for b in "xy"] for a in "xy"])


@pytest.mark.parametrize("row", reference(), ids=name_of)
def test_rests_where_an_independent_program_does(row: dict[str, str]) -> None:
    case = load_case(CASES[row["clearance_um"], row["viscosity_mPas"]], [f"film.theory={row['theory']}"])
    (point,) = stability(case, [float(row["speed_Hz"])]).points
    (film,) = point.films
    assert film.eccentricity == pytest.approx(float(row["eccentricity"]), rel=3e-3)
    assert film.attitude_deg == pytest.approx(float(row["attitude_deg"]), abs=0.3)
    # The reference differentiates its forces numerically. Its short bearing, where D is symmetric exactly, differs from
    # that by 1e-3; small entries are differences of large ones and are compared on the scale of their matrix.
    for found, expected in (
        (film.stiffness, matrix(row, "K", "N_m")),
        (film.damping, matrix(row, "D", "Ns_m")),
    ):
        np.testing.assert_allclose(found, expected, rtol=3e-3, atol=1e-3 * np.abs(expected).max())
    assert point.growth == pytest.approx(float(row["eigenvalue_real_1_s"]), rel=5e-3)
    assert point.critical.imag / (2 * math.pi) == pytest.approx(float(row["eigenvalue_Hz"]), rel=1e-3)


@pytest.mark.parametrize(("name", "speed_Hz"), [("jeffcott-table-4-1", 167.4), ("jeffcott", 177.2)])
def test_threshold_is_that_of_an_independent_program(name: str, speed_Hz: float) -> None:
    threshold = stability(load_case(name)).threshold
    assert threshold is not None
    assert threshold.speed_Hz == pytest.approx(speed_Hz, rel=5e-3)
    assert threshold.whirl_ratio == pytest.approx(0.51, abs=0.01)
    assert threshold.frequency_Hz == pytest.approx(threshold.whirl_ratio * threshold.speed_Hz)


@pytest.mark.parametrize(
    ("name", "law", "mesh", "most"),
    [
        ("jeffcott", "half-sommerfeld", "[18, 288]", 0.1),
        pytest.param("jeffcott", "reynolds", "", 0.5, marks=pytest.mark.nightly),
    ],
)
def test_the_stated_error_of_a_threshold_holds(
    name: str, law: str, mesh: str, most: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Against the threshold on a finer mesh: of a film on cells, 288 x 30. `most` is in Hz."""
    chosen = (f"film.cavitation={law}",)
    found = stability(load_case(name, chosen)).threshold
    assert found is not None
    near = (f"speed.from={0.98 * found.speed_Hz} Hz", f"speed.to={1.02 * found.speed_Hz} Hz")
    monkeypatch.setattr(static_films, "CELLS", (288, 30))
    monkeypatch.setattr(stability_room, "default_speeds", lambda case: (case.speed.start, case.speed.end))
    exact = stability(load_case(name, [*chosen, *near, *([f"accuracy.mesh={mesh}"] if mesh else [])])).threshold
    assert exact is not None
    assert abs(found.speed_Hz - exact.speed_Hz) < found.speed_uncertainty_Hz < most
    assert abs(found.frequency_Hz - exact.frequency_Hz) < found.frequency_uncertainty_Hz < most


def test_threshold_does_not_depend_on_the_speeds_asked_for() -> None:
    case = load_case("jeffcott", ["film.theory=short"])
    asked = stability(case, [250.0, 25.0], threshold=True)
    assert [point.speed_Hz for point in asked.points] == [250.0, 25.0]
    whole = stability(case).threshold
    assert asked.threshold is not None
    assert whole is not None
    assert asked.threshold.speed_Hz == pytest.approx(whole.speed_Hz, rel=1e-8)


def test_stiff_bearings_leave_the_frequency_of_the_shaft() -> None:
    """Rigid bearings: sqrt(c/m)/2 pi = 145.3 Hz (section 6.1). Film damping d goes with 1/C^3, and what is left of its
    give with 1/d^2: with half the clearance the frequencies come closer by 2^6, or nearly so."""
    shaft = math.sqrt(5e6 / 6.0) / (2 * math.pi)
    errors = []
    for clearance in (24, 12, 6):
        case = load_case("jeffcott", ["film.theory=short", f"bearing.clearance={clearance} um"])
        (point,) = stability(case, [150.0]).points
        bending = point.oscillating[-2:].imag / (2 * math.pi)
        errors.append(np.abs(bending / shaft - 1.0).max())
    assert errors[0] > 20 * errors[1] > 400 * errors[2]
    assert errors[2] < 2e-5


@pytest.mark.parametrize("cavitation", ["sommerfeld", "half-sommerfeld"])
def test_weightless_rigid_rotor_whirls_with_half_its_speed(cavitation: str) -> None:
    """Concentric short bearing: with z = x + iy the film pulls with -b (z' - i omega/2 z), so that
    m s^2 + 2 b (s - i omega/2) = 0. A section of width B has b = pi eta R B^3 / C^3 (a squeeze film damper), half of
    it where half of the ring is clipped; a bearing has two sections."""
    settings = ["rotor.gravity=0 m/s^2", "film.theory=short", f"film.cavitation={cavitation}"]
    found = stability(load_case("rigid", settings), [2.0, 200.0], threshold=True)
    section, radius, clearance, viscosity, mass = 10e-3, 12.5e-3, 35e-6, 12e-3, 6.1
    b = 2 * math.pi * viscosity * section**3 * radius / clearance**3 * (0.5 if "half" in cavitation else 1.0)
    for point in found.points:
        omega = 2 * math.pi * point.speed_Hz
        assert point.films[0].eccentricity == 0.0
        assert math.isnan(point.films[0].attitude_deg)
        roots = np.roots([mass, 2 * b, -1j * b * omega])
        forward = roots[np.argmax(roots.real)]
        assert point.critical == pytest.approx(forward, rel=1e-6)
    slow = found.points[0]
    assert slow.critical.imag / (2 * math.pi * slow.speed_Hz) == pytest.approx(0.5, rel=1e-4)
    assert found.threshold is None
    assert "Unstable from the lowest speed" in found.note


def rigid_on_two_bearings(offset: float) -> LinearRotor:
    """A rigid rotor of 6.1 kg in bearings at +-50 mm, centre of mass `offset` (m) from the middle; q = [x, y, tilt x,
    tilt y] of the middle, the journals move with x +- 50 mm tilt."""
    mass, inertia, polar, arm = 6.1, 8e-3, 5e-3, 50e-3
    plane = np.array([[mass, mass * offset], [mass * offset, inertia + mass * offset**2]])
    both = np.array([[1.0, arm], [1.0, -arm]])
    journals = np.array([[[p[0], 0, p[1], 0], [0, p[0], 0, p[1]]] for p in both])
    turn = np.zeros((4, 4))
    turn[2, 3], turn[3, 2] = polar, -polar
    weight = -9.81 * np.array([0.0, mass, 0.0, mass * offset])
    none = np.zeros((4, 4))
    points = (("a", journals[0]), ("b", journals[1]))
    return LinearRotor(
        np.kron(plane, np.eye(2)), none, turn, none, weight, np.zeros(4), np.zeros(4), journals, np.ones(2), points
    )


def test_unequal_loads_are_shared_by_the_levers() -> None:
    """Centre of mass 10 mm from the middle of bearings at +-50 mm: they carry 60 and 40 per cent."""
    case = load_case("rigid", ["film.theory=short"])
    one = make_system(case, make_plan(case))
    rotor = rigid_on_two_bearings(0.01)
    omega = 2 * math.pi * 60.0
    journals = resting_position(system_of(rotor, one.films.sections * 2, one.films.loop * 2), omega).journals
    for journal, share in zip(journals, (0.6, 0.4), strict=True):
        carried = evaluate(one.films.loop[0], one.clearances[0], journal, np.zeros(2), omega).force
        np.testing.assert_allclose(carried, [0.0, share * 6.1 * 9.81], atol=1e-7)


def test_elastic_rotor_on_three_bearings_is_in_equilibrium() -> None:
    """Statically indeterminate: the shaft's stiffness decides what each film carries."""
    rng = np.random.default_rng(5)
    case = load_case("rigid", ["film.theory=short"])
    one = make_system(case, make_plan(case))
    root = rng.normal(size=(9, 9))
    journals = rng.normal(size=(3, 2, 9))
    eye, none = np.eye(9), np.zeros((9, 9))
    load = 30.0 * rng.normal(size=9)
    rotor = LinearRotor(eye, none, none, 1e6 * root @ root.T, load, np.zeros(9), np.zeros(9), journals, np.ones(3), ())
    omega = 2 * math.pi * 40.0
    q = resting_position(system_of(rotor, one.films.sections * 3, one.films.loop * 3), omega).displacements
    forces = [
        selection.T @ evaluate(one.films.loop[0], one.clearances[0], selection @ q, np.zeros(2), omega).force
        for selection in journals
    ]
    np.testing.assert_allclose(rotor.stiffness @ q, load + sum(forces), atol=1e-6)
    assert np.linalg.norm(journals @ q, axis=1).max() < one.clearances[0]


def test_modes_begin_with_those_that_grow_whether_they_oscillate_or_not() -> None:
    pairs = np.array([-8 + 10j, 5 + 400j, -1 + 9000j, 70 + 90j])
    point = StabilityPoint(100.0, (), np.concatenate([[-900.0, 30.0], pairs, pairs.conj()]))
    assert point.modes.tolist() == [70 + 90j, 30, 5 + 400j, -1 + 9000j, -8 + 10j]
    assert point.growing.tolist() == [70 + 90j, 30, 5 + 400j]
    assert len(StabilityPoint(100.0, (), np.zeros(0, dtype=complex)).modes) == 0


def test_one_speed_has_no_threshold_and_says_whether_it_is_stable() -> None:
    for speed, found in ((100, "every motion decays"), (250, "a motion grows")):
        settings = ["film.theory=short", f"speed.from={speed} Hz", f"speed.to={speed} Hz"]
        result = stability(load_case("jeffcott", settings))
        assert result.threshold is None
        assert f"one speed only, {speed} Hz, where {found}" in result.note
        assert "speed.to" in result.note


def test_rotor_that_becomes_stable_again_is_told_beside_its_threshold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Growth of a made-up rotor: negative, positive from 177 Hz on, and negative again beyond 250 Hz."""
    import frbcli.linear.stability as module

    real = module.point_at_rest

    def calms_down(machine: MachineAtRest, speed: float, frequency: float | None = None) -> StabilityPoint:
        point = real(machine, speed, frequency)
        return point if speed < 250.0 else replace(point, eigenvalues=-np.abs(point.eigenvalues.real) + 1j)

    monkeypatch.setattr(module, "point_at_rest", calms_down)
    found = stability(load_case("jeffcott", ["film.theory=short"]))
    assert found.threshold is not None
    assert "No motion grows at 11 higher speeds, from 250 to 300 Hz." in found.note
    late = stability(load_case("jeffcott", ["film.theory=short", "speed.from=200 Hz"]))
    assert late.threshold is None
    assert "Unstable from the lowest speed" in late.note
    assert "No motion grows" in late.note


def test_speed_without_resting_position_is_reported_and_the_rest_computed() -> None:
    found = stability(load_case("jeffcott"), [1e-4, 50.0], threshold=True)
    slow, fast = found.points
    assert (slow.status, fast.status) == ("not-converged", "resting")
    assert slow.films == ()
    assert len(slow.eigenvalues) == 0
    assert math.isnan(slow.growth)
    assert "0.0001 Hz" in slow.problem
    assert found.threshold is not None


def test_given_speeds_alone_are_computed() -> None:
    """The sweep in which a threshold is sought takes minutes with rings and heat."""
    asked: list[tuple[int, int]] = []
    found = stability(load_case("jeffcott", ["film.theory=short"]), [100.0], lambda *told: asked.append(told))
    assert [point.speed_Hz for point in found.sweep] == [100.0]
    assert asked == [(1, 1)]
    assert found.threshold is None
    assert "--threshold" in found.note


def test_rest_is_not_sought_at_all_speeds_where_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """A journal of a quarter millimetre carries none of 60 N: rest was sought at each of 60 speeds."""
    sought = []

    def counting(*given: object, **named: object) -> object:
        sought.append(given)
        return point(*given, **named)

    point = stability_room._point
    monkeypatch.setattr(stability_room, "_point", counting)
    settings = ["bearing.diameter=0.25 mm", 'confirm=["clearance"]', "speed.from=20 Hz", "speed.to=60 Hz"]
    found = stability(load_case("jeffcott", settings))
    assert len(sought) == stability_room.TRIED
    assert len(found.sweep) == 60
    assert not any(each.rests for each in found.sweep)
    assert f"Sought at {stability_room.TRIED} speeds from 20 to 60 Hz only" in found.sweep[0].problem


def test_rest_at_lower_speeds_is_found_where_there_is_none_at_the_highest(monkeypatch: pytest.MonkeyPatch) -> None:
    point = stability_room._point

    def not_at_the_highest(case: object, machines: object, speed: float, *given: object, **named: object) -> object:
        if speed == 60.0:
            return StabilityPoint(speed, (), np.zeros(0, dtype=complex), "none"), None
        return point(case, machines, speed, *given, **named)

    monkeypatch.setattr(stability_room, "_point", not_at_the_highest)
    found = stability(load_case("jeffcott", ["speed.from=20 Hz", "speed.to=60 Hz"]))
    assert [each.speed_Hz for each in found.sweep if not each.rests] == [60.0]


def test_threshold_outside_of_the_range_is_said() -> None:
    low = stability(load_case("jeffcott", ["film.theory=short", "speed.to=100 Hz"]))
    assert low.threshold is None
    assert "above 100 Hz" in low.note
    high = stability(load_case("jeffcott", ["film.theory=short", "speed.from=250 Hz"]))
    assert high.threshold is None
    assert "below 250 Hz" in high.note


@pytest.mark.parametrize("speed", [0.0, math.nan])
def test_speeds_that_are_none_are_refused(speed: float) -> None:
    with pytest.raises(InputError, match="speed"):
        stability(load_case("jeffcott", ["film.theory=short"]), [10.0, speed])


def test_table_of_a_result_has_a_row_per_point() -> None:
    found: Stability = frbcli.stability(load_case("jeffcott", ["film.theory=short"]), [30.0, 1e-6, 60.0])
    table = found.to_pandas()
    assert table["speed_Hz"].tolist() == [30.0, 1e-6, 60.0]
    assert table["status"].tolist() == [point.status for point in found.points]
    first = found.points[0].films[0]
    assert table["eccentricity"][0] == first.eccentricity
    assert table["stiffness_xy_N_m"][0] == first.stiffness[0, 1]
    assert table["damping_yx_N_s_m"][0] == first.damping[1, 0]
    assert table["growth_1_s"][2] == found.points[2].growth


def test_table_of_several_films_names_them() -> None:
    one_speed = ["film.cavitation=half-sommerfeld", "speed.from=600 Hz", "speed.to=600 Hz"]
    found = frbcli.stability(load_case("floating-ring", one_speed))
    table = found.to_pandas()
    inner, outer = found.points[0].films
    assert (inner.name, outer.name) == ("inner", "outer")
    assert table["eccentricity_inner"][0] == inner.eccentricity
    assert table["stiffness_xy_N_m_outer"][0] == outer.stiffness[0, 1]
    assert "eccentricity" not in table
