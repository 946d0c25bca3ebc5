"""Floating rings against what is known of them: torque balance, momentum, energy, and the limits of their inertias.

Films with a groove instead of bores look the same however their rings have turned, so that their forces can be computed
again from the recorded motion alone. Meshes are coarse: what is checked holds on any mesh.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from marches import planned_system

from frbcli.arrays import Array
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.schema import Case
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.ring_speed import concentric_ratios
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.errors import InputError
from frbcli.linear.stability import stability
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.films import centrifugal_pressures
from frbcli.scene.machine.system import System
from frbcli.scene.planning.plan import make_plan
from frbcli.studies.compare import compare

STEP = 5e-5
COARSE = ("accuracy.mesh=[3,16]", f"output.step={STEP}")
GROOVE = 'bearing.inner.supply={kind="circumferential-groove", pressure="2 bar"}'
GROOVES = (*COARSE, GROOVE, "film.cavitation=penalty", "film.penalty.pressure=dimensionless")
BORES = (*COARSE, "film.cavitation=half-sommerfeld")
WEIGHTLESS = ("rotor.gravity=0", "rotor.unbalance=0")


def ringed(*settings: str) -> Case:
    return load_case("floating-ring", settings)


def constant(speed_Hz: float, duration_s: float) -> tuple[str, ...]:
    return (f"speed.from={speed_Hz} Hz", f"speed.to={speed_Hz} Hz", f"speed.duration={duration_s} s")


def finished(case: Case, folder: Path, name: str = "run") -> Run:
    run = runup(case, folder / f"{name}.h5")
    assert run.status == "finished"
    return run


# ------------------------------------------------------------------------------------------------------ ring speed


def test_a_concentric_ring_spins_up_as_its_torques_say(tmp_path: Path) -> None:
    """theta omega_F' = k_i (omega_R - omega_F) - k_o omega_F, k = 2 pi eta R^3 B / C, less the area of the bores."""
    case = ringed(*BORES, *WEIGHTLESS, *constant(100.0, 0.15))
    run, system = finished(case, tmp_path), planned_system(case)
    k_i, k_o = 2 * math.pi * np.array(system.drags) * system.films.sheared
    assert max(run["eccentricity_inner"].max(), run["eccentricity_outer"].max()) < 1e-6
    ratio = k_i / (k_i + k_o) * (1.0 - np.exp(-run["time_s"] * (k_i + k_o) / 20e-6))
    np.testing.assert_allclose(run["ring_speed_Hz"] / 100.0, ratio, atol=1e-5)


def test_concentric_ratio_in_closed_form() -> None:
    """(eta R^3 B / C)_i = 12e-3 (12.5e-3)^3 20e-3 / 40e-6, and the same outside."""
    inner, outer = 12e-3 * 12.5e-3**3 * 20e-3 / 40e-6, 14e-3 * 20e-3**3 * 16e-3 / 50e-6
    assert concentric_ratios(ringed()) == pytest.approx({"": inner / (inner + outer)})
    assert set(concentric_ratios(load_case("turbocharger-heavy"))) == {"compressor", "turbine"}
    assert concentric_ratios(ringed('bearing.ring.spin="blocked"')) == {}


def test_holes_are_not_sheared() -> None:
    """Six bores of 2.5 mm in a bearing of 20 mm x 25 mm, and a groove of no width."""
    inner, outer = planned_system(ringed("film.cavitation=half-sommerfeld", "accuracy.mesh=[40,160]")).films.sheared
    assert inner == pytest.approx(1.0 - 6 * math.pi / 4 * 2.5**2 / (math.pi * 20.0 * 25.0), abs=1e-6)
    assert outer == pytest.approx(1.0)


def test_a_resting_rotor_and_its_ring_stay_as_they_are(tmp_path: Path) -> None:
    """At 60 Hz, below the threshold of whirl."""
    case = ringed(*GROOVES, "rotor.unbalance=0", "start.position=resting", *constant(60.0, 0.1))
    run, system = finished(case, tmp_path), planned_system(case)
    omega = 2 * math.pi * 60.0
    rest = resting_position(system, omega)
    np.testing.assert_allclose(run["ring_speed_Hz"], rest.ring_speeds[0] / (2 * math.pi), rtol=2e-3)
    for name, place, clearance in zip(("inner", "outer"), rest.journals, (40e-6, 50e-6), strict=True):
        np.testing.assert_allclose(run[f"eccentricity_{name}"], np.hypot(*place) / clearance, atol=2e-3)


