"""The report of a run: what it holds, that it needs nothing else, and how a browser shows it."""

import base64
import dataclasses
import json
import os
import re
import shutil
import subprocess
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from synthetic_run import CLEARANCE, Rotor, make_run

import frbcli
from frbcli.case.reading.shipped import shipped_cases
from frbcli.cli.main import frb
from frbcli.elements.table import ELEMENTS, symbols_at
from frbcli.errors import InputError, RunFileError
from frbcli.plot.summary import between
from frbcli.plot.waterfall import LOWEST_dB, STEP_dB
from frbcli.report.page import report
from frbcli.report.sketch import SYMBOLS, film_sketches, rotor_sketch
from frbcli.results.records import Signal
from frbcli.results.store import Run

SETTINGS = ["film.theory=short", "speed.to=250 Hz", "speed.duration=1 s", 'output.signals=["force"]']
BROWSERS = ("chromium", "chromium-headless-shell", "google-chrome", "chromium-browser")
EMPTY = {"meta", "img", "br", "link", "rect", "line", "circle", "path", "image", "input"}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return frbcli.runup(frbcli.load_case("jeffcott", SETTINGS), tmp_path_factory.mktemp("report") / "run.h5")


@pytest.fixture(scope="module")
def page(run: Run) -> str:
    return report(run)


