"""Films on volumes through time: the squeeze test of section 4.2.2.2, oil kept over a whirl, orders, cost."""

import math

import numpy as np
import pytest
from paths import rows_of
from volume_films import AMBIENT, CLEARANCE, RADIUS, VISCOSITY, WIDTH, section_of

from frbcli.bearing_tests import history as marching
from frbcli.bearing_tests.history import Moment, march
from frbcli.errors import NotConverged
from frbcli.film.cavitation.conditions import Elrod, HalfSommerfeld, Reynolds
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution, reference_pressure
from frbcli.film.cells.loads import force
from frbcli.film.cells.mesh.grid import volume_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section

FREQUENCY, LARGEST_ECCENTRICITY = 10.0, 0.6
SQUEEZE_ERROR = 3e-2


def squeeze(time: float) -> Motion:
    """(4.47)"""
    rate = 2.0 * math.pi * FREQUENCY
    d_y, v_y = -LARGEST_ECCENTRICITY * math.sin(rate * time), -LARGEST_ECCENTRICITY * rate * math.cos(rate * time)
    return Motion((0.0, d_y), (0.0, v_y), 0.0)


def whirl(time: float) -> Motion:
    """(4.48) and (4.49)"""
    rate, growing = 2.0 * math.pi * FREQUENCY, 10e-3
    eccentricity = LARGEST_ECCENTRICITY * -math.expm1(-time / growing)
    growth = LARGEST_ECCENTRICITY / growing * math.exp(-time / growing)
    c, s = math.cos(rate * time), math.sin(rate * time)
    v = (growth * c - eccentricity * rate * s, growth * s + eccentricity * rate * c)
    return Motion((eccentricity * c, eccentricity * s), v, 0.0)


def film_of(law: Law, ends: str, around: int, along: int, cavitation_pressure: float = AMBIENT) -> VolumeFilm:
    """The whole bearing of table 4.1 with a groove at its end z = 1."""
    section = Section(
        RADIUS, WIDTH, WIDTH, CLEARANCE, VISCOSITY, AMBIENT, cavitation_pressure, copies=1, near=ends, far="groove"
    )
    phi = np.linspace(-math.pi, math.pi, around + 1)
    grid = volume_grid(section, phi, np.linspace(0.0, 1.0, along + 1))
    return VolumeFilm(section, grid, law, reference_pressure(section, squeeze(0.0)))


def squeezed(film: VolumeFilm, periods: int, steps: int) -> list[Moment]:
    return list(march(film, squeeze, np.linspace(0.0, periods / FREQUENCY, periods * steps + 1)))


def vertical(film: VolumeFilm, moments: list[Moment]) -> np.ndarray:
    return np.array([force(film, film.mean_pressure(moment.solution.state))[1] for moment in moments])


def reference() -> dict[tuple[str, str], list[float]]:
    periods = ("period_1_Fy_max_N", "period_2_Fy_max_N", "period_3_Fy_max_N")
    rows = rows_of("squeeze-forces.csv")
    return {(row["cavitation"].split()[0], row["ends"]): [float(row[key]) for key in periods] for row in rows}


@pytest.mark.parametrize(("cavitation", "ends"), reference())
def test_squeeze_forces_of_three_periods(cavitation: str, ends: str) -> None:
    """The peaks are narrow: the moment at which the film is full again sets them, and the time step that moment."""
    laws: dict[str, tuple[Law, int]] = {
        "half-sommerfeld": (HalfSommerfeld(), 100),
        "elrod": (Elrod(), 800),
        "two-phase": (TwoPhase(0.99), 800),
    }
    law, steps = laws[cavitation]
    film = film_of(law, ends, 32, 16)
    moments = squeezed(film, 3, steps)
    peaks = vertical(film, moments).reshape(3, steps).max(axis=1)
    assert peaks == pytest.approx(reference()[cavitation, ends], rel=SQUEEZE_ERROR)


@pytest.mark.parametrize("ends", ["oil-bath", "free-to-air"])
@pytest.mark.parametrize("law", [Elrod(), TwoPhase(0.99), TwoPhase(0.9999)], ids=["elrod", "0.99", "0.9999"])
def test_no_oil_is_lost_over_a_whirl(law: Law, ends: str) -> None:
    """What came in, less what left, is what the film holds more than at the start, to 1e-10 of the flow."""
    film = film_of(law, ends, 24, 12)
    times = np.linspace(0.0, 1.0 / FREQUENCY, 61)
    moments = list(march(film, whirl, times))
    area = film.grid.area
    gained = float(
        (area * (film.content(whirl(times[-1]), moments[-1].solution.w) - film.content(whirl(0.0), film.full()))).sum()
    )
    came, left = (
        float(np.diff(times) @ [getattr(moment.solution.flows, name) for moment in moments])
        for name in ("inflow", "outflow")
    )
    assert abs(came - left - gained) < 1e-10 * max(came, left)
    assert left > 0.5  # of the film's own oil, some 6
    assert max(abs(moment.solution.flows.defect) for moment in moments) < 1e-9


