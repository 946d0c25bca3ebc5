"""Rings that do not turn, blocked or at rest against their pin: where they rest, how they answer to small motions, and
runs that end there.

Between a ring at rest and its shell nothing turns that would carry. Without a weight the ring stays in the middle;
under one it rests on its elastic shell, pressed in by the load over the stiffness, or on the summits of rough surfaces.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from films import ROUGH
from marches import march, planned_system, start
from scipy.linalg import expm

import frbcli
from frbcli.case.schema import Case
from frbcli.cli.main import run as frb
from frbcli.equilibrium import static_films
from frbcli.equilibrium.linearised import films_at_rest, first_order, linearised, rotor_at_rest
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import InputError
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.roughness.contact import ElasticShell
from frbcli.plot.machine.bearing import bearing_figure
from frbcli.rotor.loads import speed_profile
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import STABILITY
from frbcli.solve.stage.forces import feel, push_back
from frbcli.solve.state import Control

SPEED, OMEGA, INERTIA = 100.0, 200.0 * math.pi, 20e-6  # Hz, rad/s, kg m^2
RADIUS, PLAY, SPRING, DASHPOT = 16e-3, 0.1e-3, 1e6, 500.0  # m, m, N/m, N s/m
BEGINS, SHELL, LOAD = 0.7, 1e8, 98.1 * 3.075  # eccentricity, N/m, N: half of the rotor and the ring under HEAVY
BLOCKED = "bearing.ring.spin=blocked"
GROOVE = 'bearing.inner.supply={kind="circumferential-groove", pressure="2 bar"}'
FILMS = (GROOVE, "film.cavitation=half-sommerfeld", "accuracy.mesh=[3, 16]", "rotor.unbalance=0")
ELASTIC = f'contact={{policy="elastic", stiffness="{SHELL} N/m", eccentricity={BEGINS}}}'
HEAVY = (ELASTIC, "rotor.gravity=98.1 m/s^2")
LIGHT = ("film.cavitation=sommerfeld", "rotor.gravity=0")


def pin(damping: float = DASHPOT) -> str:
    return f"bearing.pin={{radius={RADIUS}, play={PLAY}, stiffness={SPRING}, damping={damping}}}"


def ringed(*settings: str) -> Case:
    return frbcli.load_case("floating-ring", [*FILMS, *settings])


@pytest.mark.parametrize("damping", [0.0, 300.0])
def test_a_ring_on_its_pin_in_concentric_films_swings_as_its_spring_and_its_drag_have_it(damping: float) -> None:
    """J s^2 + (C + k_i + k_o) s + K = 0, k = 2 pi eta R^3 B / C, about the angle play + k_i omega / K. Nothing else
    moves with it: all other motions are those of a blocked ring."""
    case = ringed(pin(damping), *LIGHT)
    system = planned_system(case)
    k_i, k_o = 2.0 * math.pi * np.array(system.drags)
    stiffness, drag = SPRING * RADIUS**2, damping * RADIUS**2 + k_i + k_o
    (point,), (blocked,) = (frbcli.stability(each, [SPEED]).points for each in (case, ringed(BLOCKED, *LIGHT)))
    own = np.roots([INERTIA, drag, stiffness])
    assert len(point.eigenvalues) == len(blocked.eigenvalues) + 2
    for value in own:
        assert np.abs(point.eigenvalues - value).min() < 1e-9 * abs(value)
    for value in blocked.eigenvalues:
        assert np.abs(point.eigenvalues - value).min() < 1e-6 + 1e-8 * abs(value)
    assert point.ring_speeds_Hz == (0.0,)
    angle = resting_position(system, OMEGA).displacements[-1]
    assert angle == pytest.approx(PLAY / RADIUS + k_i * OMEGA / stiffness, rel=1e-12)


@pytest.mark.parametrize("held", [pin(), BLOCKED])
def test_a_loaded_ring_presses_its_shell_in_by_load_over_stiffness(held: str) -> None:
    """Along the load the shell is as stiff as it is given, across it as a pendulum, load over eccentricity. The inner
    film is that of a journal in a shell that is fixed, which it touches under this load, too."""
    inner, outer = frbcli.bearing_sheet(ringed(held, *HEAVY), [SPEED]).points
    away = BEGINS + LOAD / SHELL / outer.clearance
    np.testing.assert_allclose(outer.displacement, [0.0, -away], atol=1e-9)
    np.testing.assert_allclose(outer.load, [0.0, -LOAD], atol=1e-6)
    np.testing.assert_allclose(outer.stiffness, np.diag([LOAD / away / outer.clearance, SHELL]), rtol=1e-9, atol=1.0)
    assert 0.0 < outer.film_thickness_min < (1.0 - BEGINS) * outer.clearance
    assert (inner.shell_speed_Hz, outer.journal_speed_Hz, outer.power) == (0.0, 0.0, 0.0)
    fixed = frbcli.load_case("floating-ring", [
        *FILMS[1:], *HEAVY,
        'bearing={kind="single-film", width="20 mm", diameter="25 mm", clearance="40 um", viscosity="12 mPa*s", '
        'supply={kind="circumferential-groove", pressure="2 bar"}}',
    ])  # fmt: skip
    (journal,) = frbcli.bearing_sheet(fixed, [SPEED]).points
    np.testing.assert_allclose(inner.displacement, journal.displacement, atol=1e-9)
    np.testing.assert_allclose(inner.damping, journal.damping, rtol=1e-7)
    assert BEGINS < inner.eccentricity < 1.0


@pytest.mark.parametrize("weight", [HEAVY, LIGHT], ids=["on its shell", "in the middle"])
@pytest.mark.parametrize("held", [pin(), BLOCKED], ids=["pin", "blocked"])
def test_small_motions_about_rest_are_those_of_the_time_loop(held: str, weight: tuple[str, ...]) -> None:
    """exp(A t) of what a run begins with beside rest, in all degrees of freedom, the angle of the ring on its pin, too.
    What is left falls with the motion."""
    system = planned_system(ringed(held, *weight))
    rest = resting_position(system, OMEGA)
    films = films_at_rest(system, OMEGA, rest)
    rotor = rotor_at_rest(system, OMEGA, rest.ring_speeds, films)
    stiffness, damping = (
        -np.array([getattr(each, name) for each in films.forces]) for name in ("by_displacement", "by_velocity")
    )
    matrix, n, time = first_order(*linearised(rotor, OMEGA, stiffness, damping)), rotor.size, 2e-3
    assert n == system.rotor.size - (held == BLOCKED) * system.ring_count
    units = np.ones(2 * n)
    units[n:] = 1e3  # m/s over m
    if held != BLOCKED:
        units[[n - 1, 2 * n - 1]] /= RADIUS
    profile, control = speed_profile((0.0, time), (OMEGA, OMEGA)), Control(1e-11, 24.0, 5e-6, time, BEGINS, SHELL)
    off = []
    for size in (4e-9, 1e-9):  # m
        begun = size * units * np.random.default_rng(5).normal(size=2 * n)
        q, v = rest.displacements.copy(), np.zeros(system.rotor.size)
        q[:n] += begun[:n]
        v[:n] += begun[n:]
        after = march(system, profile, control, start(system, profile, q, v))
        moved = np.concatenate([after.q[-1, :n] - rest.displacements[:n], after.v[-1, :n]])
        expected = expm(matrix * time) @ begun
        off.append(float(np.abs((moved - expected) / units).max() / np.abs(expected / units).max()))
    assert off[1] < 1e-3
    assert off[1] < 0.5 * off[0] or off[0] < 1e-5


def test_a_run_ends_where_the_machine_rests(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From the centre on at a constant speed: the ring sinks onto its shell and turns through its play onto its pin. A
    run that begins at rest stays there."""
    monkeypatch.setattr(static_films, "RESTING_LINES", 1)  # films clipped along the lines of the run
    course = (f"speed.from={SPEED} Hz", f"speed.to={SPEED} Hz", "speed.duration=0.2 s", "output.step=5 ms")
    case = ringed(pin(), *HEAVY, *course)
    run = frbcli.runup(case, tmp_path / "run.h5")
    resting = frbcli.runup(
        case.with_settings({"start.position": "resting", "speed.duration": "10 ms"}), tmp_path / "resting.h5"
    )
    inner, outer = (state.displacement * state.clearance for state in frbcli.bearing_sheet(case, [SPEED]).points)
    for axis, (in_ring, ring) in enumerate(zip(inner, outer, strict=True)):
        for name, place in (("ring", ring), ("journal", ring + in_ring)):
            moved = f"{name}_{'xy'[axis]}_m"
            assert run[moved][-1] == pytest.approx(place, abs=1e-9)
            np.testing.assert_allclose(resting[moved], place, atol=1e-9)
    angle = resting["pin_angle_rad"]
    assert angle[0] > PLAY / RADIUS
    assert run["pin_angle_rad"][-1] == pytest.approx(angle[0], rel=1e-5)
    np.testing.assert_allclose(angle, angle[0], rtol=1e-5)


