"""Heat in bearings of one's own: beside the film of the program that a model copies, and closed forms."""

from __future__ import annotations

import math
import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numba import njit
from paths import DOCS

import frbcli
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.film.bearing_model.model import BearingModel
from frbcli.film.gap import whole_width
from frbcli.film.grid import Mesh
from frbcli.film.rectangles.end_flow import TableEndFlow, make_end_flow
from frbcli.film.rectangles.film import make_film
from frbcli.scene.films import film_places
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import RUN, SPEED_CYCLES
from frbcli.scene.section import film_section

OIL = ("oil.viscosity={grade='SAE 10W-40'}", "oil.density=850 kg/m^3")
HEAT = 'thermal={{supply_temperature="60 degC", clearance="follows", housing="50 degC"{}}}'
PLAIN = ('bearing.supply={kind="none"}', "film.cavitation=sommerfeld", "speed.to=100 Hz", "speed.duration=60 ms")


def warm(theory: str, *more: str, heat: str = "") -> Case:
    return frbcli.load_case("rigid", [f"film.theory={theory}", *PLAIN, *OIL, HEAT.format(heat), *more])


@njit(error_model="numpy")
def full_force(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]
    """Of a short full film: Sommerfeld's integrals of cos^2, sin cos, sin^2 over (1 + eps cos)^3."""
    c, e = bearing.clearance, math.sqrt(d_x * d_x + d_y * d_y)
    n_x, n_y = (d_x / e, d_y / e) if e > 0.0 else (1.0, 0.0)
    w_x, w_y = v_x + 0.5 * omega * d_y, v_y - 0.5 * omega * d_x
    w_r, w_t, eps = n_x * w_x + n_y * w_y, n_x * w_y - n_y * w_x, e / c
    s2 = 1.0 - eps * eps
    k = -0.5 * math.pi * bearing.viscosity * bearing.sections * bearing.diameter * bearing.section_width**3 / c**3
    f_r, f_t = k * (1.0 + 2.0 * eps * eps) / s2**2.5 * w_r, k / s2**1.5 * w_t
    return n_x * f_r - n_y * f_t, n_y * f_r + n_x * f_t


def _ring() -> tuple[np.ndarray, np.ndarray]:
    """Cosines and weights with which the program sums the outflow of a short film around."""
    case = frbcli.load_case("rigid", ["film.theory=short", *PLAIN, "oil.viscosity=10 mPa*s"])
    section = whole_width(film_section(case, film_places(case)[0].geometry))
    found = make_end_flow(section, make_film(section, "short", "sommerfeld", Mesh(4, 4)))
    assert isinstance(found, TableEndFlow)
    return found.ring[0].copy(), found.ring[1].copy()


COSINES, WEIGHTS = _ring()


@njit
def pressed_out(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]
    """What the narrowing part of the gap presses out: b |dh/dt| per length around."""
    e = math.sqrt(d_x * d_x + d_y * d_y)
    n_x, n_y = (d_x / e, d_y / e) if e > 1e-6 * bearing.clearance else (1.0, 0.0)
    w_x, w_y = v_x + 0.5 * omega * d_y, v_y - 0.5 * omega * d_x
    w_r, w_t = n_x * w_x + n_y * w_y, n_x * w_y - n_y * w_x
    total = 0.0
    for i in range(len(COSINES)):
        sine = math.sqrt(max(1.0 - COSINES[i] ** 2, 0.0))
        even, odd = -w_r * COSINES[i], -w_t * sine
        total += WEIGHTS[i] * (max(even + odd, 0.0) + max(even - odd, 0.0))
    return 0.5 * bearing.diameter * bearing.section_width * bearing.sections * total


NAMES = {1.0: "full-gap", 0.5: "half-gap", 0.0: "no-gap"}  # by the share that is sheared
COPY = BearingModel("copy", "short, full film", full_force, flow=pressed_out)


@pytest.fixture(autouse=True)
def added() -> None:
    frbcli.add_bearing(COPY)


def test_a_copy_of_the_film_of_the_program_is_as_warm() -> None:
    """At rest: temperature, viscosity, clearance, power and flow; then stiffness and growth of the warm machine."""
    known, found = (frbcli.warm_machine(warm(name), 90.0) for name in ("short", "copy"))
    (one,), (other,) = known.films, found.films
    assert one.power > 10.0
    assert one.flow > 0.0
    for name in ("temperature", "viscosity", "clearance", "power", "flow"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-9), name
    rests = [frbcli.stability(warm(name), [90.0]).points[0] for name in ("short", "copy")]
    assert rests[1].films[0].stiffness == pytest.approx(rests[0].films[0].stiffness, rel=1e-7)
    assert rests[1].growth == pytest.approx(rests[0].growth, rel=1e-6)
    sheets = [frbcli.bearing_sheet(warm(name), [90.0]).points[0] for name in ("short", "copy")]
    assert sheets[1].temperature == pytest.approx(sheets[0].temperature, rel=1e-9)


