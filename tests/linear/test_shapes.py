"""Critical speed maps, damped modes and their pictures, and moving orbits, against closed forms and each other."""

from __future__ import annotations

import itertools
import json
import math
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image
from synthetic_run import Rotor, make_run

import frbcli
from frbcli.cli.main import frb
from frbcli.errors import InputError
from frbcli.linear.critical_map import critical_map
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.response import response
from frbcli.linear.stability import stability
from frbcli.plot.machine.modes import shapes_figure
from frbcli.plot.machine.response import critical_map_figure
from frbcli.plot.moving import FRAMES, animate_orbits

PLAIN = [  # a turbocharger in plain bearings, with all its modes
    "rotor.cutoff=1000 kHz", "rotor.modal_damping=0", "film.theory=short", "film.cavitation=half-sommerfeld",
    "speed.to=3000 Hz",
]  # fmt: skip
BEARING = """
[[bearing]]
kind = "single-film"
name = "{name}"
position = "{position}"
width = "5 mm"
diameter = "7 mm"
clearance = "15 um"
ends = "oil-bath"
"""
ROSS = os.environ.get("FRB_ROSS_PYTHON", "")  # an interpreter that has it


def plain_turbocharger() -> frbcli.Case:
    text = frbcli.load_case("turbocharger-car").source_text
    start, end = text.index("[[bearing]]"), text.index("[oil]")
    both = "".join(BEARING.format(name=n, position=p) for n, p in (("front", "42 mm"), ("rear", "74 mm")))
    return frbcli.load_case_text(text[:start] + both + text[end:], PLAIN, name="plain")


def test_a_rigid_rotor_has_one_critical_speed_on_springs() -> None:
    case = frbcli.load_case("rigid")
    found = critical_map(case, [1e5, 1e7])
    expected = np.sqrt(2.0 * np.array([1e5, 1e7]) / case.rotor.mass) / (2 * math.pi)  # type: ignore[union-attr]
    np.testing.assert_allclose(found.forward[:, 0], expected, rtol=1e-12)
    assert np.isnan(found.forward[:, 1:]).all()


def test_a_jeffcott_rotor_has_its_closed_form() -> None:
    """Two masses and two springs in a row; between rigid bearings sqrt(c / m)."""
    case = frbcli.load_case("jeffcott")
    rotor = case.rotor
    m, j, c = rotor.mass, rotor.journal_mass, rotor.shaft_stiffness  # type: ignore[union-attr]
    k = 3e6
    found = critical_map(case, [k, 1e14])
    a, b, d = m * j, -(m * (c + 2 * k) + j * c), 2 * k * c
    squares = np.sort(np.roots([a, b, d]))
    np.testing.assert_allclose(found.forward[0, :2], np.sqrt(squares) / (2 * math.pi), rtol=1e-9)
    np.testing.assert_allclose(found.backward, found.forward, rtol=1e-12)  # nothing turns
    assert found.forward[1, 0] == pytest.approx(math.sqrt(c / m) / (2 * math.pi), rel=1e-5)


def test_critical_speeds_of_a_turbocharger_are_those_of_its_campbell_diagram() -> None:
    """At a critical speed the rotor, turning with it, has a natural frequency of that whirl that equals it."""
    case = frbcli.load_case("turbocharger-car")
    for k in (1e6, 1e8):
        found = critical_map(case, [k])
        for direction, speeds in (("forward", found.forward[0]), ("backward", found.backward[0])):
            assert len(speeds) > 0
            for speed in speeds[:2]:
                modes = frbcli.natural_modes(case, k, [speed]).points[0].directed(direction)
                assert min(abs(mode.frequency_Hz - speed) for mode in modes) < 1e-6 * speed


def test_stiffer_bearings_never_lower_a_critical_speed() -> None:
    found = critical_map(frbcli.load_case("turbocharger-heavy"))
    for values in (found.forward, found.backward):
        rise = np.diff(values, axis=0)
        assert (rise[np.isfinite(rise)] > -1e-9).all()


def test_a_stiffness_is_positive() -> None:
    for wrong in ([], [0.0], [-1.0], [math.inf]):
        with pytest.raises(InputError, match="greater than 0"):
            critical_map(frbcli.load_case("rigid"), wrong)


