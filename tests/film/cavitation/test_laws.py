"""Every cavitation law in its unknown w: what it must be a solution of, its slopes, limits and films; the formulas of
Bayada and Chupin; and theta(p), which the picture shows."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from commands import Frb

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.film.cavitation.barotropic import Barotropic, vapour_fraction
from frbcli.film.cavitation.conditions import Elrod, Reynolds, Sommerfeld
from frbcli.film.cavitation.law import FilmOil, Law, Scales
from frbcli.film.cavitation.penalty import SPREAD, Penalty, steepness_exponent
from frbcli.film.cavitation.two_phase import PUBLISHED_SLOPE, Peeken, TwoPhase
from frbcli.plot.machine.film import law_figure

SCALES = Scales(reference=40.0, cavitation=-2.0, ambient=10.0)  # p_cav = 8 absolute
CAVITY = SCALES.cavitation + SCALES.ambient

LAWS: dict[str, Law] = {
    "sommerfeld": Sommerfeld(),
    "reynolds": Reynolds(),
    "elrod": Elrod(),
    "elrod, compressible": Elrod(bulk_modulus=500.0),
    "penalty": Penalty(0.01, 2.0),
    "peeken": Peeken(0.1),
    "peeken, all air": Peeken(1.0),
    "two-phase 0.9": TwoPhase(0.9),
    "two-phase 0.9999": TwoPhase(0.9999),
    "two-phase 0.99, no slope": TwoPhase(0.99, outer_slope=0.0),
}
W = np.concatenate([np.linspace(-1.3, 2.0, 331), [-1e-6, 1e-6, -1e-3, 1e-3]])


@pytest.mark.parametrize("law", LAWS)
def test_slopes_are_those_of_the_values(law: str) -> None:
    w = W[np.abs(W) > 1e-4]  # not at the kink
    step = 1e-8
    up, down, here = (LAWS[law].cells(w + shift, SCALES) for shift in (step, -step, 0.0))
    for value, slope in (("pressure", "pressure_slope"), ("fraction", "fraction_slope"), ("source", "source_slope")):
        difference = (getattr(up, value) - getattr(down, value)) / (2.0 * step)
        stated = getattr(here, slope)
        scale = 1.0 if value == "fraction" else SCALES.reference
        kinks = np.abs(difference - stated) > 1e-4 * scale
        assert np.count_nonzero(kinks) <= 2, f"{value} at w = {w[kinks]}"  # the law's own corners


@pytest.mark.parametrize("law", LAWS)
def test_pressure_and_oil_never_fall_with_w_and_one_of_all_rises(law: str) -> None:
    state = LAWS[law].cells(W, SCALES)
    assert np.all(state.pressure_slope >= 0.0)
    assert np.all(state.fraction_slope >= 0.0)
    assert np.all(state.source_slope <= 0.0)
    total = state.pressure_slope / SCALES.reference + state.fraction_slope - state.source_slope / SCALES.reference
    assert np.all(total > 0.4)  # so that Newton's matrix is never singular for want of an unknown


@pytest.mark.parametrize("law", LAWS)
def test_full_film_at_the_cavitation_pressure_is_where_w_is_zero(law: str) -> None:
    near = LAWS[law].cells(np.array([-1e-12, 1e-12]), SCALES)
    if law != "penalty":  # which has its source at any pressure
        assert near.pressure == pytest.approx([SCALES.cavitation] * 2, abs=1e-6)
        assert near.source == pytest.approx([0.0, 0.0], abs=1e-9)
    assert near.fraction == pytest.approx([1.0, 1.0], abs=1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_laws_that_conserve_have_no_source_and_the_others_all_oil(law: str) -> None:
    state = LAWS[law].cells(W, SCALES)
    if LAWS[law].conserves:
        assert not state.source.any()
    else:
        assert np.all(state.fraction == 1.0)
        assert state.source[0] > 0.0


def test_elrod_is_either_full_or_at_the_cavitation_pressure() -> None:
    state = Elrod().cells(W, SCALES)
    above = state.pressure - SCALES.cavitation
    assert np.all((1.0 - state.fraction) * above == 0.0)
    assert np.all(above >= 0.0)
    assert np.all(state.fraction <= 1.0)


def test_compressible_elrod_is_its_logarithm() -> None:
    """(3.35): p = p_cav + beta ln(theta) in the full film."""
    state = LAWS["elrod, compressible"].cells(W[W > 0.0], SCALES)
    assert state.pressure == pytest.approx(SCALES.cavitation + 500.0 * np.log(state.fraction))


def test_reynolds_is_a_complementarity() -> None:
    state = Reynolds().cells(W, SCALES)
    above = state.pressure - SCALES.cavitation
    assert np.all(above * state.source == 0.0)
    assert np.all((above >= 0.0) & (state.source >= 0.0))


def test_penalty_is_its_exponential_at_any_depth() -> None:
    """(3.31), also where the exponential itself would overflow on the way to its inverse."""
    w = np.concatenate([W, [-1e4, 1e4]])
    state = LAWS["penalty"].cells(w, SCALES)
    source = 0.01 * np.exp(-2.0 * (state.pressure - SCALES.cavitation))
    assert state.source == pytest.approx(source, rel=1e-9)
    unknown = (state.pressure - SCALES.cavitation - state.source / SPREAD) / SCALES.reference
    assert unknown == pytest.approx(w, rel=1e-10)
    assert steepness_exponent(0.5) == pytest.approx(1000.0)  # (3.32)


@pytest.mark.parametrize("bunsen", [0.1, 0.5, 1.0])
def test_peeken_is_its_bubble_fraction(bunsen: float) -> None:
    """(3.38) and (3.39) of the absolute pressure, between no pressure and p_cav."""
    state = Peeken(bunsen).cells(W[W < 0.0], SCALES)
    pressure = state.pressure + SCALES.ambient
    inside = pressure > 1e-6
    bubbles = -bunsen * (pressure[inside] - CAVITY) / pressure[inside]
    assert state.fraction[inside] == pytest.approx(1.0 / (1.0 + bubbles), rel=1e-9)
    assert np.count_nonzero(inside) > 50


@pytest.mark.parametrize("steepness", [0.9, 0.99, 0.999, 0.9999])
@pytest.mark.parametrize("slope", [PUBLISHED_SLOPE, 1e-9, 0.0])
def test_two_phase_is_its_step(steepness: float, slope: float) -> None:
    """(4.32) of the pressure that belongs to w, on the step and on either side of it."""
    law = TwoPhase(steepness, slope)
    state = law.cells(W, SCALES)
    fraction, _ = law.fraction((state.pressure + SCALES.ambient) / CAVITY)
    assert state.fraction == pytest.approx(fraction, abs=1e-10)


def test_two_phase_step_has_the_printed_shape() -> None:
    """Half full at x_1 (4.35), empty at x_0 but for the outer slope, full at p_cav, steepest at x_1."""
    law = TwoPhase(0.95, outer_slope=0.0)
    fraction, slope = law.fraction(np.array([0.5, 0.9, 0.95, 1.0, 2.0]))
    assert fraction == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])
    assert slope == pytest.approx([0.0, 0.0, 15.0, 0.0, 0.0])
    fraction, slope = TwoPhase(0.95).fraction(np.array([0.5, 2.0]))
    assert fraction == pytest.approx([0.5e-3, 1.001])
    assert slope == pytest.approx([1e-3, 1e-3])


def test_two_phase_tends_to_elrod() -> None:
    w = W[W > -1.0]
    exact = Elrod().cells(w, SCALES)
    gaps = [np.abs(TwoPhase(x, 0.0).cells(w, SCALES).pressure - exact.pressure).max() for x in (0.9, 0.99, 0.999)]
    assert gaps == pytest.approx([CAVITY * 2.0 * (1.0 - x) for x in (0.9, 0.99, 0.999)], rel=0.3)


DENSITY, C_L, C_V, VAPOUR, SCALE = 850.0, 1400.0, 350.0, 0.8e5, 250.0
GIVEN = SimpleNamespace(liquid_sound_speed=C_L, vapour_sound_speed=C_V)
LAW = Barotropic.scaled(GIVEN, FilmOil(SCALE, 1e5, VAPOUR, DENSITY))
OWN_SCALES = Scales(reference=700.0, cavitation=(VAPOUR - 1e5) / SCALE, ambient=1e5 / SCALE)
VAPOUR_DENSITY = LAW.emptied * DENSITY
MIXED = np.concatenate([np.linspace(-1.6, 0.5, 2001), -np.logspace(-13, -1, 100)])


def state() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(rho, p absolute in Pa, dp/drho) of cells."""
    cells = LAW.cells(MIXED, OWN_SCALES)
    return (
        DENSITY * cells.fraction,
        1e5 + SCALE * cells.pressure,
        SCALE * cells.pressure_slope / (DENSITY * cells.fraction_slope),
    )


