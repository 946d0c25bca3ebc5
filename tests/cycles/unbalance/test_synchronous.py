"""The synchronous response with unbalance beside the linear one and a run."""

from __future__ import annotations

import numpy as np
import pytest

import frbcli


@pytest.mark.nightly  # 7 s; of a force: test_two_frequencies.py
def test_a_small_synchronous_motion_is_the_linear_response() -> None:
    """Jeffcott rotor with 1e-3 g mm: amplitudes of the journal by its eight coefficients, whose growth tells its
    stability and is zero where that changes."""
    settings = ["film.theory=short", "rotor.unbalance=1e-3 g*mm", "speed.from=120 Hz", "speed.to=185 Hz"]
    case = frbcli.load_case("jeffcott", settings)
    points = frbcli.limit_cycles(case).synchronous[::4]
    assert {point.stable for point in points} == {True, False}
    linear = frbcli.response(case, sorted(point.speed_Hz for point in points))
    journal = linear.points.index("journal")
    for number, point in enumerate(reversed(points)):
        found = 2.0 * np.abs(point.harmonics[1, 0]) * case.bearings[0].clearance
        np.testing.assert_allclose(found, np.abs(linear.motion[number, journal]), rtol=1e-4)
        if point.kind:
            assert abs(linear.growth[number]) < 1e-4
        else:
            assert point.stable == (linear.growth[number] < 0.0)


def test_the_synchronous_motion_is_that_of_a_run(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """Jeffcott rotor with 60 g mm at 130 Hz, where the orbit is a quarter of the clearance: a run at constant speed."""
    settings = ["film.theory=short", "rotor.unbalance=60 g*mm"]
    constant = ["speed.from=130 Hz", "speed.to=130 Hz", "speed.duration=1.5 s", "output.step=2e-5 s"]
    constant += ["accuracy.tolerance=1e-8", "accuracy.steps_per_revolution=400"]
    run_ = frbcli.runup(frbcli.load_case("jeffcott", [*settings, *constant]), tmp_path / "r.h5")
    seen = run_.signals["eccentricity"][-5000:]
    response = frbcli.limit_cycles(frbcli.load_case("jeffcott", [*settings, "speed.to=130 Hz"])).synchronous
    assert response[0].speed_Hz == pytest.approx(130.0)
    assert response[0].stable
    assert response[0].eccentricity_max[0] == pytest.approx(seen.max(), abs=2e-4)
