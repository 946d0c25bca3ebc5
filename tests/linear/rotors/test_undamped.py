"""Machines without damping: no motion grows, whatever round-off makes of it."""

import json
import math
from typing import Any

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.cli.main import run as frb
from frbcli.linear.stability import stability
from frbcli.plot.machine.modes import campbell_figure

SPEED = {"from": "1 Hz", "to": "80 Hz", "duration": "1 s"}


def bearing(x: float, y: float, damping: float = 0.0, **more: str) -> dict[str, Any]:
    stiffness = [[f"{x!r} N/m", "0 N/m"], ["0 N/m", f"{y!r} N/m"]]
    return {"kind": "coefficients", "stiffness": stiffness, "damping": f"{damping!r} N*s/m", **more}


def overhung(x: float, y: float, damping: float = 0.0, top: str = "80 Hz") -> frbcli.Case:
    """A shaft with a disk behind its bearings."""
    places = (("left", "0 m"), ("right", "1 m"))
    return case_from_dict(
        {
            "rotor": {"kind": "turbocharger", "modes": 20, "gravity": 0},
            "shaft": [{"length": "1.5 m", "diameter": "25 mm", "density": "7810 kg/m^3"}],
            "disk": [{"name": "disk", "position": "1.5 m", "mass": "15.3 kg", "diametral_inertia": "0.062 kg*m^2",
                      "polar_inertia": "0.12 kg*m^2"}],
            "bearing": [bearing(x, y, damping, name=name, position=place) for name, place in places],
            "speed": {**SPEED, "to": top},
        },
        "overhung",
    )  # fmt: skip


def symmetric(kind: str, stiffness: float) -> frbcli.Case:
    rotor = {"kind": kind, "mass": "2 kg", "gravity": 0}
    more = {"journal_mass": "0.1 kg", "shaft_stiffness": "1e6 N/m"} if kind == "jeffcott" else {}
    return case_from_dict({"rotor": rotor | more, "bearing": bearing(stiffness, stiffness), "speed": SPEED}, kind)


@pytest.mark.parametrize("kind", ["rigid", "jeffcott"])
@pytest.mark.parametrize("stiffness", [1e-3, 1.0, 1e6, 1e12])
def test_a_symmetric_rotor_on_soft_and_stiff_springs_is_not_unstable(kind: str, stiffness: float) -> None:
    found = stability(symmetric(kind, stiffness))
    assert found.threshold is None
    assert found.note.startswith("No threshold up to 80 Hz")
    assert {point.growth for point in found.points} == {0.0}
    lowest = found.points[0].oscillating[0].imag
    mass, shaft = (2.0, math.inf) if kind == "rigid" else (2.0 + (0.1 if stiffness < 1e6 else 0.0), 1e6)
    if stiffness != 1e6:
        series = 1.0 / (1.0 / (2.0 * stiffness) + (0.0 if stiffness < 1e6 else 1.0 / shaft))
        assert lowest == pytest.approx(math.sqrt(series / mass), rel=2e-3)


@pytest.mark.parametrize("top", ["80 Hz", "5000 Hz"])
@pytest.mark.parametrize(("x", "y"), [(10e6, 10e6), (0.2e6, 0.4e6), (1e-3, 2e-3), (1e12, 1e12)])
def test_gyroscopic_moments_make_nothing_grow(x: float, y: float, top: str) -> None:
    found = stability(overhung(x, y, top=top))
    assert found.threshold is None
    assert all((point.eigenvalues.real == 0.0).all() for point in found.points)


def test_a_free_rotor_has_modes_of_a_rigid_body_that_do_not_grow() -> None:
    (point,) = stability(overhung(0.0, 0.0), [50.0]).points
    assert np.count_nonzero(point.eigenvalues == 0.0) == 6  # two translations, and two tilts that do not precess
    assert len(point.growing) == 0


@pytest.mark.parametrize("damping", [1e-6, 1e-3, 1.0])
def test_the_least_damping_is_seen(damping: float) -> None:
    """Growth is in proportion to a small damping, down to below the round-off of the fastest eigenvalue, 1e6 1/s."""
    (point,) = stability(overhung(0.2e6, 0.4e6, damping), [50.0]).points
    (unit,) = stability(overhung(0.2e6, 0.4e6, 1.0), [50.0]).points
    slow, other = (each.eigenvalues[np.argsort(np.abs(each.eigenvalues))[:8]].real for each in (point, unit))
    assert (slow < 0.0).all()
    np.testing.assert_allclose(np.sort(slow) / damping, np.sort(other), rtol=1e-3)


def test_an_undamped_rotor_becomes_unstable_where_cross_coupling_passes_half_the_difference_of_its_springs() -> None:
    """(k_x - m w^2)(k_y - m w^2) + q^2 = 0 has complex w from q = (k_y - k_x) / 2 on."""
    columns = {"kxx": [1e6, 1e6], "kxy": [0.0, 1e6], "kyx": [0.0, -1e6], "kyy": [1.2e6, 1.2e6]}
    table = {"speed": ["0 Hz", "200 Hz"], **{name: [f"{k} N/m" for k in values] for name, values in columns.items()}}
    table |= {name: ["0 N*s/m", "0 N*s/m"] for name in ("cxx", "cxy", "cyx", "cyy")}
    element = {"kind": "coefficients", "over_speed": table}
    rotor = {"kind": "rigid", "mass": "2 kg", "gravity": 0}
    found = stability(case_from_dict({"rotor": rotor, "bearing": element, "speed": SPEED}, "crossed"))
    assert found.threshold is not None
    assert found.threshold.speed_Hz == pytest.approx(20.0, rel=1e-6)


def test_text_table_and_colours_call_it_undamped(capsys: pytest.CaptureFixture[str], tmp_path: Any) -> None:
    text = """
[rotor]
kind = "jeffcott"
mass = "2 kg"
journal_mass = "0.1 kg"
shaft_stiffness = "1e6 N/m"
[[bearing]]
kind = "coefficients"
stiffness = "1e6 N/m"
[speed]
from = "0 Hz"
to = "300 Hz"
duration = "10 s"
"""
    path = tmp_path / "undamped.toml"
    path.write_text(text, encoding="utf-8")
    assert frb(["stability", str(path), "--no-picture"]) == 0
    told = capsys.readouterr().out
    assert "No threshold" in told
    assert "-0.0" not in told
    assert frb(["stability", str(path), "--no-picture", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["threshold"] is None
    assert {point["growing_modes"] for point in document["points"]} == {0}
    figure = campbell_figure(stability(frbcli.load_case(path)))
    labels = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert "does not grow" in labels
    assert len(figure.axes[0].collections[1].get_offsets()) == 0  # those that grow