def whirl_costs() -> tuple[int, list[int]]:
    """Time steps of a whirl, and Newton iterations over it of the two-phase model for x_1 = 0.9 to 0.9999 and of
    Elrod's."""
    times = np.linspace(0.0, 1.0 / FREQUENCY, 101)
    laws = [TwoPhase(0.9), TwoPhase(0.99), TwoPhase(0.999), TwoPhase(0.9999), Elrod()]
    marches = [march(film_of(law, "oil-bath", 24, 12), whirl, times) for law in laws]
    return len(times) - 1, [sum(moment.solution.iterations for moment in moments) for moments in marches]


def test_no_steepness_makes_a_whirl_expensive() -> None:
    """All take the same time steps, and a few iterations in each: the steepest no more than the mildest."""
    steps, costs = whirl_costs()
    assert max(costs) < 7 * steps
    assert costs[3] <= costs[0]
    assert max(costs[:4]) < 1.5 * min(costs[:4])  # measured 411 (x_1 = 0.9999) to 575 (0.9), a factor of 1.40


def test_order_in_time_of_a_film_that_stays_full() -> None:
    """Its force at a moment is known from its motion alone, though Elrod's film keeps its oil: two, by the gap of the
    middle of a step. Errors at half a period's eighth, under a pressure that nothing cavitates at."""
    film = film_of(Elrod(), "oil-bath", 16, 6, cavitation_pressure=-1e3 * AMBIENT)
    errors = []
    for steps in (20, 40, 80):
        *_, last = march(film, squeeze, np.linspace(0.0, 0.125 / FREQUENCY, steps + 1))
        exact = FilmSolver(film).steady(squeeze(last.time)).state
        errors.append(abs(force(film, last.solution.state.pressure)[1] - force(film, exact.pressure)[1]))
    assert math.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(2.0, abs=0.2)


def test_order_in_time_of_the_oil_that_a_film_keeps() -> None:
    """One, of a whirl that leaves half of the cells partly empty: from step to step the oil is kept as by Euler."""
    film, end = film_of(TwoPhase(0.9), "oil-bath", 24, 8), 0.3 / FREQUENCY
    oil = []
    for steps in (50, 100, 200):
        *_, last = march(film, whirl, np.linspace(0.0, end, steps + 1))
        oil.append(float((film.grid.area * film.content(whirl(end), last.solution.w)).sum()))
    assert np.mean(last.solution.state.fraction < 0.999) > 0.5
    assert math.log2((oil[0] - oil[1]) / (oil[1] - oil[2])) == pytest.approx(1.0, abs=0.1)


def test_rotating_film_settles_to_its_steady_state() -> None:
    """In pressure. In the cavity the steady film holds the oil of the cell upstream at its faces, see states.py."""
    section = section_of("axial-groove", 2e5)
    motion = Motion((0.3, -0.4), (0.0, 0.0), 300.0)
    phi = math.radians(7.5) + np.linspace(0.0, 2.0 * math.pi, 49)
    film = VolumeFilm(section, volume_grid(section, phi, np.linspace(0.0, 1.0, 9)), TwoPhase(0.99), 100.0)
    *_, last = march(film, lambda _: motion, np.linspace(0.0, 1.0, 200))
    steady = FilmSolver(film).steady(motion)
    apart = np.abs(last.solution.state.pressure - steady.state.pressure) / steady.state.pressure.max()
    assert apart.max() < 1e-3  # in the cells where the film forms anew
    assert apart.mean() < 1e-4
    assert np.abs(last.solution.state.fraction - steady.state.fraction).mean() < 0.01


def test_step_that_does_not_converge_is_taken_in_halves(monkeypatch: pytest.MonkeyPatch) -> None:
    film = film_of(Elrod(), "oil-bath", 16, 6)
    keep = FilmSolver.keep
    rates = []

    def fussy(
        self: FilmSolver, motion: Motion, flowing: Motion, w: np.ndarray, rate: float, past: np.ndarray, gas: None
    ) -> tuple[VolumeSolution, np.ndarray]:
        rates.append(rate)
        if rate < 3000.0:
            raise NotConverged("too long a step")
        return keep(self, motion, flowing, w, rate, past, gas)

    monkeypatch.setattr(FilmSolver, "keep", fussy)
    moments = list(march(film, whirl, np.array([0.0, 1e-3])))
    assert [moment.time for moment in moments] == pytest.approx([0.875e-3])  # the middle of the last of four parts
    assert rates[:3] == pytest.approx([1e3, 2e3, 4e3])
    monkeypatch.setattr(marching, "MOST_HALVINGS", 1)
    with pytest.raises(NotConverged, match="too long"):
        list(march(film, whirl, np.array([0.0, 1e-3])))


def test_laws_without_memory_need_no_history() -> None:
    """Reynolds' film follows from the motion of the moment: any step leads to it."""
    film = film_of(Reynolds(), "oil-bath", 16, 6)
    *_, last = march(film, whirl, np.linspace(0.0, 0.05, 4))
    assert last.solution.state.pressure == pytest.approx(FilmSolver(film).steady(whirl(0.05)).state.pressure, abs=1e-9)
