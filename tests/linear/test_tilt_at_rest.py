"""Rotors at rest in films that follow the tilt of the shaft: eigenvalues, limits, what is refused."""

import math

import numpy as np
import pytest
from marches import DIAMETRAL, DISK, LENGTH, POLAR, RHO, SPAN, SPEED, WIDTH, D, flat_films, rigid_shaft

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cli.studies.stability import _point as document_of
from frbcli.columns import table_of
from frbcli.elements.supports import HousingElement
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.static_films import static_films as films_of
from frbcli.errors import InputError
from frbcli.film.cells.loads import loads
from frbcli.film.cells.tilted_film import land_solution, tilted_force
from frbcli.linear.columns import FILM, film_columns, point_columns
from frbcli.linear.sheets.film_state import FilmState
from frbcli.linear.stability import stability_points
from frbcli.linear.stability_point import StabilityPoint
from frbcli.rotor.assembly import COORDINATES
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import RUN, STILL
from frbcli.scene.machine.heat import warm_case
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.tilted import TiltedForm

FEW = ((24, 8), (16, 6))


@pytest.fixture(autouse=True)
def few_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(TiltedForm, "static_cells", FEW)


def at_speed(case: Case) -> StabilityPoint:
    """The machine at one speed, without the sweep for its threshold."""
    return stability_points(case, [SPEED])[1][0]


def pencil(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    n = len(mass)
    lower = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
    return np.linalg.eigvals(np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), lower]))


def test_cylindrical_and_conical_motion_of_a_rigid_rotor() -> None:
    """Without weight the journals rest in the middle; the rotor then has two motions that do not know of each other:
    2 K and 2 D of a film hold its mass, and s^2/2 of them with twice those in tilt its inertia."""
    case = rigid_shaft("film.tilt=follows", "film.cavitation=sommerfeld", "rotor.gravity=0 m/s^2")
    point = at_speed(case)
    film, omega = films_of(case).system.films.own[0], 2.0 * math.pi * SPEED  # type: ignore[attr-defined]
    found = tilted_force(film, np.zeros(4), np.zeros(4), omega)
    k, d = -found.by_displacement, -found.by_velocity
    shaft = RHO * math.pi / 4.0 * D**2 * LENGTH
    inertia = DIAMETRAL + shaft * (3.0 * (0.5 * D) ** 2 + LENGTH**2) / 12.0
    polar = POLAR + 0.5 * shaft * (0.5 * D) ** 2
    arm = 0.5 * SPAN * np.array([[0.0, 1.0], [-1.0, 0.0]])  # a tilt moves the journal by z (t_y, -t_x)
    gyroscopic = omega * polar * np.array([[0.0, 1.0], [-1.0, 0.0]])

    def conical(share: float) -> np.ndarray:
        stiffness, damping = (2.0 * (arm.T @ a[:2, :2] @ arm + share * a[2:, 2:]) for a in (k, d))
        return pencil(inertia * np.eye(2), damping + gyroscopic, stiffness)

    cylindrical = pencil((shaft + DISK) * np.eye(2), 2.0 * d[:2, :2], 2.0 * k[:2, :2])
    expected = np.concatenate([cylindrical, conical(1.0)])
    values = point.eigenvalues
    assert len(values) == len(expected)
    for value in expected:
        assert np.abs(values - value).min() < 1e-6 * abs(value)
    flat = at_speed(rigid_shaft("film.cavitation=sommerfeld", "rotor.gravity=0 m/s^2"))
    unlike = []
    for value in conical(0.0):
        assert np.abs(flat.eigenvalues - value).min() < 2e-2 * abs(value)
        unlike.append(np.abs(values - value).min() / abs(value))
    assert max(unlike) > 4e-2  # 4.98e-2 on the finest cells; and so the tilt is told from none


def test_a_rotor_that_does_not_tilt_rests_as_without() -> None:
    """The weight in the middle of a rigid shaft: the films of both cases differ by their cells alone."""
    tilted, flat = (at_speed(rigid_shaft(*more)).films for more in (("film.tilt=follows",), ()))
    for one, other in zip(tilted, flat, strict=True):
        assert one.tilting is not None
        assert np.hypot(*one.tilting.tilt) < 1e-9 * 30e-6 / WIDTH
        assert one.displacement == pytest.approx(other.displacement, abs=2e-2)
        assert one.stiffness == pytest.approx(other.stiffness, abs=5e-2 * np.abs(other.stiffness).max())
        assert one.error < 0.1
    assert tilted[0].tilting.damping[:2, 2:] == pytest.approx(-tilted[1].tilting.damping[:2, 2:], abs=1e-6)


