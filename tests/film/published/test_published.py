"""The published two-phase form: kernels against plain forms, limits, figure 6.7, and the oil that it creates."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from films import rectangular
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from frbcli.bearing_tests.kinematic import KinematicResult, KinematicTest, rotation, squeeze, whirl
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.film.cavitation.law import Scales
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.motion import Motion
from frbcli.film.gap import Section
from frbcli.film.grid import Array, Mesh
from frbcli.film.published.equations.assembly import artificial_diffusion, assemble
from frbcli.film.published.equations.law import make_step, oil_fraction, step_pressure
from frbcli.film.published.equations.ring import make_ring, solve_ring
from frbcli.film.published.equations.unknown import make_unknowns, pressures_of, unknowns_of
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.loads import published_loads
from frbcli.film.published.plain import terms
from frbcli.film.rectangles.untabulated import direct_force
from frbcli.scene.planning.kinematic_plan import kinematic_plan

OMEGA = 2.0 * math.pi * 120.0  # at 4 s of the run-up of chapter 6
CASE = """
[bearing]                         # table 4.1 with clearance and viscosity of table A.1
kind = "single-film"
width = "20 mm"
diameter = "25 mm"
clearance = "35 um"
supply = { kind = "circumferential-groove", pressure = "1 bar" }
[oil]
viscosity = "12 mPa*s"
ambient_pressure = "1 bar"
cavitation_pressure = "1 bar"
[film]
cavitation = "two-phase"
two-phase = { steepness = 0.99, form = "published" }
[motion]
load = "29.9 N"
speed = "120 Hz"
"""


def groove_section(ends: str = "oil-bath", **changes: object) -> Section:
    """One of the two films of table A.1, circumferential groove at ambient pressure."""
    section = Section(12.5e-3, 10e-3, 20e-3, 35e-6, 12e-3, 1e5, 1e5, copies=2, near=ends, far="groove")
    return replace(section, **changes)  # type: ignore[arg-type]


def turning(x: float, y: float, v: tuple[float, float] = (0.0, 0.0)) -> Motion:
    return Motion((x, y), v, OMEGA)


def assembled(film: PublishedFilm, motion: Motion, w: Array, past: Array, rate: float) -> tuple[Array, Array, Array]:
    """Element matrices and right-hand sides at unknowns w (nodes,), and the nodes' pressures."""
    step = make_step(film.law, film.cavitation, film.ambient)
    unknowns = make_unknowns(film.mesh, film.elements.fixed, step, film.cavity)
    pressure, slope = pressures_of(unknowns, step, w)
    matrix, right = np.zeros((len(film.mesh.nodes), 9, 9)), np.zeros((len(film.mesh.nodes), 9, 5))
    assemble(film.elements, step, film.gap(motion), pressure, slope, rate, past, matrix, right)
    return matrix, right, pressure


def whole(film: PublishedFilm, parts: Array) -> Array:
    """Sums (nodes, ...) over the elements' parts (e, 9, ...)."""
    total = np.zeros((film.mesh.phi.size, *parts.shape[2:]))
    np.add.at(total, film.mesh.nodes, parts)
    return total


@pytest.fixture(params=["oil-bath", "free-to-air"])
def rough(request: pytest.FixtureRequest) -> tuple[PublishedFilm, Motion, Array, Array]:
    """A small film at unknowns without any order: film, motion, unknowns (nodes,), past (e, 9)."""
    film = PublishedFilm(groove_section(request.param), TwoPhase(0.9), around=6, along=3)
    random = np.random.default_rng(1)
    w = random.uniform(-0.3, 0.3, film.mesh.phi.size)
    return film, turning(0.3, -0.2, (1.0, -2.0)), w, random.uniform(0.0, 300.0, film.mesh.angle.shape)


