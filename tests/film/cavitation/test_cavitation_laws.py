"""Every cavitation law in its unknown w: what it must be a solution of, its slopes, its limits."""

from __future__ import annotations

import numpy as np
import pytest

from frbcli.film.cavitation.elrod import Elrod
from frbcli.film.cavitation.law import Law, Scales
from frbcli.film.cavitation.peeken import Peeken
from frbcli.film.cavitation.penalty import SPREAD, Penalty, steepness_exponent
from frbcli.film.cavitation.reynolds import Reynolds
from frbcli.film.cavitation.sommerfeld import Sommerfeld
from frbcli.film.cavitation.two_phase import PUBLISHED_SLOPE, TwoPhase

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
