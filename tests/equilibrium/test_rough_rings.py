"""Small motions of machines whose rings turn, between rough surfaces, too: the speeds of the rings follow them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from differences import differences
from films import ROUGH
from marches import march, planned_system, start

import frbcli
from frbcli.cycles.method.balance import state_space
from frbcli.cycles.method.equilibria import at_rest
from frbcli.cycles.method.machine import film_loads, make_machine
from frbcli.equilibrium.linearised import FilmsAtRest, films_at_rest, linearised, rotor_at_rest, states
from frbcli.equilibrium.resting import RestingPosition, resting_position
from frbcli.film.roughness.asperities import make_asperities, rub
from frbcli.film.roughness.contact import BY_V_X, BY_X, VALUE, Rubbing
from frbcli.rotor.assembly import LinearRotor
from frbcli.rotor.loads import speed_profile
from frbcli.scene.machine.system import System
from frbcli.solve.stage.forces import RoughContact
from frbcli.solve.state import Control

LIFTING = pytest.param(4.0, False, marks=pytest.mark.nightly)  # a ring that slides is sought for seconds
GROOVE = 'bearing.inner.supply={kind="circumferential-groove", pressure="2 bar"}'
FILMS = (*ROUGH, GROOVE, "film.cavitation=half-sommerfeld", "accuracy.mesh=[3, 16]", "rotor.unbalance=0")
SURFACES = make_asperities(0.4e-6, 20e-6, 5e9, 115e9, None, 0.12, np.array([20e-3]), np.array([16e-3]))
CLEARANCE = 50e-6
# Sticking and sliding summits: displacement, velocity, slip and speed of the shell
MOTIONS = np.array([[-1e-7, -49.2e-6, 3e-5, -2e-5, 2e-3, -1e-2], [1.1e-5, -47.9e-6, 3e-3, -2e-4, 2e-2, 0.4]])
STEPS = np.array([1e-11, 1e-11, 1e-8, 1e-8, 1e-6, 1e-6])


@pytest.fixture(scope="module")
def system() -> System:
    case = frbcli.load_case("floating-ring", FILMS)
    return planned_system(case)


def coefficients(films: FilmsAtRest) -> tuple[np.ndarray, np.ndarray]:
    stiffness, damping = (
        -np.array([getattr(film, name) for film in films.forces]) for name in ("by_displacement", "by_velocity")
    )
    return stiffness, damping


def _matrix(rotor: LinearRotor, omega: float, stiffness: np.ndarray, damping: np.ndarray) -> np.ndarray:
    return states(linearised(rotor, omega, stiffness, damping), rotor.turning)


def rest_of(system: System, speed: float, stuck: bool) -> RestingPosition:
    """At 4 Hz and above a ring rests on its shell, where it sticks, or beside it, where it turns: the start decides."""
    start = resting_position(system, 2.0 * math.pi).displacements if stuck else None
    return resting_position(system, 2.0 * math.pi * speed, start)


def test_a_machine_that_stands_still_rests_on_its_summits(system: System) -> None:
    """Nothing turns its rings: a start from 0 Hz has to find that."""
    rest = resting_position(system, 0.0)
    assert rest.ring_speeds == pytest.approx(0.0, abs=1e-15)
    assert np.hypot(*rest.journals.T) == pytest.approx(system.clearances, rel=0.05)


def test_summits_have_the_slopes_of_their_forces_and_torques() -> None:
    """As rub has the same, and as differences have what it has not."""
    rubbing = Rubbing(SURFACES, 0, CLEARANCE)
    found = rubbing.slopes(MOTIONS)
    for each, motion in zip(found, MOTIONS, strict=True):
        own = rub(SURFACES, 0, CLEARANCE, *motion.tolist())
        np.testing.assert_allclose(each[:, VALUE], [own.f_x, own.f_y, own.torque, own.shell_torque], rtol=1e-13)
        np.testing.assert_allclose(each[:2, BY_X:BY_V_X].ravel(), own[2:6], rtol=1e-13)
    changes = differences(lambda by: rubbing.slopes(MOTIONS + by)[:, :, VALUE], np.zeros(6), STEPS)
    for column in range(6):
        slopes = found[:, :, 1 + column]
        np.testing.assert_allclose(changes[..., column], slopes, rtol=1e-4, atol=1e-6 * np.abs(slopes).max())


@pytest.mark.parametrize(("speed", "stuck"), [LIFTING, (30.0, True)])
def test_loads_of_cycles_have_exact_derivatives_by_the_motions_of_rings(
    system: System, speed: float, stuck: bool
) -> None:
    """Also where friction is not fully developed: at rest, and beside it with a ring that slips by 1e-3 m/s."""
    omega = 2.0 * math.pi * speed
    machine = make_machine(system, omega)
    u = at_rest(machine, rest_of(system, speed, stuck))[None]
    u[0, -1] += 0.05 / omega
    v = np.array([[0.3, -0.2, 0.01, 0.02, 0.0]])
    found = film_loads(machine, u, v, omega)
    by_u = differences(lambda moved: film_loads(machine, moved[None], v, omega).values[0], u[0], 1e-8)
    by_v = differences(lambda moved: film_loads(machine, u, moved[None], omega).values[0], v[0], 1e-6)
    for changes, slopes in ((by_u, found.by_u[0]), (by_v[:, :4], found.by_v[0])):
        for change, slope in zip(changes.T, slopes.T, strict=False):
            np.testing.assert_allclose(change, slope, rtol=2e-4, atol=1e-5 * np.abs(change).max())


@pytest.mark.parametrize(
    ("speed", "stuck", "rough"), [(30.0, True, True), (30.0, False, True), (16.0, False, False), (90.0, False, False)]
)
def test_the_machine_at_rest_has_the_eigenvalues_of_that_of_cycles(
    system: System, speed: float, stuck: bool, rough: bool
) -> None:
    """Both are linearised in ways of their own: with coefficients and torques at rest here, by the loads of films and
    summits there. A ring that sticks has a rate of some 1e8 1/s."""
    omega = 2.0 * math.pi * speed
    if not rough:
        system = replace(system, asperities=None)
    rest = rest_of(system, speed, stuck)
    films = films_at_rest(system, omega, rest)
    matrix = _matrix(rotor_at_rest(system, omega, rest.ring_speeds, films), omega, *coefficients(films))
    machine = make_machine(system, omega)
    u = at_rest(machine, rest)
    loads = film_loads(machine, u[None], np.zeros((1, machine.size)), omega)
    other = np.linalg.eigvals(state_space(machine).matrix(omega, loads.by_u[0], loads.by_v[0]))
    own = np.linalg.eigvals(matrix)
    assert len(own) == len(other) == 2 * (system.rotor.size - 1) + 1
    size = np.abs(own).max()
    assert size > 1e8 or not stuck
    for value in own:
        assert np.abs(other - value).min() < 1e-6 * abs(value) + 1e-14 * size


@pytest.mark.nightly  # a quarter of a minute of compilation
@pytest.mark.parametrize(
    ("speed", "stuck", "time", "rough"),
    [
        (4.0, False, 0.4, True), (30.0, False, 0.1, True), (60.0, True, 0.1, True), (120.0, True, 0.1, True),
        (16.0, False, 0.1, False),
    ],
)  # fmt: skip
def test_small_motions_grow_as_their_eigenvalue_has_it(
    system: System, speed: float, stuck: bool, time: float, rough: bool
) -> None:
    """In the time loop, from beside rest on, along the eigenvector that grows fastest: at 4 Hz a ring on its way from
    its shell, or back to it, until 1e-3 of it is left, at 120 Hz the whirl of a rotor in a ring that sticks, and at
    16 Hz the slow motion of a ring without summits, whose decay a constant speed of the ring would have as 12.6 1/s."""
    omega = 2.0 * math.pi * speed
    if not rough:
        system = replace(system, asperities=None)
    rest, n = rest_of(system, speed, stuck), system.rotor.size
    films = films_at_rest(system, omega, rest)
    matrix = _matrix(rotor_at_rest(system, omega, rest.ring_speeds, films), omega, *coefficients(films))
    values, vectors = np.linalg.eig(matrix)
    asked = (values.imag > 1e-6 * np.abs(values)) | (values.real > 0.0)
    own = int(np.argmax(np.where(asked, values.real, -np.inf)))
    read, begun = np.linalg.inv(vectors)[own], vectors[:, own].real / np.abs(vectors[: n - 1, own]).max()
    q, v = rest.displacements.copy(), rest.velocities(system)
    q[: n - 1] += 1e-9 * begun[: n - 1]
    v += 1e-9 * begun[n - 1 :]
    profile = speed_profile((0.0, time), (omega, omega))
    control = Control(1e-11, 24.0, time / 40.0, time / 40.0, 0.9999, 0.0)
    if system.asperities is not None:
        control = control._replace(contact_stiffness=1e-9, rough=RoughContact(system.asperities, np.zeros((2, 2))))
    after = march(system, profile, control, start(system, profile, q, v))
    moved = np.hstack([after.q[:, : n - 1] - rest.displacements[: n - 1], after.v - rest.velocities(system)]) @ read
    growth, turn = (
        np.polyfit(after.times, each, 1)[0] for each in (np.log(np.abs(moved)), np.unwrap(np.angle(moved)))
    )
    assert growth == pytest.approx(values[own].real, rel=2e-3, abs=2e-3)
    assert turn == pytest.approx(values[own].imag, rel=1e-4, abs=1e-9)


@pytest.mark.nightly  # some seconds, for three meshes of two machines
def test_a_ring_against_a_stiff_pin_moves_as_one_that_does_not_turn() -> None:
    """On its rough shell, which friction and pin share; what a pin of 1e9 N/m changes of the whirl."""
    full = "oil.cavitation_pressure=0.5 bar"
    pin = "bearing.pin={radius=0.016, play=1e-4, stiffness=1e9, damping=500}"
    pinned, blocked = (
        frbcli.stability(frbcli.load_case("floating-ring", [*FILMS, full, held]), [100.0]).points[0]
        for held in (pin, "bearing.ring.spin=blocked")
    )
    assert len(pinned.eigenvalues) == len(blocked.eigenvalues) + 2
    assert pinned.critical == pytest.approx(blocked.critical, rel=1e-6)
    assert pinned.growth > 10.0