def test_compiled_law_is_the_plain_one() -> None:
    law, scales = TwoPhase(0.95), Scales(5.0, -0.5, 5.0)
    step = make_step(law, scales.cavitation, scales.ambient)
    w = np.linspace(-1.4, 1.2, 301)
    state = law.cells(w, scales)
    found = np.array([step_pressure(step, step.cavity / scales.reference, x) for x in w])
    assert found[:, 0] == pytest.approx(state.pressure, rel=1e-12, abs=1e-12)
    assert found[:, 1] == pytest.approx(state.pressure_slope, rel=1e-9)
    theta = np.array([oil_fraction(step, p) for p in state.pressure])
    assert theta[:, 0] == pytest.approx(state.fraction, abs=1e-9)
    p, nudge = np.linspace(-0.9, -0.55, 50), 1e-6
    ahead, behind = (np.array([oil_fraction(step, x + s * nudge) for x in p]) for s in (1.0, -1.0))
    here = np.array([oil_fraction(step, x) for x in p])
    assert here[:, 1:] == pytest.approx((ahead - behind)[:, :2] / (2.0 * nudge), rel=1e-4, abs=1e-4)


def test_unknowns_and_pressures_are_inverse(rough: tuple[PublishedFilm, Motion, Array, Array]) -> None:
    film = rough[0]
    step = make_step(film.law, film.cavitation, film.ambient)
    unknowns = make_unknowns(film.mesh, film.elements.fixed, step, film.cavity)
    w = np.random.default_rng(2).uniform(-1.2, 3.0, film.mesh.phi.size)
    back = unknowns_of(unknowns, step, pressures_of(unknowns, step, w)[0])
    assert back[~film.elements.fixed] == pytest.approx(w[~film.elements.fixed], abs=1e-9)


def test_artificial_diffusion_is_consistent() -> None:
    """(4.44): Peclet numbers below 1 with it, however large they were; and nothing to add where they are small."""
    for steep in (1e-3, 1e-1, 1.0, 10.0, 100.0):
        added, by_steep, by_height = artificial_diffusion(0.3, 377.0, 0.7, steep)
        beta = 377.0 * 0.7 * steep
        assert 0.3 * beta / (2.0 * (0.7**3 + added)) < 1.0
        nudge = 1e-6 * steep
        more, less = (artificial_diffusion(0.3, 377.0, 0.7, steep + s * nudge)[0] for s in (1.0, -1.0))
        assert by_steep == pytest.approx((more - less) / (2.0 * nudge), rel=1e-6)
        higher, lower = (artificial_diffusion(0.3, 377.0, 0.7 + s * 1e-6, steep)[0] for s in (1.0, -1.0))
        assert by_height == pytest.approx((higher - lower) / 2e-6, rel=1e-6)
    assert artificial_diffusion(0.3, 377.0, 0.7, 1e-6)[0] < 1e-7


def test_assembly_is_the_plain_weak_form(rough: tuple[PublishedFilm, Motion, Array, Array]) -> None:
    film, motion, w, past = rough
    _, right, pressure = assembled(film, motion, w, past, 200.0)
    theta, slope = film.law.fraction(film.over_cavitation(film.at_points(pressure)))
    plain = terms(film.elements, film.gap(motion), pressure, theta, slope / film.cavity, 200.0 * theta - past)
    open_nodes = ~film.elements.fixed
    expected = -whole(film, plain.residual)[open_nodes]
    assert whole(film, right)[open_nodes, 0] == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


def test_matrix_and_derivatives_are_those_of_the_residual(rough: tuple[PublishedFilm, Motion, Array, Array]) -> None:
    film, motion, w, past = rough
    open_nodes, nudge = ~film.elements.fixed, 1e-6
    matrix, right, _ = assembled(film, motion, w, past, 200.0)
    direction = np.random.default_rng(3).uniform(-1.0, 1.0, w.size)

    def residual(motion: Motion, w: Array) -> Array:
        return np.asarray(whole(film, assembled(film, motion, w, past, 200.0)[1])[open_nodes, 0])

    found = whole(film, np.einsum("eab,eb->ea", matrix, direction[film.mesh.nodes]))[open_nodes]
    slope = (residual(motion, w - nudge * direction) - residual(motion, w + nudge * direction)) / (2.0 * nudge)
    assert found == pytest.approx(slope, abs=1e-5 * np.abs(slope).max())
    for k in range(4):
        moved = []
        for sign in (1.0, -1.0):
            values = np.array([*motion.d, *motion.v])
            values[k] += sign * nudge
            moved.append(residual(Motion((values[0], values[1]), (values[2], values[3]), OMEGA), w))
        slope = (moved[0] - moved[1]) / (2.0 * nudge)
        assert whole(film, right)[open_nodes, 1 + k] == pytest.approx(slope, abs=2e-4 * np.abs(slope).max())


