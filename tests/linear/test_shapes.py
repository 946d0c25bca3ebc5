"""Critical speed maps, damped modes and their pictures, and moving orbits, against closed forms and each other."""

import math
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image
from synthetic_run import Rotor, make_run

import frbcli
from frbcli.cli.main import frb
from frbcli.errors import InputError
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.modes import critical_map
from frbcli.linear.response import response
from frbcli.linear.stability import stability
from frbcli.plot import style
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


def test_damped_modes_are_those_of_the_stability() -> None:
    case = frbcli.load_case("jeffcott", ["film.theory=short"])
    found = damped_modes(case, 200.0)
    point = stability(case, [200.0]).points[0]
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


def test_names_of_places_beside_each_other_have_rows_of_their_own() -> None:
    """The watch of all pictures sees it: "nut" and "compressor" covered each other."""
    found = damped_modes(frbcli.load_case("jeffcott", ["film.theory=short"]), 200.0)
    places = found.positions[0] + np.ptp(found.positions) * np.array([0.0, 0.05, 0.12, 0.4, 0.9])
    marks = tuple(zip(("nut", "compressor", "left", "right", "turbine"), places.tolist(), strict=True))
    style.picture(shapes_figure(replace(found, marks=marks)), ".png")


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