def test_pressures_are_the_integral_of_wood_from_the_vapour_on() -> None:
    """From rho_v c_v^2 at rho_v; the law itself counts from p_cav at rho_l."""
    density, pressure, _ = state()
    light, heavy = VAPOUR_DENSITY * C_V**2, DENSITY * C_L**2
    factor = light * heavy * (VAPOUR_DENSITY - DENSITY) / (VAPOUR_DENSITY * light - DENSITY * heavy)
    void = (DENSITY - density) / (DENSITY - VAPOUR_DENSITY)
    mixed = (density > VAPOUR_DENSITY) & (density < DENSITY)
    rho, alpha = density[mixed], void[mixed]
    expected = light + factor * np.log(heavy * rho / (VAPOUR_DENSITY * (light * (1.0 - alpha) + heavy * alpha)))
    assert np.count_nonzero(mixed) > 1000
    assert pressure[mixed] == pytest.approx(expected, rel=1e-7)  # void fractions of 1e-13 are differences of densities
    liquid = density > DENSITY
    assert pressure[liquid] == pytest.approx(VAPOUR + C_L**2 * (density[liquid] - DENSITY), rel=1e-9)
    vapour = density < VAPOUR_DENSITY
    assert np.count_nonzero(vapour) > 10
    assert pressure[vapour] == pytest.approx(C_V**2 * density[vapour], rel=1e-6, abs=1e-2)