def test_resting_position_carries_the_load() -> None:
    """Each inner film carries half the rotor, each outer one its ring as well; the ring's torques balance."""
    case = ringed(*GROOVES, *constant(100.0, 0.1))
    (point,) = stability(case, [100.0]).points
    system = StaticMachines(case).system
    rest = resting_position(system, 200 * math.pi)
    places = rest.journals
    omegas = system.omegas(200 * math.pi, 2 * math.pi * np.array(point.ring_speeds_Hz))
    forces = [system.films.force(i, place, np.zeros(2), float(omegas[i])).force for i, place in enumerate(places)]
    np.testing.assert_allclose(forces[0], [0.0, 3.0 * 9.81], atol=1e-5)
    np.testing.assert_allclose(forces[1], [0.0, 3.075 * 9.81], atol=1e-5)
    turning = 2 * math.pi * np.array(point.ring_speeds_Hz)
    torque = _ring_torque(system, places[None], np.array([200 * math.pi]), turning, np.array(forces)[None])
    assert torque == pytest.approx(0.0, abs=1e-7)
    assert len(point.films) == 2
    assert len(point.eigenvalues) == 2 * 6 + 1  # x and y of journal, disk and ring, and the speed of the ring


# -------------------------------------------------------------------------------------------- momentum and energy


@pytest.fixture(scope="module")
def shaken(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, System]:
    """A rotor with a large unbalance on rings as heavy as itself, from its rest at 80 Hz upwards."""
    heavy = ("bearing.ring.mass=2 kg", "rotor.unbalance=300 g*mm", "rotor.shaft_damping=50 N*s/m")
    exact = ("start.position=resting", "accuracy.tolerance=1e-6")
    case = ringed(*GROOVES, *heavy, *exact, "speed.from=80 Hz", "speed.to=96 Hz", "speed.duration=0.04 s")
    return finished(case, tmp_path_factory.mktemp("shaken")), planned_system(case)


def _derivative(values: Array) -> Array:
    """By time, of fourth order, without the two samples at each end."""
    return (values[:-4] - 8 * values[1:-3] + 8 * values[3:-1] - values[4:]) / (12 * STEP)


def _integral(rate: Array) -> Array:
    """Over time, from zero."""
    steps = 0.5 * STEP * (rate[1:] + rate[:-1])
    return np.concatenate([np.zeros_like(rate[:1]), np.cumsum(steps, axis=0)])


def _motion(run: Run, system: System) -> tuple[Array, Array]:
    """(samples, n) displacements and velocities, without the two samples at each end."""
    q = np.zeros((len(run), system.rotor.size))
    for name, selection in system.rotor.points:
        for axis, row in zip("xy", selection, strict=True):
            q[:, np.argmax(row)] = run[f"{name}_{axis}_m"]
    return q[2:-2], _derivative(q)


def _film_forces(run: Run, system: System, q: Array, v: Array) -> Array:
    """(samples, films, 2) forces of the films, computed again from the motion."""
    omega, ring = 2 * math.pi * run["speed_Hz"][2:-2], 2 * math.pi * run["ring_speed_Hz"][2:-2]
    return np.array([
        [system.films.force(i, selection @ q_k, selection @ v_k, total).force
         for i, (selection, total) in enumerate(
             zip(system.rotor.journals, system.omegas(o, np.array([r])), strict=True))]
        for q_k, v_k, o, r in zip(q, v, omega, ring, strict=True)
    ])  # fmt: skip


def _ring_torque(system: System, places: Array, omega: Array, ring: Array, forces: Array) -> Array:
    """(samples,) torque (4.17) of both films on the ring; places, forces: (samples, films, 2)."""
    clear = np.array(system.clearances)
    couette = np.array(system.drags) * 2 * math.pi / np.sqrt(1.0 - (np.hypot(*places.T).T / clear) ** 2)
    poiseuille = -0.5 * (places[..., 0] * forces[..., 1] - places[..., 1] * forces[..., 0])
    total: Array = couette[:, 0] * (omega - ring) - couette[:, 1] * ring + poiseuille.sum(axis=1)
    return total


@pytest.fixture(scope="module")
def recomputed(shaken: tuple[Run, System]) -> tuple[Array, Array, Array]:
    """Displacements, velocities, film forces."""
    run, system = shaken
    q, v = _motion(run, system)
    return q, v, _film_forces(run, system, q, v)


def test_angular_momentum_of_the_ring_is_what_the_torques_gave_it(
    shaken: tuple[Run, System], recomputed: tuple[Array, Array, Array]
) -> None:
    run, system = shaken
    q, _, forces = recomputed
    ring = 2 * math.pi * run["ring_speed_Hz"][2:-2]
    places = np.einsum("fki,si->sfk", system.rotor.journals, q)
    torque = _ring_torque(system, places, 2 * math.pi * run["speed_Hz"][2:-2], ring, forces)
    gained = 20e-6 * (ring - ring[0])
    np.testing.assert_allclose(_integral(torque), gained, atol=0.002 * np.abs(gained).max())