class Balanced(HTMLParser):
    """Every element is closed by its own end."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.wrong: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.ids += [value or "" for name, value in attrs if name == "id"]
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:  # noqa: ARG002
        self.ids += [value or "" for name, value in attrs if name == "id"]

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)


def test_a_page_is_well_formed(page: str) -> None:
    parser = Balanced()
    parser.feed(page)
    assert parser.wrong == []
    assert parser.open == []
    assert len(parser.ids) == len(set(parser.ids))
    anchors = set(re.findall(r'href="#(\w+)"', page))
    assert anchors
    assert anchors <= set(parser.ids)


def test_a_page_needs_nothing_else(page: str) -> None:
    outside = [link for link in re.findall(r'(?:src|href)="([^"]*)"', page) if not link.startswith(("data:", "#"))]
    assert outside == []
    assert "@import" not in page
    assert "url(" not in page
    assert "default-src 'none'" in page


def test_a_page_says_what_the_run_says(page: str, run: Run) -> None:
    words = unescape(re.sub(r"<[^>]+>", " ", page))
    for event in run.events:
        assert f"{event['t_s']:.3f}" in words
        assert f"{event['speed_Hz']:.1f}" in words
    assert f"{run.error['time_integration']:.1e}" in words
    for decision in frbcli.make_plan(frbcli.load_case("jeffcott", SETTINGS)).decisions:
        assert decision.reason in words
    assert "6.1 kg" in words
    assert "frb runup jeffcott.toml -o run.h5" in words
    assert run.case_text.splitlines()[0] in words


def test_repeating_it_gives_the_same_run(page: str, run: Run) -> None:
    text = unescape(re.findall(r"<pre[^>]*>(.*?)</pre>", page, re.DOTALL)[-1])
    assert frbcli.load_case_text(text, name=run.case_name).same_run(frbcli.load_case("jeffcott", SETTINGS))


def test_the_waterfall_reads_what_is_there() -> None:
    """A whirl of known amplitude and frequency stands in the numbers that the script reads."""
    rotor = Rotor(duration_s=4.0, critical_Hz=None, whirl_s=1.0, whirl_amplitude=0.5)
    page = report(make_run(rotor))
    data = json.loads(re.search(r'id="levels">(.*?)</script>', page, re.DOTALL)[1])  # type: ignore[index]
    level = np.frombuffer(base64.b64decode(data["levels"]), dtype=np.uint8)
    level = level.reshape(len(data["frequencies"]), len(data["times"]))
    column = int(np.argmin(np.abs(np.array(data["times"]) - 3.0)))
    row = int(level[:, column].argmax())
    speed = data["speeds"][column]
    assert speed == pytest.approx(75.0 * data["times"][column], rel=1e-3)
    expected = ((0.47 * speed) ** -8 + 125.0**-8) ** (-1 / 8)
    step = data["frequencies"][1] - data["frequencies"][0]
    assert abs(data["frequencies"][row] - expected) < 2.0 * step
    decibel = LOWEST_dB + STEP_dB * float(level[row, column])
    assert data["clearance"] == CLEARANCE
    assert decibel == pytest.approx(20.0 * np.log10(0.5), abs=0.5)


def test_letters_of_a_title_are_no_markup() -> None:
    page = report(make_run(Rotor(duration_s=0.5, whirl_s=None), title='<script>alert("x")</script> & co'))
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert" in page


def test_a_case_of_another_version_leaves_its_parts_out() -> None:
    page = report(make_run(Rotor(duration_s=0.5)))
    assert "is not read by this version" in page
    assert "Orbits and spectra" in page


def test_speeds_are_chosen(run: Run) -> None:
    assert report(run, [100.0]) != report(run, [200.0])
    with pytest.raises(InputError, match="250 Hz"):
        report(run, [100.0, 400.0])


def test_a_run_without_samples_has_no_page() -> None:
    empty = make_run(Rotor(duration_s=0.5))
    columns = {name: type(signal)(signal.values[:0], signal.unit) for name, signal in empty.signals.items()}
    with pytest.raises(RunFileError, match="no samples"):
        report(dataclasses.replace(empty, signals=columns))


@pytest.mark.parametrize("name", shipped_cases())
def test_every_shipped_machine_is_drawn(name: str) -> None:
    case = frbcli.load_case(name)
    if case.given_rotor is not None:
        drawing, note = rotor_sketch(case)
        parser = Balanced()
        parser.feed(drawing)
        assert parser.wrong == []
        assert note.endswith(".")
        assert "nan" not in drawing
        grounds = 2 * len(case.elements) * (1 if case.shaft else 2) + 2 * (case.housing is not None)
        assert drawing.count('class="ground"') == grounds + bool(case.bases)
    assert bool(film_sketches(case)) == bool(case.films)


def test_symbols_of_elements_are_drawn() -> None:
    """Every symbol is drawn, and none is left over; those of a bearing stand from the shaft to the ground."""
    assert {kind.symbol for kind in ELEMENTS} - {""} == set(SYMBOLS)
    case = frbcli.load_case("squeeze-film-damper")
    assert [symbols_at(case, key) for key in case.bearing_keys] == [("spring", "damper")]


def test_a_shaft_is_drawn_to_scale() -> None:
    """The bar of the drawing and the sections of the shaft have one scale along and across the axis."""
    case = frbcli.load_case("turbocharger-car")
    drawing, _ = rotor_sketch(case)
    bar = re.search(r'<line x1="([\d.]+)" y1="[\d.]+" x2="([\d.]+)" y2="[\d.]+" class="bar"', drawing)
    length = re.search(r">([\d.]+) mm<", drawing)
    assert bar is not None
    assert length is not None
    per_mm = (float(bar[2]) - float(bar[1])) / float(length[1])
    boxes = re.findall(r'width="([\d.]+)" height="([\d.]+)" class="shaft"', drawing)
    told = [(1e3 * section.length * per_mm, 1e3 * section.diameter * per_mm) for section in case.shaft]
    np.testing.assert_allclose(np.array(boxes, dtype=float), told, atol=0.02)


def test_the_command_writes_it(run: Run, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    done = CliRunner().invoke(frb, ["report", str(run.path), "-o", str(target), "--speed", "100 Hz"])
    assert done.exit_code == 0
    assert f"report: {target}" in done.output
    assert target.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def browser() -> str | None:
    named = os.environ.get("FRB_BROWSER")
    return named or next((found for name in BROWSERS if (found := shutil.which(name))), None)


@pytest.mark.skipif(browser() is None, reason="no headless browser on this machine")
def test_a_browser_shows_it_and_reads_it_out(run: Run, tmp_path: Path) -> None:
    """Without a network; a pointer in the middle of the picture is told time, speed, frequency and amplitude."""
    text = report(run)
    pointing = """<script>
      const box = document.getElementById("sense").getBoundingClientRect();
      const at = { clientX: box.x + box.width / 2, clientY: box.y + box.height / 2, bubbles: true };
      document.getElementById("sense").dispatchEvent(new PointerEvent("pointermove", at));
    </script>"""
    target = tmp_path / "page.html"
    target.write_text(text.replace("</body>", f"{pointing}</body>"), encoding="utf-8")
    given = [str(browser()), "--headless", "--no-sandbox", "--disable-gpu", "--host-resolver-rules=MAP * ~NOTFOUND"]
    shown = subprocess.run(
        [*given, "--dump-dom", target.as_uri()], capture_output=True, text=True, timeout=120, check=True
    ).stdout
    reading = re.search(r'<p id="reading">(.*?)</p>', shown)
    assert reading is not None
    data = json.loads(re.search(r'id="levels">(.*?)</script>', text, re.DOTALL)[1])  # type: ignore[index]
    column, row = len(data["times"]) // 2, len(data["frequencies"]) // 2
    found = re.match(r"time ([\d.]+) s, rotor ([\d.]+) Hz, frequency ([\d.]+) Hz", reading[1])
    assert found is not None
    assert float(found[1]) == pytest.approx(data["times"][column], rel=5e-3)
    assert float(found[2]) == pytest.approx(data["speeds"][column], rel=5e-3)
    assert float(found[3]) == pytest.approx(data["frequencies"][row], rel=1e-2)
    picture = tmp_path / "page.png"
    subprocess.run(
        [*given, f"--screenshot={picture}", "--window-size=1000,2000", target.as_uri()],
        capture_output=True, timeout=120, check=True,
    )  # fmt: skip
    assert picture.stat().st_size > 50_000


@pytest.fixture(scope="module")
def warm(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A run-up of floating rings with heat, whose case gives its speed in rpm."""
    settings = ["accuracy.target=2e-2", "speed.to=12000 rpm", "speed.duration=0.15 s"]
    return frbcli.runup(frbcli.load_case("floating-ring-heat", settings), tmp_path_factory.mktemp("warm") / "warm.h5")