def test_speed_of_sound_is_woods() -> None:
    density, _, square = state()
    mixed = (density > VAPOUR_DENSITY) & (density < DENSITY)
    rho = density[mixed]
    void = (DENSITY - rho) / (DENSITY - VAPOUR_DENSITY)
    wood = void / (VAPOUR_DENSITY * C_V**2) + (1.0 - void) / (DENSITY * C_L**2)
    assert square[mixed] == pytest.approx(1.0 / (rho * wood), rel=1e-6)
    assert square[density > DENSITY] == pytest.approx(C_L**2, rel=1e-9)
    assert square[density < VAPOUR_DENSITY] == pytest.approx(C_V**2, rel=1e-9)


def test_curve_is_that_of_the_films() -> None:
    over_cavity = Barotropic.scaled(GIVEN, FilmOil(VAPOUR, 1e5, VAPOUR, DENSITY))
    density, pressure, _ = state()
    assert over_cavity.curve(pressure / VAPOUR) == pytest.approx(density / DENSITY, abs=1e-9)


def test_it_is_elrods_where_the_cavity_has_hardly_any_pressure() -> None:
    """At a p_cav of 0.01 bar the mixture has no room to fall below it."""
    settings = ("motion={ eccentricity = 0.85, speed = '60 Hz' }", "oil.cavitation_pressure=0.01 bar")
    case = load_case("bearing-axial-groove", (*settings, "accuracy.mesh=[8, 64]"))
    own, elrod = (result.loads for result in frbcli.rotation(case, ("barotropic", "elrod")).results)
    assert own is not None
    assert elrod is not None
    assert elrod.oil_fraction < 0.97  # it does cavitate
    assert own.force == pytest.approx(elrod.force, abs=5e-3 * float(np.hypot(*elrod.force)))
    assert own.oil_fraction == pytest.approx(elrod.oil_fraction, abs=5e-3)


