"""Damping that turns with the shaft: thresholds and growth against closed forms, by stability and by runs. Machines
without damping: no motion grows, whatever round-off makes of it."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Frb

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.linear.stability import stability
from frbcli.plot.machine.modes import campbell_figure
from frbcli.runs.run import runup

TURN = 2.0 * math.pi
MASS, JOURNAL, SHAFT = 10.0, 1e-3, 1e6  # kg, kg, N/m
NATURAL = math.sqrt(SHAFT / MASS)
RIGID = "1e13 N/m"


def jeffcott(external: float, internal: float, at: tuple[float, float] = (5.0, 300.0), **more: Any) -> frbcli.Case:
    """A disk on a shaft in bearings of given coefficients, rigid by default."""
    bearing = {"kind": "coefficients", "stiffness": RIGID}
    tables: dict[str, Any] = {
        "rotor": {"kind": "jeffcott", "mass": MASS, "journal_mass": JOURNAL, "shaft_stiffness": SHAFT, "gravity": 0,
                  "external_damping": f"{external} N*s/m", "internal_damping": f"{internal} N*s/m"},
        "bearing": bearing,
        "speed": {"from": f"{at[0]!r} Hz", "to": f"{at[1]!r} Hz", "duration": "0.4 s"},
    }  # fmt: skip
    rotor = tables["rotor"] | more.pop("rotor", {})
    return case_from_dict(tables | more | {"rotor": rotor}, "internal damping")


@pytest.mark.parametrize(("external", "internal"), [(40.0, 20.0), (5.0, 20.0), (1.0, 0.5)])
def test_a_jeffcott_rotor_whirls_above_its_natural_frequency_times_one_plus_the_ratio(
    external: float, internal: float
) -> None:
    """m v'' + c_e v' + c_i (v' - i Omega v) + k v = 0: at v = exp(i w t) with w^2 = k / m the imaginary part is
    c_e w + c_i (w - Omega) = 0."""
    threshold = stability(jeffcott(external, internal)).threshold
    assert threshold is not None
    assert threshold.speed_Hz == pytest.approx(NATURAL * (1.0 + external / internal) / TURN, rel=1e-6)
    assert threshold.frequency_Hz == pytest.approx(NATURAL / TURN, rel=1e-6)


def test_damping_that_does_not_turn_keeps_the_rotor_stable() -> None:
    case = jeffcott(40.0, 0.0, rotor={"shaft_damping": "20 N*s/m"})
    assert stability(case).threshold is None


def test_orthotropic_supports_raise_the_threshold_as_in_the_closed_form() -> None:
    """Of the deflection of the disk the shaft takes the share r = b / (k + b) in each direction, so that the disk has
    the stiffness k r, the damping c = c_e + c_i r^2 and the cross-coupling c_i Omega r_x r_y. At exp(i w t) the
    determinant (k_x - m w^2 + i c_x w)(k_y - m w^2 + i c_y w) + (c_i Omega r_x r_y)^2 vanishes, first order in the
    dampings: its imaginary part gives w, its real part Omega. With equal dampings and r = 1 that is
    Omega = w (1 + c_e / c_i) sqrt(1 + ((k_x - k_y) / (2 c w))^2)."""
    external, internal, supports = 4.0, 2.0, (1e8, 2e8)
    stiffness = [[f"{0.5 * supports[0]} N/m", "0 N/m"], ["0 N/m", f"{0.5 * supports[1]} N/m"]]  # of one bearing of two
    found = stability(jeffcott(external, internal, bearing={"kind": "coefficients", "stiffness": stiffness}))
    x, y = (b / (SHAFT + b) for b in supports)
    kx, ky, cx, cy = SHAFT * x, SHAFT * y, external + internal * x**2, external + internal * y**2
    square = (cx * ky + cy * kx) / (cx + cy)  # m w^2
    at = math.sqrt(cx * cy * square / MASS - (kx - square) * (ky - square)) / (internal * x * y)
    assert found.threshold is not None
    assert found.threshold.speed_Hz == pytest.approx(at / TURN, rel=1e-5)
    assert found.threshold.speed_Hz > 1.5 * NATURAL * (1.0 + external / internal) / TURN  # of equal supports
    assert found.threshold.frequency_Hz == pytest.approx(math.sqrt(square / MASS) / TURN, rel=1e-5)


@pytest.mark.parametrize("share", [0.8, 1.3])
def test_a_run_grows_and_decays_as_its_eigenvalues(share: float, tmp_path: Path) -> None:
    """Out of the centre both whirls swing about the sag, which turns aside, too."""
    external, internal = 40.0, 20.0
    at = share * NATURAL * (1.0 + external / internal) / TURN
    case = jeffcott(external, internal, (at, at), accuracy={"tolerance": 1e-9}, rotor={"gravity": 9.81})
    (point,) = stability(case, [at]).points
    assert (point.growth > 0.0) == (share > 1.0)
    run = runup(case, tmp_path / "run.h5")
    stiffness = SHAFT - 1j * internal * TURN * at
    z = np.array(run["disk_x_m"]) + 1j * np.array(run["disk_y_m"]) + 1j * MASS * 9.81 / stiffness
    time = np.array(run["time_s"])
    forward, backward = sorted(np.roots([MASS, external + internal, stiffness]), key=lambda root: -root.imag)
    assert point.critical == pytest.approx(forward, rel=1e-6)
    swings = np.exp(np.outer(time, [forward, backward]))
    shares, *_ = np.linalg.lstsq(swings, z, rcond=None)
    assert np.abs(swings @ shares - z).max() < 1e-5 * np.abs(z).max()
    assert min(abs(shares)) > 0.1 * np.abs(z).max()


def test_a_shaft_at_rest_under_its_weight_leans_aside() -> None:
    """(k - i Omega c_i) v = -i m g."""
    internal, at = 300.0, 200.0
    case = jeffcott(40.0, internal, rotor={"gravity": 9.81})
    machine = StaticMachines(case).at(TURN * at)
    disk = dict(machine.system.rotor.points)["disk"] @ machine.at_rest.position.displacements
    still = -1j * MASS * 9.81 / (SHAFT - 1j * TURN * at * internal)
    assert complex(*disk) == pytest.approx(still, rel=1e-5)


def shaft(*, rotor: dict[str, Any], section: dict[str, Any] | None = None, gyroscopic: bool = False) -> frbcli.Case:
    """A long shaft with a disk in its middle in rigid bearings."""
    parts = [{"length": "0.3 m", "diameter": "20 mm"}, {"length": "0.3 m", "diameter": "20 mm"} | (section or {})]
    inertias = {"polar_inertia": "0.02 kg*m^2", "diametral_inertia": "0.01 kg*m^2"} if gyroscopic else {}
    places = (("a", "0 m"), ("b", "0.6 m"))
    bearings = [{"kind": "coefficients", "name": n, "position": p, "stiffness": "1e10 N/m"} for n, p in places]
    return case_from_dict(
        {
            "rotor": {"kind": "turbocharger", "gravity": 0, **rotor},
            "shaft": parts,
            "disk": [{"name": "disk", "position": "0.3 m", "mass": "8 kg", "unbalance": "1 g*mm", **inertias}],
            "bearing": bearings,
            "speed": {"from": "5 Hz", "to": "250 Hz", "duration": "1 s"},
        },
        "shaft",
    )


def test_a_shaft_of_sections_whirls_where_external_damping_ends_to_hold_it() -> None:
    """Internal damping of the time t acts on the first mode with w^2 t (w - Omega), external damping with d w / m of
    the modal mass: Omega = w + d / (m w t), but for the gyroscopic moments of the shaft."""
    time, external = 1e-5, 12.0
    case = shaft(rotor={"internal_damping": f"{time} s", "external_damping": f"{external} N*s/m"})
    found = stability(case)
    assert found.threshold is not None
    undamped = frbcli.damped_modes(shaft(rotor={}), found.threshold.speed_Hz).modes
    first = min((mode for mode in undamped if mode.direction == "forward"), key=lambda mode: mode.frequency_Hz)
    omega = TURN * first.frequency_Hz
    slow = stability(shaft(rotor={"external_damping": f"{external} N*s/m"}), [found.threshold.speed_Hz]).points[0]
    held = -2.0 * slow.eigenvalues[np.argmin(np.abs(slow.eigenvalues - 1j * omega))].real  # d / m
    assert found.threshold.frequency_Hz == pytest.approx(first.frequency_Hz, rel=1e-4)
    assert found.threshold.speed_Hz == pytest.approx((omega + held / (omega * time)) / TURN, rel=5e-4)


def test_a_section_may_have_its_own_internal_damping() -> None:
    """Twice as much in one of two equal halves, but for what that couples to other modes."""
    rotor = {"external_damping": "6 N*s/m"}
    whole = stability(shaft(rotor=rotor | {"internal_damping": "1e-5 s"})).threshold
    half = stability(shaft(rotor=rotor, section={"internal_damping": "2e-5 s"})).threshold
    none = stability(shaft(rotor=rotor | {"internal_damping": "1e-5 s"}, section={"internal_damping": "1e-5 s"}))
    assert whole is not None
    assert half is not None
    assert none.threshold is not None
    assert half.speed_Hz == pytest.approx(whole.speed_Hz, rel=1e-4)
    assert none.threshold.speed_Hz == pytest.approx(whole.speed_Hz, rel=1e-9)


def test_the_response_is_not_damped_by_what_turns_with_the_shaft() -> None:
    """A synchronous circle leaves the shaft bent as it is."""
    case = jeffcott(40.0, 20.0, rotor={"unbalance": "1 g*mm"})
    other = jeffcott(40.0, 0.0, rotor={"unbalance": "1 g*mm"})
    found, without = (frbcli.response(each, [45.0, 50.0, 55.0]).amplitude for each in (case, other))
    np.testing.assert_allclose(found, without, rtol=1e-9)


def test_a_film_whirls_earlier_with_it_and_a_limit_cycle_begins_there() -> None:
    settings = ["film.theory=short", "rotor.internal_damping=3000 N*s/m"]
    case, without = (frbcli.load_case("jeffcott", each) for each in (settings, settings[:1]))
    thresholds = [stability(each).threshold for each in (case, without)]
    assert thresholds[0] is not None
    assert thresholds[1] is not None
    assert thresholds[0].speed_Hz < 0.99 * thresholds[1].speed_Hz
    found = frbcli.limit_cycles(case)
    begins = next(point for point in found.special if point.kind == "hopf")
    assert begins.speed_Hz == pytest.approx(thresholds[0].speed_Hz, rel=1e-3)


def test_a_run_in_turn_has_the_same_motion(tmp_path: Path) -> None:
    """Rotor and film advanced in turn, against both at once."""
    words = ["film.theory=short", "rotor.internal_damping=3000 N*s/m", "speed.from=150 Hz", "speed.to=150 Hz",
             "speed.duration=0.05 s", "accuracy.tolerance=1e-7"]  # fmt: skip
    ways = (words, [*words, "film.coupling=dynamic-static-semi-implicit"], [words[0], *words[2:]])
    both, turns, without = (
        np.array(runup(frbcli.load_case("jeffcott", each), tmp_path / f"{number}.h5")["disk_x_m"])
        for number, each in enumerate(ways)
    )
    assert np.abs(turns - both).max() < 0.02 * np.abs(without - both).max()


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


def test_text_table_and_colours_call_it_undamped(frb: Frb, tmp_path: Any) -> None:
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
    told = frb("stability", str(path), "--no-picture").out
    assert "No threshold" in told
    assert "-0.0" not in told
    document = frb("stability", str(path), "--no-picture", "--json").document
    assert document["threshold"] is None
    assert {point["growing_modes"] for point in document["points"]} == {0}
    figure = campbell_figure(stability(frbcli.load_case(path)))
    labels = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert "does not grow" in labels
    assert len(figure.axes[0].collections[1].get_offsets()) == 0  # those that grow