@pytest.mark.nightly  # the runs of this file compile a time loop that no other has
def test_a_run_warms_up_as_with_the_film_of_the_program(tmp_path: Path) -> None:
    one, other = (frbcli.runup(warm(name), tmp_path / f"{name}.h5") for name in ("short", "copy"))
    assert one.status == other.status == "finished"
    assert np.ptp(one["temperature_K"]) > 0.5
    assert np.ptp(one["clearance_m"]) > 0.0
    for name in ("temperature_K", "viscosity_Pa_s", "clearance_m", "power_W", "flow_m3_s", "journal_x_m"):
        assert np.max(np.abs(other[name] - one[name])) < 1e-8 * np.max(np.abs(one[name])), name
    assert other.error["heat_balance_relative"] < 1e-9


@njit
def sprung(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """A spring that carries, and a dashpot of the oil: no multiple of its viscosity."""
    c = bearing.viscosity * 1e5
    return -1e6 * d_x - c * v_x, -1e6 * d_y - c * v_y


@pytest.mark.nightly  # the runs of this file compile a time loop that no other has
def test_a_force_that_the_viscosity_does_not_scale_stays(tmp_path: Path) -> None:
    """A journal that rests on a spring does not move when the oil becomes thin."""
    frbcli.add_bearing(BearingModel("sprung", "on springs", sprung))
    still = ("start.position=resting", "rotor.unbalance=0 g*mm", "speed.from=100 Hz")
    case = warm("sprung", *still, heat=', side_flow="concentric"')
    run = frbcli.runup(case, tmp_path / "run.h5")
    assert np.ptp(run["viscosity_Pa_s"]) > 0.01 * run["viscosity_Pa_s"][0]
    sinks = -case.rotor.mass * case.rotor.gravity / 2e6
    assert run["journal_y_m"] == pytest.approx(sinks, rel=1e-9)


def test_a_journal_that_does_not_spin_heats_by_its_motion_alone() -> None:
    """Couette's power of the share of the gap that is sheared, about a journal that a spring carries, which no moment
    turns."""
    for sheared, name in NAMES.items():
        frbcli.add_bearing(BearingModel(name, "sheared", sprung, sheared=sheared))
        case = warm(name, heat=', side_flow="concentric"')
        film, bearing = frbcli.warm_machine(case, 100.0).films[0], case.films[0]
        sinks = case.rotor.mass * case.rotor.gravity / 2e6 / film.clearance
        couette = film.viscosity * (0.5 * bearing.diameter) ** 3 * bearing.width / film.clearance
        couette *= 2.0 * math.pi / math.sqrt(1.0 - sinks**2) * (200.0 * math.pi) ** 2
        assert film.power == pytest.approx(sheared * couette, rel=1e-8, abs=1e-12)


def negative(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, bearing: Any) -> float:  # noqa: ARG001
    return -1e-6 + d_x


def pair(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, bearing: Any) -> Any:  # noqa: ARG001
    return d_x, d_y


def test_what_is_no_flow_is_refused() -> None:
    with pytest.raises(InputError, match=r"flow: returns .*, not 1 number. Return one number, in m"):
        frbcli.add_bearing(BearingModel("mine", "mine", sprung, flow=pair))
    with pytest.raises(InputError, match="sheared: is no share of the gap"):
        frbcli.add_bearing(BearingModel("mine", "mine", sprung, sheared=2.0))
    frbcli.add_bearing(BearingModel("mine", "mine", sprung, flow=negative))
    assert "tells a flow of -1e-06 m^3/s at d = (0, 0) m" in faults(warm("mine"), RUN)[0].problem


def test_a_model_that_tells_no_flow_is_told_which_function_it_needs() -> None:
    frbcli.add_bearing(BearingModel("mine", "mine", sprung))
    (fault,) = faults(warm("mine"), RUN)
    assert fault.key == "film.theory"
    assert "flow(d_x, d_y, v_x, v_y, omega, bearing)" in fault.remedy
    assert not faults(warm("mine", heat=', side_flow="concentric"'), RUN)
    assert any("multiples of each other" in each.problem for each in faults(warm("copy"), SPEED_CYCLES))


@pytest.mark.nightly  # the runs of this file compile a time loop that no other has
def test_the_flow_of_the_page_is_that_of_a_damper(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both examples of the page, one behind the other: a damper that is warm."""
    monkeypatch.chdir(tmp_path)
    section = (DOCS / "adding-a-model.md").read_text(encoding="utf-8").partition("## A bearing of your own")[2]
    examples = re.findall(r"```python\n(.*?)```", section.partition("\n## ")[0], re.DOTALL)
    assert len(examples) == 2
    (tmp_path / "page.py").write_text("\n".join(examples), encoding="utf-8")
    names = runpy.run_path(str(tmp_path / "page.py"))
    run = names["warm"]
    assert run.status == "finished"
    assert run["temperature_K"][-1] > run["temperature_K"][0]
    assert run.error["heat_balance_relative"] < 1e-9
