"""Magnetic pull: closed forms of rigid and Jeffcott rotor, static instability, faults."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.errors import InputError
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.modes import natural_modes
from frbcli.linear.response import response
from frbcli.linear.stability import stability
from frbcli.runs.run import runup
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import RUN
from frbcli.scene.machine.rotor import make_rotor

M, U, K, SHAFT = 20.0, 1e-3, 5e7, 3e7  # kg, kg m; N/m of one bearing, of the shaft
JOURNAL = 2.0  # kg, both
PULL = 4e6  # N/m
TURN = 2.0 * math.pi


def pulled(kind: str, at: str, pull: float = PULL, **more: Any) -> frbcli.Case:
    rotor = {"kind": kind, "mass": f"{M} kg", "unbalance": f"{U!r} kg*m", "external_damping": "0 N*s/m"}
    if kind == "jeffcott":
        rotor |= {"journal_mass": f"{JOURNAL} kg", "shaft_stiffness": f"{SHAFT!r} N/m"}
    data = {
        "rotor": rotor,
        "bearing": {"kind": "coefficients", "stiffness": f"{K!r} N/m"},
        "magnetic_pull": [{"at": at, "pull": f"{pull!r} N/m", **more}],
        "speed": {"from": "100 Hz", "to": "100 Hz", "duration": "20 ms"},
    }
    return case_from_dict(data, "pulled")


def test_a_rigid_rotor_vibrates_with_the_stiffness_that_is_left() -> None:
    """omega = ((k - k_p) / m)^0.5, with k and k_p at each of both journals, and rests lower by the same ratio."""
    case, left = pulled("rigid", "journal"), 2.0 * (K - PULL)
    expected = math.sqrt(left / M)
    (point,) = stability(case, [100.0]).points
    np.testing.assert_allclose(np.abs(point.eigenvalues.imag), expected, rtol=1e-9)
    assert max(mode.frequency_Hz for mode in damped_modes(case, 100.0).modes) == pytest.approx(
        expected / TURN, rel=1e-9
    )
    answer = response(case, [100.0])
    omega = TURN * 100.0
    np.testing.assert_allclose(np.abs(answer.motion[0, 0, 1]), U * omega**2 / (left - M * omega**2), rtol=1e-9)
    np.testing.assert_allclose(np.linalg.solve(make_rotor(case).stiffness, make_rotor(case).static_load)[1],
                               -M * case.rotor.gravity / left, rtol=1e-9)  # fmt: skip


def test_a_pull_on_the_disk_of_a_jeffcott_rotor_is_in_parallel_with_its_shaft() -> None:
    found = stability(pulled("jeffcott", "disk"), [100.0]).points[0].eigenvalues
    a, b, c = (
        M * JOURNAL,
        M * (SHAFT + 2.0 * K) + JOURNAL * (SHAFT - PULL),
        (SHAFT - PULL) * (SHAFT + 2.0 * K) - SHAFT**2,
    )
    for root in np.sqrt((b + np.array([-1.0, 1.0]) * math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)):
        assert np.sum(np.abs(np.abs(found.imag) - root) < 1e-9 * root) == 4


def test_a_run_keeps_the_energy_with_the_potential_of_the_pull(tmp_path: Path) -> None:
    """A rotor without unbalance that begins in the middle swings about its lower rest with (k - k_p)."""
    case = pulled("rigid", "journal").with_settings("rotor.unbalance=0 g*mm", "accuracy.tolerance=1e-9")
    run = runup(case, tmp_path / "run.h5")
    left = 2.0 * (K - PULL)
    expected = -M * case.rotor.gravity / left * (1.0 - np.cos(math.sqrt(left / M) * run["time_s"]))
    np.testing.assert_allclose(run["journal_y_m"], expected, atol=1e-6 * np.abs(expected).max())


def test_a_stator_on_a_housing_pulls_at_both() -> None:
    """Only their distance counts: both on one body feel nothing."""
    housing = {"mass": "40 kg", "mounts": [{"stiffness": "3e7 N/m"}]}
    case = case_from_dict({
        "rotor": {"kind": "rigid", "mass": f"{M} kg"},
        "bearing": {"kind": "coefficients", "stiffness": f"{K!r} N/m"},
        "housing": housing, "magnetic_pull": [{"at": "journal", "pull": f"{PULL!r} N/m", "stator": "housing"}],
        "speed": {"from": "100 Hz", "to": "100 Hz", "duration": "20 ms"},
    }, "housed")  # fmt: skip
    left, own = 2.0 * (K - PULL), 3e7
    expected = np.roots([M * 40.0, 0, M * (left + own) + 40.0 * left, 0, left * own])
    found = stability(case, [100.0]).points[0].eigenvalues
    for value in expected:
        assert np.sum(np.abs(found - value) < 1e-9 * abs(value)) == 2


@pytest.mark.parametrize(("kind", "at", "limit"), [
    ("rigid", "journal", K), ("jeffcott", "disk", 1.0 / (1.0 / SHAFT + 0.5 / K)),
])  # fmt: skip
def test_a_pull_beyond_the_stiffness_is_refused(kind: str, at: str, limit: float) -> None:
    """Just above the limit, and the remedy is accepted."""
    assert not faults(pulled(kind, at, 0.999 * limit), RUN)
    (fault,) = faults(pulled(kind, at, 1.001 * limit), RUN)
    assert fault.key == "magnetic_pull.0.pull"
    remedy = fault.remedy.split("at most ")[1].split(",")[0]
    assert not faults(pulled(kind, at, 1.001 * limit).with_settings(f"magnetic_pull.0.pull={remedy}"), RUN)


def test_films_are_no_stiffer_than_rigid_ones() -> None:
    """What even they do not hold is refused; what a film gives way to is an eigenvalue that grows without whirling."""
    settings = ["rotor.unbalance=0 g*mm", "film.theory=short"]
    shaft = load_case("jeffcott", settings).rotor.shaft_stiffness  # type: ignore[union-attr]
    pull = 'magnetic_pull=[{{ at = "disk", pull = "{:g} N/m" }}]'
    (fault,) = faults(load_case("jeffcott", [*settings, pull.format(1.01 * shaft)]), RUN)
    assert "films" in fault.problem
    (point,) = stability(load_case("jeffcott", [*settings, pull.format(0.98 * shaft)]), [5.0]).points
    assert point.eigenvalues.real.max() > 0.0


def test_natural_frequencies_on_springs_leave_it_out_and_say_so() -> None:
    with pytest.raises(InputError, match="adds to the bearings"):
        natural_modes(load_case("turbocharger-car", ['magnetic_pull=[{ at = "disk_turbine", pull = "1e5 N/m" }]']), 1e7)
