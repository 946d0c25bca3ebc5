"""Kinematic tests of the short bearing against its closed forms (Ocvirk, DuBois), and against the film on cells."""

import math

import numpy as np
import pytest

from frbcli.bearing_tests.kinematic import KinematicResult, rotation, squeeze
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.errors import InputError

R, B, C, ETA = 12.5e-3, 20e-3, 40e-6, 10e-3
OMEGA = 2.0 * math.pi * 20.0
LENGTHS = 2.0 * (0.5 * B) ** 3  # of the two lands beside the groove


def case(motion: str, *settings: str) -> Case:
    groove = "bearing.supply={ kind = 'circumferential-groove', pressure = '1 bar' }"
    return load_case("bearing", [groove, "film.theory=short", f"motion={{{motion}}}", *settings])


def solved(found: tuple[KinematicResult, ...]) -> KinematicResult:
    (result,) = found
    assert result.loads is not None
    return result


@pytest.mark.parametrize("e", [0.2, 0.6, 0.9])
def test_rotation_has_ocvirks_force(e: float) -> None:
    """Back and across: eta omega R L^3 / C^2 times e^2 / (1 - e^2)^2 and pi e / (4 (1 - e^2)^1.5); is
    Petrov's over sqrt(1 - e^2) and half the moment of the force."""
    motion = f"eccentricity={e}, angle='-90 deg', speed='20 Hz'"
    result = solved(rotation(case(motion), ["half-sommerfeld"]).results)
    loads, s2 = result.loads, 1.0 - e * e
    assert loads is not None
    scale = ETA * OMEGA * R * LENGTHS / C**2
    back, across = scale * e * e / s2**2, scale * math.pi * e / (4.0 * s2**1.5)
    assert loads.force[1] == pytest.approx(back, rel=1e-6)
    assert abs(loads.force[0]) == pytest.approx(across, rel=1e-6)
    petrov = 2.0 * math.pi * ETA * OMEGA * R**3 * B / C
    moment = 0.5 * e * C * across
    assert -loads.torque.journal == pytest.approx(petrov / math.sqrt(s2) + moment, rel=1e-6)
    assert -loads.torque.shell == pytest.approx(petrov / math.sqrt(s2) - moment, rel=1e-6)
    theta = np.linspace(0.0, math.pi, 20001)
    pressure = 3.0 * ETA * OMEGA * e * np.sin(theta) / (C**2 * (1.0 - e * np.cos(theta)) ** 3) * (0.25 * B) ** 2
    assert loads.p_max - 1e5 == pytest.approx(pressure.max(), rel=1e-3)
    assert loads.p_min == pytest.approx(1e5)
    assert result.theory == "short"


def test_force_error_is_that_of_the_theory() -> None:
    """B/D of a land is 0.4: the short bearing is too stiff, the more the larger the eccentricity."""
    errors = []
    for e in (0.3, 0.8):
        motion = f"eccentricity={e}, angle='-60 deg', speed='20 Hz'"
        short = solved(rotation(case(motion), ["half-sommerfeld"]).results)
        finite = solved(rotation(case(motion, "film.theory=finite"), ["half-sommerfeld"]).results)
        assert short.loads is not None
        assert finite.loads is not None
        far = math.dist(short.loads.force, finite.loads.force) / math.hypot(*finite.loads.force)
        assert short.force_error == pytest.approx(far, rel=1e-3)
        errors.append(far)
    assert 0.02 < errors[0] < errors[1] < 1.0


def test_supply_adds_a_line_along_the_width() -> None:
    """Without cavitation a pressure in the groove carries nothing, and rises from the ends to the groove."""
    motion = "eccentricity=0, angle='-90 deg', speed='20 Hz'"
    result = solved(rotation(case(motion, "bearing.supply.pressure=3 bar"), ["sommerfeld"]).results)
    assert result.loads is not None
    assert result.field is not None
    assert result.loads.force == pytest.approx((0.0, 0.0), abs=1e-9)
    assert (result.loads.p_min, result.loads.p_max) == pytest.approx((1e5, 3e5))
    assert result.field.pressure[7] == pytest.approx(1e5 + 2e5 * result.field.z)
    flow = 2.0 * (2.0 * math.pi * R) * C**3 * 2e5 / (12.0 * ETA * 0.5 * B)
    assert result.loads.oil.out_m3_s == pytest.approx(flow, rel=1e-3)


def test_it_rests_where_it_carries_the_load() -> None:
    result = solved(rotation(case("load='50 N', speed='20 Hz'"), ["half-sommerfeld"]).results)
    assert result.loads is not None
    assert result.loads.force == pytest.approx((0.0, 50.0), abs=1e-3)


def test_squeeze_of_a_full_film_has_its_closed_form() -> None:
    """F = -pi eta R L^3 e' (1 + 2 e^2) / (C^2 (1 - e^2)^2.5) without cavitation."""
    result = solved(squeeze(case("eccentricity=0.6, frequency='10 Hz', periods=1"), ["sommerfeld"]).results)
    assert result.history is not None
    rate = 2.0 * math.pi * 10.0
    e, v = -0.6 * np.sin(rate * result.history.time_s), -0.6 * rate * np.cos(rate * result.history.time_s)
    force = -math.pi * ETA * R * LENGTHS * v * (1.0 + 2.0 * e * e) / (C**2 * (1.0 - e * e) ** 2.5)
    assert result.history.force[:, 1] == pytest.approx(force, rel=1e-6, abs=1e-6 * float(np.abs(force).max()))
    assert result.history.gap_ratio == pytest.approx(1.0 + e)
    probe = -6.0 * ETA * C * v / (C * (1.0 + e)) ** 3 * 0.25 * (0.5 * B) ** 2  # in the middle of a land, at the bottom
    assert result.history.probe_pressure - 1e5 == pytest.approx(probe, rel=1e-6, abs=1e-3)


def test_short_tests_are_of_films_that_clip_a_pressure() -> None:
    with pytest.raises(InputError, match="short is for half-sommerfeld"):
        rotation(case("eccentricity=0.5, speed='20 Hz'"), ["two-phase"])