def test_ring_is_solved_as_by_a_sparse_elimination(rough: tuple[PublishedFilm, Motion, Array, Array]) -> None:
    film, motion, w, past = rough
    matrix, right, _ = assembled(film, motion, w, past, 200.0)
    nodes, size = film.mesh.nodes, film.mesh.phi.size
    rows, columns = np.repeat(nodes, 9, axis=1).ravel(), np.tile(nodes, (1, 9)).ravel()
    expected = spsolve(coo_matrix((matrix.ravel(), (rows, columns)), shape=(size, size)).tocsc(), whole(film, right))
    found = np.empty((*film.mesh.phi.shape, 5))
    solve_ring(make_ring(6, 3, 5), matrix, right, found)
    assert found.reshape(size, 5) == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


def test_full_film_is_that_of_sommerfeld() -> None:
    """Nothing cavitates under a high pressure: the modal film's force, to what 20 x 10 elements are away from it."""
    section = groove_section(ambient_pressure=50e5, cavitation_pressure=1e5)
    film = PublishedFilm(section, TwoPhase(0.9, outer_slope=1e-9))
    solution = film.steady(turning(0.3, -0.2, (5.0, 3.0)))
    bearing = rectangular(20e-3, 25e-3, 35e-6, 12e-3, 50e5, 1e5, groove=2)
    place, velocity = 35e-6 * np.array([0.3, -0.2]), 35e-6 * np.array([5.0, 3.0])
    expected = direct_force(bearing, "sommerfeld", Mesh(10, 192), place, velocity, OMEGA)
    assert solution.response.force == pytest.approx(expected, rel=2e-3)
    oil = published_loads(film, solution).oil
    assert oil.defect_relative == pytest.approx(0.0, abs=1e-3)


def test_derivatives_of_the_force() -> None:
    film, nudge = PublishedFilm(groove_section(), TwoPhase(0.9)), 1e-4
    middle = film.steady(turning(0.18, -0.06))
    assert middle.residual < 1e-9
    for k in range(2):
        for velocity in (False, True):
            forces = []
            for sign in (1.0, -1.0):
                step = (sign * nudge * (1 - k), sign * nudge * k)
                moved = turning(0.18, -0.06, step) if velocity else turning(0.18 + step[0], -0.06 + step[1])
                forces.append(film.steady(moved, middle.state).response.force)
            slope = (forces[0] - forces[1]) / (2.0 * nudge)
            found = (middle.response.by_v if velocity else middle.response.by_d)[:, k]
            assert found == pytest.approx(slope, rel=1e-3, abs=1e-3 * np.abs(slope).max())


def test_turning_the_other_way_mirrors_the_force() -> None:
    film = PublishedFilm(groove_section("free-to-air"), TwoPhase(0.9))
    there = film.steady(turning(0.2, -0.3)).response.force
    back = film.steady(Motion((-0.2, -0.3), (0.0, 0.0), -OMEGA)).response.force
    assert back == pytest.approx(there * [-1.0, 1.0], rel=1e-6)


def test_steps_settle_at_a_steady_film() -> None:
    """At one of several: theta'(p) is so narrow that the points of an element meet it in more ways than one."""
    film, motion = PublishedFilm(groove_section(), TwoPhase(0.9)), turning(0.18, -0.06)
    state = film.steady(turning(0.15, -0.1)).state
    for _ in range(12):
        solution = film.step(lambda _: motion, state, 0.0, 2e-3)
        state = solution.state
    near, far = film.steady(motion, state), film.steady(motion)
    assert solution.response.force == pytest.approx(near.response.force, rel=1e-4)
    assert near.response.force == pytest.approx(far.response.force, abs=5e-3 * np.abs(far.response.force).max())


def test_steps_of_a_whirl_agree() -> None:
    film, rate = PublishedFilm(groove_section(), TwoPhase(0.9)), 0.5 * OMEGA

    def whirl(t: float) -> Motion:
        c, s = math.cos(rate * t), math.sin(rate * t)
        return turning(0.08 + 0.1 * c, -0.06 + 0.1 * s, (-0.1 * rate * s, 0.1 * rate * c))

    forces, start = [], film.steady(turning(0.18, -0.06)).state
    for count in (10, 40):
        state, dt = start, 2e-3 / count
        for n in range(count):
            solution = film.step(whirl, state, n * dt, dt)
            state = solution.state
        forces.append(solution.response.force)
    assert forces[0] == pytest.approx(forces[1], abs=2e-3 * np.abs(forces[1]).max())
    still = film.steady(turning(*whirl(2e-3).d)).response.force
    assert np.abs(forces[1] - still).max() > 0.1 * np.abs(still).max()