def test_a_page_about_heat_has_its_pictures_and_speeds_as_the_case(warm: Run) -> None:
    told = report(warm, author="A. Engineer")
    for words in ("Temperatures, viscosities, losses and side flows.", "Speed of the rings over the rotor speed.",
                  "J with the oil", "12000 rpm", "rotor, rpm", "A. Engineer",
                  f"frb {frbcli.__version__}", "stated error of the eccentricity, until"):  # fmt: skip
        assert words in told
    assert "12000 rpm, 200.0 Hz" not in told
    event = {"kind": "onset", "film": "inner", "t_s": 0.1, "speed_Hz": 50.0, "frequency_Hz": 20.0}
    table = report(dataclasses.replace(warm, events=[event | {"frequency_ratio": 0.4}]))
    assert "rotor speed in rpm" in table
    assert '<td>onset Sub_i inner</td><td class="number">0.100</td><td class="number">3000</td>' in table
    assert "12000 rpm, 200.0 Hz" in report(warm, both_units=True)


@pytest.mark.skipif(not any(map(shutil.which, BROWSERS)), reason="no browser")
def test_a_page_has_at_most_six_pages_of_a4(warm: Run, tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text(report(warm), encoding="utf-8")
    browser = next(found for found in map(shutil.which, BROWSERS) if found)
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
               "--disable-background-networking", "--disable-component-update", "--no-pdf-header-footer",
               f"--user-data-dir={tmp_path / 'profile'}", f"--print-to-pdf={tmp_path / 'page.pdf'}"]  # fmt: skip
    subprocess.run([browser, *options, str(tmp_path / "page.html")], capture_output=True, check=True, timeout=120)
    printed = (tmp_path / "page.pdf").read_bytes()
    assert 2 <= len(re.findall(rb"/Type\s*/Page[^s]", printed)) <= 4  # 6 with the values of the case, shown on request


def test_an_orbit_of_few_samples_has_no_corners() -> None:
    """Between samples, four of a revolution, it is the motion itself; without them it misses it by a third."""
    angle = 2.0 * np.pi * np.arange(400) / 4.0 + 0.3
    signal = Signal(np.sin(angle) + 0.5 * np.sin(0.12 * angle), "m")
    found = between(signal, 100, 150, 10)
    exact = 2.0 * np.pi * np.arange(1000, 1491) / 40.0 + 0.3
    assert len(found) == len(exact)
    np.testing.assert_allclose(found, np.sin(exact) + 0.5 * np.sin(0.12 * exact), atol=5e-3)