def test_moments_balance_a_couple() -> None:
    """A disk beside the bearings tilts the shaft until the films hold the moment of its weight."""
    case = rigid_shaft("film.tilt=follows", f"disk.0.position={LENGTH} m")
    static = films_of(case)
    omega = 2.0 * math.pi * SPEED
    found = resting_position(static.system, omega)
    loads = np.array([film.force for film in found.films])
    shaft = RHO * math.pi / 4.0 * D**2 * LENGTH
    assert loads[:, 1].sum() == pytest.approx(9.81 * (shaft + DISK), rel=1e-8)
    places = 0.5 * SPAN * np.array([-1.0, 1.0])
    weight = -9.81 * DISK * 0.5 * LENGTH  # about the middle: M_x = -z F_y
    assert -(places @ loads[:, 1]) + loads[:, 2].sum() == pytest.approx(weight, rel=1e-8)
    assert abs(loads[:, 2].sum()) > 1e-2 * abs(weight)
    assert found.journals[0, 2] != 0.0
    assert found.journals[0, 2] == pytest.approx(found.journals[1, 2], rel=1e-9)  # the shaft is rigid


def test_shells_that_are_not_in_line() -> None:
    """Tilted against each other they leave a shaft without weight in line, by symmetry; tilted alike they take it along
    until both films balance."""
    tilts = 'bearing.{}.misalignment=["{} rad", "0 rad"]'
    size, omega = 1e-3, 2.0 * math.pi * SPEED
    more = ("film.tilt=follows", "rotor.gravity=0 m/s^2", tilts.format(0, size))
    system = films_of(rigid_shaft(*more, tilts.format(1, -size))).system
    apart = resting_position(system, omega)
    assert apart.journals[:, 2] == pytest.approx([-size, size], rel=1e-8)
    assert apart.journals[:, 3] == pytest.approx(0.0, abs=1e-8 * size)
    alike = resting_position(films_of(rigid_shaft(*more, tilts.format(1, size))).system, omega)
    loads = np.array([film.force for film in alike.films])
    places = 0.5 * SPAN * np.array([-1.0, 1.0])
    assert loads[:, 0].sum() == pytest.approx(0.0, abs=1e-8 * np.abs(loads[:, 0]).max())
    assert np.abs(loads[:, 2]).min() > 0.0
    assert -(places @ loads[:, 1]) + loads[:, 2].sum() == pytest.approx(0.0, abs=1e-8 * np.abs(loads[:, 2]).max())
    assert -size < alike.journals[0, 2] < 0.0  # it follows in part
    with pytest.raises(InputError) as refused:
        stability_points(rigid_shaft(*more, tilts.format(1, 0.02)), [SPEED])
    assert [fault.key for fault in refused.value.faults] == ["bearing.1.misalignment"]


def test_columns_of_films_that_tilt() -> None:
    point, flat = at_speed(rigid_shaft("film.tilt=follows")), at_speed(rigid_shaft())
    names = [film.name for film in point.films]
    table = table_of(point_columns(names, film_columns(point.films)), [point]).to_pandas()
    assert table["tilt_stiffness_xx_N_m_left"][0] == point.films[0].tilting.stiffness[2, 2]  # type: ignore[union-attr]
    assert "tilt_x_rad_right" in table
    assert film_columns(flat.films) == FILM
    told = document_of(point)
    assert len(told["tilt_rad"]) == 2
    assert told["films"][1]["tilt_damping_N_m_s"][0][0] > 0.0
    assert not [key for key in document_of(flat) if "tilt" in key]


WARM = (
    "film.tilt=follows", "film.cavitation=half-sommerfeld", "accuracy.mesh=[4, 24]", "disk.0.position=12 mm",
    "oil.viscosity={grade='SAE 10W-40'}", 'thermal={model="lumped", supply_temperature="70 degC"}',
    *(f'bearing.{i}.supply={{kind="circumferential-groove", pressure="2 bar"}}' for i in (0, 1)),
)  # fmt: skip


def test_power_and_flow_of_a_film_that_tilts() -> None:
    """Without a tilt those of the film without on the same cells; with one the power is what the torque on the journal
    needs beside a shell at rest, whose sum over the cells is another one."""
    case, omega = rigid_shaft(*WARM), 2.0 * math.pi * SPEED
    system = make_system(case, make_plan(case, STILL))
    flat, place = flat_films(case, system), np.array([8e-6, -16e-6, 0.0, 0.0])
    expected = flat.power_and_flow(0, place[:2], omega, omega, 0.0)
    assert system.films.power_and_flow(0, place, omega, omega, 0.0) == pytest.approx(expected, rel=1e-9)
    place[2:] = 1e-3, 4e-3
    power, flow = system.films.power_and_flow(0, place, omega, omega, 0.0)
    assert flow > 1.01 * expected[1]
    torque = 0.0
    for land in system.films.own[0].lands:  # type: ignore[attr-defined]
        motion = land.motion(place, np.zeros(4), omega)
        torque += loads(land.film, motion, land_solution(land.film, motion)).torque.journal
    assert power == pytest.approx(-torque * omega, rel=2e-3)
    assert power > 1.01 * expected[0]