def rest(path: Path, *settings: str) -> KinematicResult:
    path.write_text(CASE, encoding="utf-8")
    return rotation(load_case(path, settings)).results[0]


@pytest.mark.parametrize(("ends", "printed"), [("free-to-air", 2.13e5), ("oil-bath", 2.17e5)])
def test_largest_pressures_of_figure_6_7(tmp_path: Path, ends: str, printed: float) -> None:
    """Section 6.4.3: resting under 29.9 N at 120 Hz. And what figure 6.7 does not tell: nearly all oil is created."""
    result = rest(tmp_path / "case.toml", f"bearing.ends={ends}")
    loads = result.loads
    assert loads is not None
    assert loads.force == pytest.approx((0.0, 29.9), abs=1e-3)
    assert loads.p_max == pytest.approx(printed, rel=0.03)
    assert loads.oil.defect_relative < -0.9
    assert loads.oil.out_m3_s > 10.0 * loads.oil.in_m3_s


def test_diffusion_along_the_stream_only_creates_less(tmp_path: Path) -> None:
    gentle = ("film.two-phase.steepness=0.9", "bearing.ends=oil-bath")
    isotropic = rest(tmp_path / "a.toml", *gentle).loads
    streamline = rest(tmp_path / "b.toml", *gentle, "film.two-phase.diffusion=streamline").loads
    assert isotropic is not None
    assert streamline is not None
    assert isotropic.oil.defect_relative < streamline.oil.defect_relative - 0.1
    assert streamline.oil_fraction < isotropic.oil_fraction - 0.05


def moved(path: Path, *settings: str) -> Case:
    path.write_text(CASE, encoding="utf-8")
    given = ("motion={eccentricity=0.3, frequency='10 Hz', periods=1}", "film.two-phase.steepness=0.9", *settings)
    return load_case(path, given)


@pytest.mark.parametrize("test", [squeeze, pytest.param(whirl, marks=pytest.mark.nightly)])
def test_a_full_film_follows_a_moved_journal_as_sommerfelds_does(
    tmp_path: Path, test: Callable[[Case, Sequence[str]], KinematicTest]
) -> None:
    """Far above the cavitation pressure the film stays full, and its equation (3.9) is linear. The law lets the density
    of the full film rise with its pressure, here to a uniform theta, which the walls carry: so does the force."""
    pressures = [f"{key}=40 bar" for key in ("oil.ambient_pressure", "bearing.supply.pressure")]
    case = moved(tmp_path / "case.toml", "bearing.ends=oil-bath", *pressures)
    full, linear = test(case, ["two-phase", "sommerfeld"]).results
    assert full.history is not None
    assert linear.history is not None
    times, largest = full.history.time_s, np.hypot(*linear.history.force.T).max()
    expected = np.column_stack([np.interp(times, linear.history.time_s, each) for each in linear.history.force.T])
    assert full.loads is not None
    theta = full.loads.oil_fraction
    np.testing.assert_allclose(full.history.force[5:-5], theta * expected[5:-5], atol=2e-3 * largest)
    assert theta == pytest.approx(1.039, abs=1e-3)
    assert full.force_error < 4e-2  # of a whirl whose force falls from the first step on


@pytest.mark.nightly  # 6 s beside the squeeze above
def test_a_squeeze_of_the_published_form_is_symmetric(tmp_path: Path) -> None:
    """The journal moves along y only; and it returns what the film has kept."""
    result = squeeze(moved(tmp_path / "case.toml")).results[0]
    assert result.history is not None
    assert result.loads is not None
    across, along = np.abs(result.history.force).max(axis=0)
    assert across < 1e-9 * along
    assert 0.5 < result.loads.oil_fraction < 1.0
    assert result.status == "ok"


def test_a_ramp_of_the_supply_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"bearing\.supply\.ramp"):
        kinematic_plan(moved(tmp_path / "case.toml", "bearing.supply.ramp=0.01 s"), None, "squeeze")