@pytest.mark.parametrize(("name", "speed"), [("jeffcott", 200.0), ("rigid", 100.0)])
def test_damped_modes_are_those_of_the_stability(name: str, speed: float) -> None:
    case = frbcli.load_case(name, ["film.theory=short"])
    found = damped_modes(case, speed)
    point = stability(case, [speed]).points[0]
    mine = np.sort_complex(np.array([mode.eigenvalue for mode in found.modes]))
    np.testing.assert_allclose(mine, np.sort_complex(point.oscillating), rtol=1e-9)
    worst = found.modes[0]
    assert worst.direction == "forward"  # oil whirl
    assert worst.eigenvalue == pytest.approx(point.critical)
    largest = max(float(np.max(np.abs(mode.shape))) for mode in found.modes)
    assert largest <= 1.0 + 1e-12
    decrement = 2 * math.pi * worst.damping_ratio / math.sqrt(1 - worst.damping_ratio**2)
    assert worst.logarithmic_decrement == pytest.approx(decrement)


def test_shapes_pass_through_the_points_of_a_run() -> None:
    case = plain_turbocharger()
    found = damped_modes(case, 2000.0)
    assert found.to_scale
    for mode in found.modes:
        for name, motion in zip(found.points, mode.motion, strict=True):
            place = next(at for mark, at in found.marks if mark == name.partition("_")[2])
            nearest = int(np.argmin(np.abs(found.positions - place)))
            np.testing.assert_allclose(mode.shape[nearest], motion, atol=1e-9)


def test_a_turbocharger_whirls_in_both_senses() -> None:
    found = damped_modes(plain_turbocharger(), 2500.0)
    assert {mode.direction for mode in found.modes} >= {"forward", "backward"}
    assert len(shapes_figure(found).axes) == min(6, len(found.modes))


def test_the_map_shows_the_films_of_the_case() -> None:
    case = frbcli.load_case("jeffcott", ["film.theory=short"])
    resting = response(case, [50.0, 100.0, 200.0]).resting
    found = critical_map(case, None, resting)
    assert found.film_stiffness.shape == (3, 1)
    mean = 0.5 * np.trace(resting[0].films[0].stiffness)
    assert found.film_stiffness[0, 0] == pytest.approx(mean)
    labels = [line.get_label() for line in critical_map_figure(found).axes[0].get_lines()]
    assert "stiffness of the films" in labels


@pytest.mark.parametrize("words", [["stability", "jeffcott", "--shapes", "200 Hz"], ["response", "jeffcott", "--map"]])
def test_commands_draw_them(words: list[str], tmp_path: Path) -> None:
    target = tmp_path / "picture.png"
    done = CliRunner().invoke(frb, [*words, "--set", "film.theory=short", "-o", str(target)])
    assert done.exit_code == 0, done.output
    assert target.stat().st_size > 10_000
    if "stability" in words:
        assert "backward" in done.output


def test_shapes_stand_alone() -> None:
    assert CliRunner().invoke(frb, ["stability", "jeffcott", "--shapes", "9 Hz", "--speed", "9 Hz"]).exit_code == 2


def test_orbits_move(tmp_path: Path) -> None:
    run = make_run(Rotor(duration_s=1.0, whirl_s=0.5))
    path = animate_orbits(run, tmp_path / "orbit.gif", frames=12, dpi=50)
    with Image.open(path) as image:
        assert image.n_frames == 12  # type: ignore[attr-defined]
        first = np.asarray(image.convert("L"), dtype=float)
        image.seek(6)
        assert np.abs(np.asarray(image.convert("L"), dtype=float) - first).max() > 50.0
    assert FRAMES > 12
    with pytest.raises(InputError, match=r"\.gif"):
        animate_orbits(run, tmp_path / "orbit.png")
    if shutil.which("ffmpeg") is None:
        with pytest.raises(InputError, match="ffmpeg"):
            animate_orbits(run, tmp_path / "orbit.mp4")


ROSS_SCRIPT = """
import json, sys
import numpy as np
import ross as rs
data = json.load(open(sys.argv[1]))
steel = rs.Material("steel", rho=data["density"], E=data["young"], Poisson=data["poisson"])
shaft = [rs.ShaftElement(L=l, idl=0.0, odl=d, material=steel, shear_effects=True, rotary_inertia=True,
                         gyroscopic=True, shear_method_calc="cowper") for l, d in data["elements"]]
disks = [rs.DiskElement(n=n, m=m, Id=i, Ip=p) for n, m, i, p in data["disks"]]
omega = np.array(data["omega"])
bearings = [rs.BearingElement(n=b["n"], frequency=omega, **{key: np.array(b[key]) for key in (
    "kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")}) for b in data["bearings"]]
rotor = rs.Rotor(shaft, disks, bearings)
nodes, sizes, phases = zip(*data["unbalance"])
found = rotor.run_unbalance_response(list(nodes), list(sizes), list(phases), frequency=omega)
response = np.array(found.forced_resp)
dof = rotor.number_dof
places = [[response[dof * n], response[dof * n + 1]] for n in data["nodes"]]
out = np.array(places)  # (points, 2, speeds)
json.dump({"real": out.real.tolist(), "imag": out.imag.tolist()}, open(sys.argv[2], "w"))
"""


