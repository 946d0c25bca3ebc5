"""Beams against exact solutions: Euler, Timoshenko, gyroscopic whirl, reduction; and machines that are put together of
them, of supports and of elements."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh, expm
from scipy.optimize import brentq

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.errors import NotConverged
from frbcli.rotor import reduction
from frbcli.rotor.assembly import Link, assembled, held_rotor, point_mass
from frbcli.rotor.beam import BeamSection, Plane, beam
from frbcli.rotor.loads import LinearPart
from frbcli.rotor.reduction import (
    MOST,
    FreeModes,
    Journal,
    Wheel,
    free_modes,
    reduction_error,
    wheels_on_shaft,
    whirl_modes,
)
from frbcli.scene.machine.rotor import make_rotor

SLENDER = BeamSection(1.0, 5e-4, 0.0, 7850.0, 210e9, 0.3)
THICK = BeamSection(0.2, 0.05, 0.02, 7850.0, 210e9, 0.3)
STEPPED = (BeamSection(0.05, 0.02, 0.0, 7850.0, 210e9, 0.3), BeamSection(0.08, 0.03, 0.01, 4500.0, 110e9, 0.34))
NO_SHAFT = BeamSection(0.1, 0.02, 0.0, 1e-6, 1e22, 0.3)  # next to no mass, next to rigid


def pinned(plane: Plane) -> Array:
    """Indices of the degrees of freedom that are left when both ends are held."""
    return np.delete(np.arange(plane.mass.shape[0]), [0, plane.mass.shape[0] - 2])


def pinned_frequencies(plane: Plane) -> Array:
    kept = np.ix_(pinned(plane), pinned(plane))
    return np.sqrt(eigh(plane.stiffness.toarray()[kept], plane.mass.toarray()[kept], eigvals_only=True))


def exact_pinned(section: BeamSection, half_waves: int, omega: float = 0.0) -> float:
    """Slowest forward whirl of a pinned Timoshenko shaft, v = V sin(k z), psi = P cos(k z), polar inertia 2 rho I."""
    k = half_waves * math.pi / section.length
    shear, bending = section.shear_stiffness, section.youngs_modulus * section.second_moment
    line, rotary = section.density * section.area, section.density * section.second_moment
    roots = np.roots(
        np.polysub(
            np.polymul([line, 0.0, -shear * k**2], [rotary, -2 * rotary * omega, -bending * k**2 - shear]),
            [(shear * k) ** 2],
        )
    )
    return float(np.min(roots.real[roots.real > 0]))


def transfer(part: BeamSection, omega: float, spin: float = 0.0) -> Array:
    """(v, psi, moment, shear force) at the end of a Timoshenko shaft that whirls forward, from those at its begin."""
    bending, shear = part.youngs_modulus * part.second_moment, part.shear_stiffness
    line, rotary = part.density * part.area, part.density * part.second_moment
    rates = np.zeros((4, 4))
    rates[0, 1], rates[0, 3] = 1.0, 1.0 / shear
    rates[1, 2] = 1.0 / bending
    rates[2, 1], rates[2, 3] = -rotary * (omega**2 - 2.0 * spin * omega), -1.0
    rates[3, 0] = -line * omega**2
    return np.asarray(expm(rates * part.length))


def free_end_determinant(sections: tuple[BeamSection, ...], omega: float) -> float:
    """Zero where free ends fit the exact solution."""
    whole = np.eye(4)
    for part in sections:
        whole = transfer(part, omega) @ whole
    return float(np.linalg.det(whole[2:, :2]))


def test_slender_free_beam_is_that_of_euler_and_bernoulli() -> None:
    """(beta L) of a free-free beam."""
    found = free_modes(beam([SLENDER], [])).frequencies[2:5]
    stiffness = SLENDER.youngs_modulus * SLENDER.second_moment / (SLENDER.density * SLENDER.area)
    exact = np.array([4.730040745, 7.853204624, 10.995607838]) ** 2 * math.sqrt(stiffness)
    assert found == pytest.approx(exact, rel=1e-5)  # shear and rotary inertia: 3e-6 at the third


def extrapolated(coarse: Array, fine: Array) -> Array:
    """The limit of a second order from meshes one of which is twice as fine."""
    return (4 * fine - coarse) / 3


def test_thick_pinned_beam() -> None:
    found = extrapolated(*(pinned_frequencies(beam([THICK], [], n))[:3] for n in (80, 160)))
    assert found == pytest.approx([exact_pinned(THICK, n) for n in (1, 2, 3)], rel=5e-8)


@pytest.mark.parametrize("sections", [(THICK,), STEPPED], ids=["thick", "stepped"])
def test_free_beams_against_transfer_matrices(sections: tuple[BeamSection, ...]) -> None:
    for found in extrapolated(*(free_modes(beam(sections, [], n)).frequencies[2:5] for n in (78, 156))):
        exact = brentq(lambda omega: free_end_determinant(sections, omega), 0.999 * found, 1.001 * found, rtol=1e-12)
        assert found == pytest.approx(exact, rel=2e-7)


@pytest.mark.parametrize(("section", "order", "meshes"), [(THICK, 2.0, (24, 48, 96)), (SLENDER, 4.0, (6, 12, 24))])
def test_order_of_convergence(section: BeamSection, order: float, meshes: tuple[int, ...]) -> None:
    """The exact static solution of a slender element is a cubic; where shear counts, slopes are next to linear."""
    errors = [pinned_frequencies(beam([section], [], n))[2] / exact_pinned(section, 3) - 1 for n in meshes]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(np.abs(orders - order) < 0.1)


@pytest.mark.parametrize("direction", [1.0, -1.0], ids=["forward", "backward"])
def test_gyroscopic_whirl_of_a_thick_pinned_shaft(direction: float) -> None:
    """Backward whirl is forward whirl of a shaft that turns the other way."""
    omega, plane = direction * 3000.0, beam([THICK], [], 160)
    kept = np.ix_(pinned(plane), pinned(plane))
    mass, stiffness, polar = (part.toarray()[kept] for part in (plane.mass, plane.stiffness, plane.polar))
    n = len(mass)
    state = np.block([[np.zeros((n, n)), np.eye(n)], list(np.linalg.solve(mass, np.hstack([stiffness, omega * polar]))
                                                          .reshape(n, 2, n).swapaxes(0, 1))])  # fmt: skip
    values = np.linalg.eigvals(state).real
    assert np.min(values[values > 0]) == pytest.approx(exact_pinned(THICK, 1, omega), rel=5e-6)
    assert abs(exact_pinned(THICK, 1, omega) / exact_pinned(THICK, 1) - 1) > 1e-3


def test_shear_coefficient_is_that_of_cowper() -> None:
    nu = 0.3
    assert SLENDER.shear_coefficient == pytest.approx(6 * (1 + nu) / (7 + 6 * nu))
    tube = BeamSection(1.0, 1.0, 1.0 - 1e-9, 7850.0, 210e9, nu)
    assert tube.shear_coefficient == pytest.approx(2 * (1 + nu) / (4 + 3 * nu))  # thin-walled


def test_a_rigid_body_keeps_mass_and_inertias_and_is_not_strained() -> None:
    wheel = Wheel("w", 0.05, 2.0, 3e-3, 2e-3, 0.0, 0.0)
    plane = wheels_on_shaft(STEPPED, [wheel], [])
    z = plane.positions
    shift = np.column_stack([np.ones_like(z), np.zeros_like(z)]).ravel()
    tilt = np.column_stack([z, np.ones_like(z)]).ravel()
    parts = [(0.0, STEPPED[0]), (0.05, STEPPED[1])]
    masses = [part.density * part.area * part.length for _, part in parts]
    about_origin = [
        mass * (start**2 + start * part.length + part.length**2 / 3) + part.density * part.second_moment * part.length
        for mass, (start, part) in zip(masses, parts, strict=True)
    ]
    polar = [2 * part.density * part.second_moment * part.length for _, part in parts]
    assert shift @ plane.mass @ shift == pytest.approx(sum(masses) + 2.0, rel=1e-12)
    assert tilt @ plane.mass @ tilt == pytest.approx(sum(about_origin) + 2.0 * 0.05**2 + 2e-3, rel=1e-12)
    assert tilt @ plane.polar @ tilt == pytest.approx(sum(polar) + 3e-3, rel=1e-12)
    assert shift @ plane.polar @ tilt == pytest.approx(0.0, abs=1e-15)
    scale = np.max(np.abs(plane.stiffness.data))
    assert np.max(np.abs(plane.stiffness @ np.column_stack([shift, tilt]))) < 1e-10 * scale
    modes = free_modes(plane)
    assert modes.frequencies[0] == modes.frequencies[1] == 0.0 < modes.frequencies[2]
    assert modes.weight[0] ** 2 == pytest.approx(sum(masses) + 2.0, rel=1e-12)
    assert np.max(np.abs(modes.weight[1:])) < 1e-9


@pytest.mark.parametrize("polar", [4e-3, 1e-3], ids=["disk", "drum"])
def test_exact_gyroscopic_splitting_of_a_rigid_disk(polar: float) -> None:
    """Two springs s at a distance l from the disk: I_d omega^2 - I_p Omega omega - 2 s l^2 = 0, and m omega^2 = 2 s."""
    wheel = Wheel("w", 0.05, 3.0, polar, 2.5e-3, 0.0, 0.0)
    ends = [Journal("a", 0.0), Journal("b", 0.1)]
    modes = free_modes(wheels_on_shaft([NO_SHAFT], [wheel], ends)).lowest(2)
    spring, arm, omega = 1e6, 0.05, 2 * math.pi * 500
    springs = np.stack([modes.at(end.position) for end in ends])
    found = whirl_modes(modes, springs, np.full(2, spring), omega)
    split = np.roots([wheel.diametral_inertia, -polar * omega, -2 * spring * arm**2])
    shift = math.sqrt(2 * spring / wheel.mass)
    assert np.sort(found.frequencies) == pytest.approx(sorted([*split, shift, -shift]), rel=1e-9)
    assert whirl_modes(modes, springs[:0], np.zeros(0), omega).frequencies == pytest.approx(
        [omega * polar / wheel.diametral_inertia], rel=1e-6
    )


def test_what_a_reduction_leaves_out() -> None:
    """All modes together have the flexibility of the shaft between its ends; the missing part is what the rest adds."""
    ends = [Journal("a", 0.0), Journal("b", 0.2)]
    modes = free_modes(wheels_on_shaft([THICK], [], ends))

    def held(some: FreeModes) -> np.ndarray:
        return np.stack([some.at(end.position) for end in ends])

    springs = held(modes)
    none = reduction_error(modes, modes, held, np.full(2, 1e7), 100.0)
    assert none.frequency == 0.0
    assert not none.missing_flexibility.any()
    few, more = (reduction_error(modes, modes.lowest(count), held, np.full(2, 1e7), 100.0) for count in (4, 8))
    step = springs[:, 4:8] / modes.frequencies[4:8]
    assert few.missing_flexibility - more.missing_flexibility == pytest.approx(step @ step.T, rel=1e-9)
    assert 0 < more.frequency < few.frequency < 0.05
    assert np.all(few.reduced >= few.full)  # Rayleigh: fewer modes are stiffer, where nothing turns quickly
    limp = replace(modes, frequencies=np.where(np.arange(len(modes.frequencies)) < 4, 0.0, modes.frequencies))
    assert np.isfinite(reduction_error(limp, limp.lowest(8), held, np.full(2, 1e7), 100.0).missing_flexibility).all()


def test_slowest_modes_of_many_sections_are_those_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    wheel, ends = Wheel("w", 0.04, 2.0, 3e-3, 2e-3, 0.0, 0.0), [Journal("a", 0.01), Journal("b", 0.12)]
    sections = [replace(STEPPED[i % 2], length=0.13 / 320) for i in range(320)]
    plane = wheels_on_shaft(sections, [wheel], ends)
    slowest = free_modes(plane)
    monkeypatch.setattr(reduction, "DENSE", 1000)
    all_of_them = free_modes(plane)
    assert len(slowest.frequencies) == MOST < len(all_of_them.frequencies)
    assert slowest.frequencies == pytest.approx(all_of_them.frequencies[:MOST], rel=1e-7)
    springs = [np.stack([modes.at(end.position) for end in ends]) for modes in (slowest, all_of_them)]
    both = zip((slowest, all_of_them), springs, strict=True)
    found = [whirl_modes(modes, at, np.full(2, 1e7), 500.0) for modes, at in both]
    assert found[0].frequencies[:8] == pytest.approx(found[1].frequencies[:8], rel=1e-4)  # locally bent


def test_every_station_has_its_node_however_close_others_are() -> None:
    """Of places in a row, each nearer to the one before than nodes are told apart, none is left without a node."""
    near = 0.9e-6 * THICK.length
    stations = [0.05 + i * near for i in range(9)] + [THICK.length - i * near for i in range(3)]
    shaft = beam((THICK,), stations, elements=4)
    found = [shaft.positions[shaft.node(station)] for station in stations]
    np.testing.assert_allclose(found, stations, rtol=0, atol=2e-6 * THICK.length)
    assert np.all(np.diff(shaft.positions) > 0.0)


GRAVITY = 9.81


def springs(x: float, y: float, damping: float = 0.0) -> LinearPart:
    return LinearPart(np.zeros(1), np.diag([x, y])[None], damping * np.eye(2)[None], np.zeros((1, 2, 2)))


def test_a_film_between_a_journal_and_a_support_on_springs() -> None:
    """The film sees the motion of the journal in its shell, which the support moves: rest is the film's own sag in
    series with that of the springs."""
    bodies = [point_mass("journal", 0.5, GRAVITY), point_mass("shell", 0.2, GRAVITY)]
    machine = assembled(bodies, [Link("journal", "shell")], [(Link("shell"), springs(2e6, 2e6))])
    assert machine.journals.tolist() == [[[1.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, -1.0]]]
    held = held_rotor(machine)
    assert held.load == pytest.approx([0.0, -0.5 * GRAVITY], rel=1e-12)  # on the film, whatever carries its shell
    assert held.stiffness == pytest.approx(np.zeros((2, 2)), abs=1e-6)
    sag = 0.7 * GRAVITY / 2e6
    at = np.array([3e-6, -9e-6])
    assert held.shape + held.following @ at == pytest.approx([at[0], at[1] - sag, 0.0, -sag], rel=1e-9)


def test_an_element_sees_the_coordinates_that_it_asks_for() -> None:
    one = LinearPart(np.zeros(1), np.array([[[7e5]]]), np.zeros((1, 1, 1)), np.zeros((1, 1, 1)))
    machine = assembled([point_mass("journal", 2.0, GRAVITY)], parts=[(Link("journal", sees=("y",)), one)])
    assert machine.stiffness.tolist() == [[0.0, 0.0], [0.0, 7e5]]


def test_a_node_that_no_body_has() -> None:
    with pytest.raises(KeyError):
        assembled([point_mass("journal", 2.0, GRAVITY)], [Link("journal", "housing")])


def test_bearings_at_one_place_hold_no_rotor_whatever_the_last_digits_say() -> None:
    """On the shaft of a turbocharger; a micrometre apart they hold it, and carry its weight together."""
    at = "bearing.1.position={} mm"
    rotor, apart = (make_rotor(load_case("turbocharger-car", [at.format(place)])) for place in ("42", "42.001"))
    with pytest.raises(NotConverged, match="different positions"):
        held_rotor(rotor)
    carried = held_rotor(apart).load.reshape(-1, 2).sum(axis=0)
    placed = held_rotor(make_rotor(load_case("turbocharger-car"))).load.reshape(-1, 2).sum(axis=0)
    assert carried == pytest.approx(placed, rel=1e-6)