def test_run_up_keeps_its_oil(tmp_path: Path) -> None:
    settings = ("speed.duration=2 ms", "speed.from=40 Hz", "speed.to=41 Hz", "accuracy.mesh=[3, 24]")
    case = load_case("axial-groove-two-phase", ("film.cavitation=barotropic", "accuracy.tolerance=1e-5", *settings))
    run = frbcli.runup(case, tmp_path / "run.h5")
    assert run.status == "finished"
    assert 0.5 < run["oil_fraction"][-1] < 1.0 + 1e-3
    assert abs(run.error["oil_balance_relative"]) < 1e-6  # what Newton leaves of a curved law is carried on


UNIT = 5.0  # 1/s, absolute
UNIT_SCALES = Scales(reference=3.0, cavitation=0.0, ambient=UNIT)


def curve(law: Law) -> tuple[np.ndarray, np.ndarray]:
    """p / p_cav and theta (n,) of what a film is solved with."""
    state = law.cells(np.linspace(-1.5, 0.5, 401), UNIT_SCALES)
    ratio, kept = 1.0 + state.pressure / UNIT, state.fraction > 1e-3
    return ratio[kept], state.fraction[kept]


def test_curves_are_those_of_the_films() -> None:
    ratio, fraction = curve(TwoPhase(0.9))
    np.testing.assert_allclose(TwoPhase(0.9).curve(ratio), fraction, atol=1e-9)
    ratio, fraction = curve(Peeken(0.1))
    np.testing.assert_allclose(Peeken(0.1).curve(ratio), fraction, atol=1e-12)
    ratio, fraction = curve(Elrod(bulk_modulus=20.0 * UNIT))
    full = ratio > 1.0
    np.testing.assert_allclose(Elrod(20.0).curve(ratio[full]), fraction[full], rtol=1e-12)
    assert np.all(ratio[~full] == 1.0)  # every fraction at p_cav itself


@pytest.mark.parametrize("model", ["two-phase", "peeken", "elrod", "half-sommerfeld"])
def test_picture_names_the_case_and_its_model(model: str) -> None:
    settings = [f"film.cavitation={model}", "film.peeken.bunsen=0.3", "film.two-phase.steepness=0.97"]
    figure = law_figure(load_case("bearing", settings))
    assert figure.get_suptitle().startswith("Journal bearing, groove at one end")
    left, right = figure.axes
    assert "bar" in left.get_xlabel()
    labels = [text.get_text() for axes in (left, right) for text in axes.get_legend().get_texts()]
    own = [label for label in labels if label.endswith("(the case)")]
    assert len(own) == {"two-phase": 2, "peeken": 1, "elrod": 1, "half-sommerfeld": 0}[model]
    assert any("0.97" in label for label in labels)
    assert any("0.3" in label for label in labels)
    thick = [line for line in right.lines if line.get_linewidth() > 1.5]
    assert len(thick) == (0 if model == "half-sommerfeld" else 1)


def test_laws_that_this_oil_cannot_have_are_left_out() -> None:
    """A vapour as stiff as the oil, and one that is nowhere lighter: no law of Bayada and Chupin."""
    with pytest.raises(ValueError, match="lighter than the liquid"):
        vapour_fraction(8.3e-4 * 350.0**2, 8.3e-4 * 1400.0**2, 1e5)
    speeds = ["film.barotropic.vapour_sound_speed=1400 m/s", "film.barotropic.liquid_sound_speed=1400 m/s"]
    labels = [text.get_text() for text in law_figure(load_case("bearing", speeds)).axes[1].get_legend().get_texts()]
    assert not any("Bayada" in label for label in labels)
    assert any("Peeken" in label for label in labels)


def test_command_draws_a_case(frb: Frb, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    found = frb("plot", "bearing", "--what", "law", "--set", "film.cavitation=elrod", "--json").document
    assert found == {"command": "plot", "case": "bearing", "output": "bearing-law.png", "what": "law"}
    assert (tmp_path / "bearing-law.png").stat().st_size > 10_000