def test_a_film_goes_to_ffmpeg_frame_by_frame(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program of this name that writes down its line and what it gets."""
    program = tmp_path / "ffmpeg"
    program.write_text('#!/bin/sh\necho "$@" > "$0.line"\nfor last; do :; done\ncat > "$last"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    path = animate_orbits(make_run(Rotor(duration_s=1.0)), tmp_path / "orbit.mp4", frames=5)
    line = (tmp_path / "ffmpeg.line").read_text()
    width, height = map(int, re.search(r"-s (\d+)x(\d+)", line).groups())  # type: ignore[union-attr]
    assert path.stat().st_size == 5 * 4 * width * height  # red, green, blue, alpha


@pytest.mark.skipif(not ROSS, reason="no interpreter with ROSS (FRB_ROSS_PYTHON)")
def test_the_response_is_that_of_ross(tmp_path: Path) -> None:
    """The same shaft, wheels, unbalances and coefficients of films: amplitudes of all points within 0.1 %."""
    case = plain_turbocharger()
    speeds = [300.0, 700.0, 1100.0, 1500.0, 1900.0]
    found = response(case, speeds)
    places = sorted({0.0, *(d.position for d in case.disks), *(b.position or 0.0 for b in case.bearings)}
                    | {0.034, 0.092} | set(np.linspace(0.0, 0.092, 24).tolist()))  # fmt: skip
    kept = [places[0]]
    for place in places[1:]:
        if place - kept[-1] > 1e-9:
            kept.append(place)
    node = {round(place, 9): number for number, place in enumerate(kept)}
    middle = [(b - a, 0.005 if 0.5 * (a + b) < 0.034 else 0.007) for a, b in itertools.pairwise(kept)]
    bearings = []
    for number, bearing in enumerate(case.bearings):
        entry: dict[str, object] = {"n": node[round(bearing.position or 0.0, 9)]}
        for letter, name in (("k", "stiffness"), ("c", "damping")):
            for i, x in enumerate("xy"):
                for j, y in enumerate("xy"):
                    told = [float(getattr(point.films[number], name)[i, j]) for point in found.resting]
                    entry[f"{letter}{x}{y}"] = told
        bearings.append(entry)
    data = {
        "density": 7850.0, "young": 210e9, "poisson": 0.3, "elements": middle,
        "disks": [(node[round(d.position, 9)], d.mass, d.diametral_inertia, d.polar_inertia) for d in case.disks],
        "bearings": bearings,
        "omega": [2 * math.pi * speed for speed in speeds],
        "unbalance": [(node[round(d.position, 9)], d.unbalance, d.phase) for d in case.disks if d.unbalance > 0.0],
        "nodes": [node[round(b.position or 0.0, 9)] for b in case.bearings]
        + [node[round(d.position, 9)] for d in case.disks],
    }  # fmt: skip
    (tmp_path / "in.json").write_text(json.dumps(data))
    (tmp_path / "script.py").write_text(ROSS_SCRIPT)
    subprocess.run(
        [ROSS, str(tmp_path / "script.py"), str(tmp_path / "in.json"), str(tmp_path / "out.json")],
        cwd=tmp_path, check=True, capture_output=True, timeout=300,
        env={key: value for key, value in os.environ.items() if key != "PYTHONPATH"},
    )  # fmt: skip
    told = json.loads((tmp_path / "out.json").read_text())
    theirs = np.array(told["real"]) + 1j * np.array(told["imag"])
    for point in range(len(found.points)):
        x, y = found.motion[:, point, 0], found.motion[:, point, 1]
        size = np.abs(found.motion[:, point]).max(axis=1)
        for mine, other in ((x, theirs[point, 0]), (y, theirs[point, 1])):
            np.testing.assert_allclose(np.abs(mine), np.abs(other), atol=1e-3 * size.max())