@pytest.mark.parametrize("held", [pin(), BLOCKED], ids=["pin", "blocked"])
def test_a_ring_that_does_not_turn_rests_on_rough_surfaces(held: str) -> None:
    """Its summits carry it alone: the eccentricity at which they stand under the load."""
    case = ringed(held, *ROUGH, "rotor.gravity=98.1 m/s^2")
    system = planned_system(case)
    rest = resting_position(system, OMEGA)
    np.testing.assert_allclose(rest.journals[1], [0.0, -system.rubbing(1).standing(LOAD)], atol=1e-11)
    assert [state.status for state in frbcli.bearing_sheet(case, [SPEED]).points] == ["resting"] * 2
    assert faults(case, STABILITY) == []
    assert frbcli.stability(case, [SPEED]).points[0].rests


def test_a_response_that_would_lift_a_ring_off_its_shell_is_no_linear_one() -> None:
    """A small unbalance presses the shell in a little more and less, within the depth to which the weight does."""
    small, large = (
        frbcli.response(ringed(BLOCKED, *HEAVY, f"rotor.unbalance={size} g*mm"), [60.0]) for size in (0.1, 1e5)
    )
    assert small.validity == ("linear",)
    assert large.validity == ("beyond-gap",)
    np.testing.assert_allclose(large.gap_share, 1e6 * small.gap_share, rtol=1e-9)
    assert (small.gap_share > 0.0).all()