def test_energy_is_what_load_unbalance_films_and_damping_have_done(
    shaken: tuple[Run, System], recomputed: tuple[Array, Array, Array]
) -> None:
    run, system = shaken
    q, v, forces = recomputed
    rotor, time = system.rotor, run["time_s"][2:-2]
    omega, rate = 2 * math.pi * run["speed_Hz"][2:-2], 2 * math.pi * 400.0
    angle = 2 * math.pi * (80.0 * time + 200.0 * time**2)
    centrifugal_pressure = (
        np.outer(rate * np.cos(angle) - omega**2 * np.sin(angle), rotor.unbalance_cos)
        + np.outer(rate * np.sin(angle) + omega**2 * np.cos(angle), rotor.unbalance_sin)
    )  # fmt: skip
    films = np.einsum("f,fki,sfk->si", rotor.multiplicity, rotor.journals, forces)
    power = np.einsum("si,si->s", v, rotor.static_load + centrifugal_pressure + films - v @ rotor.damping.T)
    energy = 0.5 * np.einsum("si,ij,sj->s", v, rotor.mass, v) + 0.5 * np.einsum("si,ij,sj->s", q, rotor.stiffness, q)
    swing = np.ptp(energy)
    assert swing > 1e-3
    np.testing.assert_allclose(energy - energy[0], _integral(power), atol=0.01 * swing)


# --------------------------------------------------------------------------------------------------------- limits


SINGLE = """
rotor = { kind = "jeffcott", mass = "5 kg", journal_mass = "1 kg", shaft_stiffness = "20000 N/mm",
          unbalance = "50 g*mm", external_damping = "1 N*s/m", shaft_damping = "0.1 N*s/m", gravity = "0 m/s^2" }
oil = { viscosity = "12 mPa*s", density = "830 kg/m^3" }
film = { cavitation = "penalty", penalty = { pressure = "dimensionless" } }
speed = { from = "60 Hz", to = "60 Hz", duration = "0.1 s" }
accuracy = { mesh = [3, 16] }
[bearing]
kind = "single-film"
width = "20 mm"
diameter = "25 mm"
clearance = "40 um"
supply = { kind = "circumferential-groove", pressure = "2 bar" }
""".replace(",\n          ", ", ")


def test_a_ring_that_neither_moves_nor_turns_is_a_shell(tmp_path: Path) -> None:
    still = ("bearing.ring.mass=1e6 kg", 'bearing.ring.spin="blocked"', "rotor.gravity=0", "rotor.unbalance=50 g*mm")
    ring = finished(ringed(*GROOVES, *still, *constant(60.0, 0.1)), tmp_path, "ring")
    single = finished(load_case_text(SINGLE), tmp_path, "single")
    assert single["eccentricity"].max() > 0.05
    np.testing.assert_allclose(ring["eccentricity_inner"], single["eccentricity"], atol=2e-4)
    assert ring["eccentricity_outer"].max() < 1e-4


# ------------------------------------------------------------------------------------------------------- channels


def test_channels_throw_oil_outwards_unless_told_not_to() -> None:
    """Half of rho / 2 (R_o^2 - R_i^2) omega_F^2 is missing at the inner end of a channel, (4.27) to (4.29)."""
    centrifugal, level = (ringed("film.cavitation=half-sommerfeld", f"bearing.centrifugal_pressure={word}")
                     for word in ("true", "false"))  # fmt: skip
    system = planned_system(centrifugal)
    sections = [film.section for film in system.films.with_fields]
    inner, outer = centrifugal_pressures(centrifugal, sections)
    assert inner * sections[0].pressure_scale == pytest.approx(830 / 4 * (20e-3**2 - 12.5e-3**2))
    assert outer == 0.0
    assert centrifugal_pressures(level, sections) == (0.0, 0.0)
    assert centrifugal_pressures(ringed('bearing.ring.spin="blocked"'), sections) == (0.0, 0.0)


# --------------------------------------------------------------------------------------- a cavitation model per film


MIXED = (*COARSE, "bearing.inner.cavitation=two-phase", "film.two-phase.steepness=0.9", *constant(60.0, 0.02),
         "accuracy.tolerance=2e-5")  # fmt: skip


def test_each_film_has_its_own_cavitation_model(tmp_path: Path) -> None:
    """A film keeps its oil beside one that knows none."""
    case = ringed(*MIXED, "film.cavitation=half-sommerfeld")
    assert case.cavitations == ("two-phase", "half-sommerfeld")
    told = [decision.value for decision in make_plan(case).decisions if decision.choice == "cavitation"]
    assert told == ["inner: two-phase", "outer: half-sommerfeld"]
    run = finished(case, tmp_path)
    assert "oil_fraction_inner" in run.signals
    assert "oil_fraction_outer" not in run.signals
    defect = run.error["oil_balance_relative"]
    assert defect is not None
    assert defect < 1e-5
    assert run.cost["oil_in_m3"] > 0.0
    assert "film.two-phase.steepness" in {value.key for value in values(case)}


def test_models_cannot_be_compared_where_films_have_their_own() -> None:
    with pytest.raises(InputError, match="some have a model of their own"):
        compare(ringed(*MIXED), ("penalty", "half-sommerfeld"))