def test_heat_of_films_that_tilt_is_that_of_their_rest() -> None:
    """Stability with heat is that of the machine without, at the viscosities that its balance has found."""
    case = rigid_shaft(*WARM)
    point = at_speed(case)
    assert point.warm is not None
    assert point.warm.balance < 1e-6
    viscosities, clearances = (
        np.array([getattr(film, name) for film in point.warm.films]) for name in ("viscosity", "clearance")
    )
    cold = at_speed(warm_case(case, viscosities, clearances))
    assert np.sort_complex(point.eigenvalues) == pytest.approx(np.sort_complex(cold.eigenvalues), rel=1e-6)
    (state, _) = frbcli.bearing_sheet(case, [SPEED]).points
    assert state.power == pytest.approx(point.warm.films[0].power, rel=1e-2)
    assert point.warm.films[0].temperature > 343.15 + 5.0
    assert [fault.key for fault in faults(case, RUN)] == ["thermal.model"]


def test_shells_of_a_housing_tilt_with_it() -> None:
    """No journal moves against its shell as shaft and housing move together."""
    case = load_case("turbocharger-car", [
        'housing={mass = "1 kg", inertia = "1e-3 kg*m^2", position = "50 mm", '
        'mounts = [{position = "0 mm", stiffness = "1e6 N/m"}, {position = "90 mm", stiffness = "1e6 N/m"}]}'
    ])  # fmt: skip
    rotor = make_rotor(case, COORDINATES)
    assert next(HousingElement.of(case)).given.mass == 1.0
    points, size = dict(rotor.points), rotor.size
    together = np.zeros(size)
    fixed = np.vstack([points["housing_compressor"], points["housing_turbine"]])
    together[np.abs(fixed).max(axis=0) > 0.0] = [1e-3, 2e-3, 0.1, 0.2]
    inner = rotor.journals[::2] @ together
    at = [points[f"housing_{name}"] @ together for name in ("compressor", "turbine")]
    slope = (at[1] - at[0]) / 32e-3
    shells = rotor.journals[1::2] @ together
    assert shells[:, 2:] == pytest.approx(np.array([[slope[1], -slope[0]]] * 2), rel=1e-9)  # ring against shell
    assert inner[:, 2:] == pytest.approx(0.0, abs=1e-12)


def sheet_of(*more: str) -> tuple[FilmState, FilmState]:
    """The films of both bearings of a rigid shaft at its speed."""
    one, other = frbcli.bearing_sheet(rigid_shaft(*more), [SPEED]).points
    assert not one.problem
    return one, other


def test_a_sheet_follows_the_tilt() -> None:
    """A disk on the one and on the other side of the bearings: the two machines are mirror images, with the tilts
    turned, and the least gap is at the end of a bearing to which its journal comes nearest."""
    case = "film.tilt=follows", "film.cavitation=reynolds"
    (left, right), mirrored = (sheet_of(*case, f"disk.0.position={place} m") for place in (0.012, 0.008))
    assert right.power > left.power  # the heavier loaded one
    for film, image in zip((left, right), mirrored[::-1], strict=True):
        assert film.tilting is not None
        assert image.tilting is not None
        assert image.tilting.tilt == pytest.approx(-film.tilting.tilt, rel=1e-5)
        for name in ("power", "side_flow", "p_max", "film_thickness_min", "friction_coefficient"):
            assert getattr(image, name) == pytest.approx(getattr(film, name), rel=1e-5), name
        (x, y), (about_x, about_y) = film.displacement, 0.5 * WIDTH / film.clearance * film.tilting.tilt
        farthest = max(math.hypot(x + side * about_y, y - side * about_x) for side in (-1.0, 1.0))
        assert film.film_thickness_min == pytest.approx(film.clearance * (1.0 - farthest), rel=1e-4)
        assert farthest > film.eccentricity + 1e-3
        assert film.force_error < 0.1
    (stable,) = stability_points(rigid_shaft(*case, "disk.0.position=0.012 m"), [SPEED])[1]
    assert stable.films[1].displacement == pytest.approx(right.displacement, rel=1e-6)
    table = frbcli.bearing_sheet(rigid_shaft(*case, "disk.0.position=0.012 m"), [SPEED]).to_pandas()
    assert table["tilt_x_rad"][1] == pytest.approx(right.tilting.tilt[0], rel=1e-9)  # type: ignore[union-attr]


def test_charts_and_loads_do_not_follow() -> None:
    """A load on a journal leaves its tilt open, and so does an eccentricity."""
    case = rigid_shaft("film.tilt=follows")
    for ask in (frbcli.sommerfeld_chart, lambda case: frbcli.bearing_sheet(case, [SPEED], 5.0)):
        with pytest.raises(InputError) as refused:
            ask(case)
        assert "film.tilt" in [fault.key for fault in refused.value.faults]