def test_an_elastic_shell_at_rest_is_that_of_the_time_loop() -> None:
    """Force and felt gap, before and in contact; its derivatives are differences of the force."""
    clearance, shell = 50e-6, ElasticShell(0.95, 1e8)
    k, c = np.array([[3e5, 1e5], [-2e5, 4e5]]), np.array([[200.0, 30.0], [-10.0, 150.0]])

    def film(place: np.ndarray, rate: np.ndarray) -> FilmForce:
        return FilmForce(-k @ place - c @ rate, -k, -c)

    for eccentricity in (0.5, 0.96, 1.01):
        place, rate = eccentricity * clearance * np.array([0.6, -0.8]), np.array([2e-3, 1e-3])
        found = shell.force(film, place, rate, clearance)
        d, v = place / clearance, rate / clearance
        felt = clearance * np.array(feel(*d, *v, shell.begins, shell.stiffness)[:4])
        push = np.array(push_back(*d, clearance, shell.begins, shell.stiffness)[:2])
        np.testing.assert_allclose(found.force, film(felt[:2], felt[2:]).force + push, rtol=1e-12)
        np.testing.assert_allclose(shell.felt(place, clearance), felt[:2], rtol=1e-14)
        for column, unit in enumerate(np.eye(2)):
            ahead, behind = (shell.force(film, place + s * 1e-10 * unit, rate, clearance).force for s in (1.0, -1.0))
            np.testing.assert_allclose(found.by_displacement[:, column], (ahead - behind) / 2e-10, 1e-4, 100.0)
            ahead, behind = (shell.force(film, place, rate + s * 1e-6 * unit, clearance).force for s in (1.0, -1.0))
            np.testing.assert_allclose(found.by_velocity[:, column], (ahead - behind) / 2e-6, rtol=1e-6, atol=1e-3)


def test_the_contact_that_the_error_of_a_sinking_ring_names_holds_it() -> None:
    with pytest.raises(InputError) as refused:
        frbcli.stability(ringed(BLOCKED), [SPEED])
    (fault,) = refused.value.faults
    contact = fault.remedy[fault.remedy.index("contact = {") :].split("}")[0] + "}"
    (point,) = frbcli.stability(ringed(BLOCKED, contact.replace("contact = ", "contact=")), [SPEED]).points
    assert point.films[1].eccentricity > 0.9999


def test_a_sheet_says_why_a_film_in_a_narrow_gap_is_hardly_known(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An arc of 0.8 deg in a gap of 1e-4 of the clearance; 0.99, as the remedy says, resolves it. One speed is shown
    by points, and coefficients of both films on one scale."""
    monkeypatch.chdir(tmp_path)
    case = ringed(BLOCKED).with_settings({"contact": {"policy": "elastic", "stiffness": f"{SHELL} N/m"}})
    sheet = frbcli.bearing_sheet(case, [SPEED])
    assert [state.film for state in sheet.pressed] == ["outer"]
    wider = frbcli.bearing_sheet(case.with_settings({"contact.eccentricity": 0.99, "accuracy.mesh": None}), [SPEED])
    assert wider.points[1].error < 0.01
    assert wider.pressed == ()
    panels = bearing_figure(sheet).axes
    assert all(line.get_marker() in ("o", "s") for line in panels[0].lines)
    assert [panel.get_yscale() for panel in panels[2:4]] == ["linear", "symlog"]
    settings = [f"--set={each}" for each in (*FILMS, BLOCKED)]
    contact = f'--set=contact={{policy="elastic", stiffness="{SHELL} N/m"}}'
    assert frb(["bearing", "floating-ring", *settings, contact, "--speed", f"{SPEED} Hz"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "The film outer is pressed into its shell, which keeps a gap of 0.005 um." in told
    assert "e-16" not in told
