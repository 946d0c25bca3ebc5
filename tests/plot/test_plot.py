"""Pictures of made-up runs: what is drawn is what the run holds. What a notebook shows of cases, plans, runs and
results."""

import inspect
import io
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from importlib.resources import files
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from paths import ROOT
from synthetic_run import CLEARANCE, Rotor, as_run, make_run, signals

import frbcli
from frbcli.analysis.order_tracking import order_tracks
from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.errors import InputError, RunFileError
from frbcli.plot.curves import orders_figure
from frbcli.plot.motion import displacement_figure, eccentricity_figure, orbit_figure, quantity_figure, visible_steps
from frbcli.plot.picture import PICTURES, fit
from frbcli.plot.picture import picture as picture_of
from frbcli.plot.signals import DRAWN_POINTS, Envelope, at_times, clearance, curve, labels, model
from frbcli.plot.style import new_figure, picture, save_figure, styled
from frbcli.plot.summary import between, ring_speed_figure, summary_figure
from frbcli.plot.waterfall import LEVELS_dB, run_spectra, waterfall_figure
from frbcli.results.records import pieces
from frbcli.results.store import Run
from frbcli.results.write import MARK

FILM = '[film]\ntheory = "finite"\ncavitation = "{}"\n'


@pytest.fixture(scope="module")
def run() -> Run:
    return replace(make_run(), case_text=FILM.format("half-sommerfeld"))


@pytest.fixture(scope="module")
def up_and_down() -> Run:
    return make_run(Rotor(duration_s=6.0, whirl_s=None, step_s=2e-4, speeds_Hz=(0.0, 300.0, 300.0, 0.0)))


def texts(figure: Figure) -> str:
    """All that is written in a figure."""
    figure.draw_without_rendering()
    return "\n".join(text.get_text() for text in figure.findobj(mpl.text.Text))


def levels(axes: Axes) -> QuadMesh:
    (mesh,) = (artist for artist in axes.collections if isinstance(artist, QuadMesh))
    return mesh


def test_waterfall_shows_the_whirl_where_it_is(run: Run) -> None:
    axes = waterfall_figure(run, "time").axes[0]
    mesh = levels(axes)
    assert mesh.get_clim() == LEVELS_dB
    level = np.asarray(mesh.get_array())
    assert np.isfinite(level).all()
    edges = mesh.get_coordinates()
    time_s, frequency = edges[0, :-1, 0], edges[:-1, 0, 1]
    loudest = np.unravel_index(np.argmax(level), level.shape)
    assert level.max() == pytest.approx(20 * np.log10(0.8), abs=0.5)
    assert time_s[loudest[1]] > 6.5
    assert 90.0 < frequency[loudest[0]] < 130.0
    assert axes.get_ylim()[1] == pytest.approx(1.2 * 300.0, abs=2.0)


def test_waterfall_of_a_ring_draws_the_ring_lines(run: Run) -> None:
    columns = {name: run[name] for name in run.signals}
    ring = {"ring_x_m": run["journal_x_m"], "ring_y_m": run["journal_y_m"]}
    ringed = as_run(columns | ring | {"ring_speed_Hz": 0.25 * run["speed_Hz"]})
    drawn = [np.asarray(line.get_ydata())[-1] for line in waterfall_figure(ringed, "time").axes[0].get_lines()]
    np.testing.assert_allclose(np.array(drawn) / drawn[0], [1.0, 0.625, 0.125])


def test_waterfall_over_speed_of_an_up_and_down_run_has_two_parts(up_and_down: Run) -> None:
    figure = waterfall_figure(up_and_down, over="speed")
    assert [axes.get_title("left") for axes in figure.axes[:2]] == ["run-up", "run-down"]
    for axes in figure.axes[:2]:
        assert (np.diff(levels(axes).get_coordinates()[0, :, 0]) >= 0.0).all()


def test_a_run_up_is_drawn_over_speed_with_the_time_above_and_its_events_by_number(run: Run, up_and_down: Run) -> None:
    events = [
        {"kind": "critical-speed", "t_s": 4.0, "speed_Hz": 120.0, "frequency_Hz": 120.0, "film": None, "point": "disk"},
        {"kind": "onset", "t_s": 6.5, "speed_Hz": 195.0, "frequency_Hz": 97.0, "film": "journal", "point": None},
    ]
    figure = waterfall_figure(replace(run, events=events))
    axes = figure.axes[0]
    assert axes.get_xlabel() == "rotor speed in Hz"
    marks = {text.get_text(): text.xy for text in axes.texts if text.get_text().isdigit()}
    assert marks == {"1": (120.0, 120.0), "2": (195.0, 97.0)}
    written = texts(figure)
    assert "time in s" in written
    assert "1  critical-speed disk, 120.0 Hz" in written
    assert "2  onset journal, 195.0 Hz" in written
    (above,) = axes.child_axes
    low, high = above.get_xlim()
    assert (low, high) == pytest.approx([place / 30.0 for place in axes.get_xlim()], abs=0.02)
    fit(figure, rpm=True)
    assert axes.get_xlabel() == "rotor speed in rpm"
    assert waterfall_figure(up_and_down).axes[0].get_xlabel() == "time in s"
    over_time = waterfall_figure(run, "time")
    fit(over_time, rpm=True)
    assert over_time.axes[0].child_axes[0].get_xlabel() == "rotor speed in rpm"


def test_orders_of_which_one_would_not_be_seen_have_a_panel_each(run: Run) -> None:
    figure = orders_figure(run, order_tracks(run, [1.0, 0.5], "journal"))
    assert [axes.get_ylabel() for axes in figure.axes] == ["1X in µm", "0.5X in µm"]
    for axes in figure.axes:
        (line,) = axes.get_lines()
        assert np.nanmax(line.get_ydata()) > 0.3 * axes.get_ylim()[1]
    (together,) = orders_figure(run, order_tracks(run, [1.0, 0.5], "journal"), log=True).axes
    assert len(together.get_lines()) == 2


def test_waterfall_over_speed_at_constant_speed_is_refused() -> None:
    constant = make_run(Rotor(duration_s=1.0, whirl_s=None, critical_Hz=None, speeds_Hz=(200.0, 200.0)))
    with pytest.raises(InputError, match="constant speed"):
        waterfall_figure(constant, over="speed")


def test_cascade_has_a_curve_per_spectrum_on_its_own_floor(run: Run) -> None:
    figure = waterfall_figure(run, "time", cascade=True)
    curves = [line for line in figure.axes[0].get_lines() if len(np.asarray(line.get_xdata())) > 200]
    floors = [np.min(line.get_ydata()) for line in curves if line.get_linestyle() == "-"]
    assert len(floors) == 60
    assert (np.diff(floors) < 0.0).all()  # from the back to the front
    assert "60 dB" in texts(figure)


def test_eccentricities_are_overlaid_and_told_apart_by_model(run: Run) -> None:
    other = replace(run, case_text=FILM.format("reynolds"))
    figure = eccentricity_figure([run, other])
    assert len(figure.axes[0].get_lines()) == 2
    assert "Reynolds, finite bearing" in texts(figure)
    for line in figure.axes[0].get_lines():
        assert np.max(line.get_ydata()) == np.max(run["eccentricity"])


def test_labels_fall_back_to_files(run: Run) -> None:
    assert labels([run, replace(run, path=Path("b/other.h5"))]) == ["run", "other"]
    assert len(set(labels([run, replace(run, path=Path("b/run.h5"))]))) == 2
    for text in ("", "film = 3", "[film]\ncavitation = 3", "[film]\ncavitation = ['\\u001b']"):
        assert model(replace(run, case_text=text)) == ""
    assert model(replace(run, case_text='[film]\ncavitation = { two-phase = { steepness = 0.9 } }')) == "two-phase"


@pytest.fixture(scope="module")
def ringed() -> Run:
    """A run-up and run-down on a floating ring that turns with a quarter of the rotor's speed."""
    columns = signals(Rotor(duration_s=3.0, whirl_s=None, step_s=2e-4, speeds_Hz=(0.0, 300.0, 300.0, 0.0)))
    inner = columns.pop("eccentricity")
    columns |= {"eccentricity_inner": inner, "eccentricity_outer": 0.5 * inner, "oil_fraction_inner": 1 - 0.2 * inner}
    columns |= {"ring_x_m": 0.5 * columns["journal_x_m"], "ring_y_m": 0.5 * columns["journal_y_m"]}
    columns["ring_speed_Hz"] = 0.25 * columns["speed_Hz"]
    clearances = {"clearance_m_inner": 4e-5, "clearance_m_outer": 5e-5}
    return replace(as_run(columns), case_text=load_case("floating-ring").source_text, references=clearances)


def test_inner_and_outer_films_have_a_panel_each(ringed: Run) -> None:
    above, below = eccentricity_figure([ringed]).axes
    assert (above.get_title("left"), below.get_title("left")) == ("inner film", "outer film")
    assert np.max(below.get_lines()[0].get_ydata()) == np.max(ringed["eccentricity_outer"])


def test_the_way_up_and_the_way_down_are_two_curves_over_speed(ringed: Run) -> None:
    figure = eccentricity_figure([ringed], over="speed")
    up, down = figure.axes[0].get_lines()
    assert [line.get_label() for line in (up, down)] == ["run-up", "run-down"]
    assert (np.diff(up.get_xdata()) > 0).all()
    assert (np.diff(down.get_xdata()) < 0).all()
    assert "rotor speed in Hz" in texts(figure)
    with pytest.raises(RunFileError, match="constant speed"):
        eccentricity_figure([ringed], 1.2, 1.8, over="speed")


def test_ring_speed_is_drawn_over_the_torque_balance(ringed: Run) -> None:
    axes = ring_speed_figure([ringed]).axes[0]
    curve, concentric = axes.get_lines()
    assert np.nanmax(curve.get_ydata()) == pytest.approx(0.25)
    inner, outer = 12.0 * 12.5**3 * 20 / 40, 14.0 * 20.0**3 * 16 / 50
    assert np.unique(concentric.get_ydata()) == pytest.approx([inner / (inner + outer)])


def test_the_waterfall_of_a_rotor_that_turns_the_other_way_round_is_the_same(ringed: Run) -> None:
    other = as_run({name: -ringed[name] if name.endswith("_Hz") else ringed[name] for name in ringed.signals})
    here, there = (run_spectra(one, "journal", None, "x") for one in (ringed, other))
    assert (here.window_s, here.frequency_Hz[-1]) == (there.window_s, there.frequency_Hz[-1])
    np.testing.assert_array_equal(here.speed_Hz, -there.speed_Hz)


def test_ring_speed_and_oil_content_need_their_signals(run: Run, ringed: Run) -> None:
    with pytest.raises(RunFileError, match="no ring that turns"):
        ring_speed_figure([run])
    with pytest.raises(RunFileError, match="no oil fraction"):
        quantity_figure([run], "oil-content")
    (curve,) = quantity_figure([ringed], "oil-content").axes[0].get_lines()
    assert np.min(curve.get_ydata()) == np.min(ringed["oil_fraction_inner"])


def test_levels_of_a_ring_bearing_refer_to_both_clearances(ringed: Run, run: Run) -> None:
    assert "C$_i$ + C$_o$" in texts(waterfall_figure(ringed, signal="disk"))
    assert "C$_i$" not in texts(waterfall_figure(run))
    assert clearance(ringed) == pytest.approx(9e-5)


def test_orbit_lies_in_its_clearance_circle(run: Run) -> None:
    axes = orbit_figure([run], 8.0, 8.05).axes[0]
    orbit = axes.get_lines()[0]
    radius = np.hypot(orbit.get_xdata(), orbit.get_ydata())
    (circle,) = axes.patches
    assert circle.get_radius() == pytest.approx(CLEARANCE * 1e6)  # type: ignore[attr-defined]
    assert len(radius) == 1001
    np.testing.assert_allclose(radius / 35.0, run["eccentricity"][160_000:161_001])
    assert axes.get_aspect() == 1.0


@pytest.mark.parametrize("figure", [orbit_figure, eccentricity_figure])
def test_times_outside_the_run_are_refused(run: Run, figure: object) -> None:
    with pytest.raises(RunFileError, match="goes from 0 s to 10 s"):
        figure([run], 20.0, 21.0)  # type: ignore[operator]


def test_displacement_is_in_micrometres(run: Run) -> None:
    x, y = displacement_figure([run], from_time=8.0).axes
    for axes, name in ((x, "disk_x_m"), (y, "disk_y_m")):
        assert np.max(axes.get_lines()[0].get_ydata()) == pytest.approx(np.max(run[name][160_000:]) * 1e6)
        assert np.min(axes.get_lines()[0].get_xdata()) >= 8.0


def test_summary_marks_the_events_found(run: Run) -> None:
    written = texts(summary_figure(run))
    for text in ("critical speed\n145.4 Hz", "onset of whirl\n193.6 Hz, 0.47X", "eccentricity", "speed in Hz"):
        assert text in written
    contact = {"kind": "contact", "film": None, "t_s": 2.0, "speed_Hz": 60.0, "frequency_ratio": None}
    told = texts(summary_figure(replace(run, events=[contact], status="contact")))
    assert "contact\n60.0 Hz" in told
    assert "onset" not in told
    assert "contact at 10 s" in told


@pytest.mark.parametrize("samples", [2, 40, 70, 2000])
def test_a_run_that_ends_soon_has_a_summary_too(run: Run, samples: int) -> None:
    short = as_run({name: run[name][:samples] for name in run.signals}, status="contact")
    save = summary_figure(short)
    save.draw_without_rendering()
    assert len(save.axes) == (3 if samples < 64 else 4)


def test_a_run_without_samples_is_refused(run: Run) -> None:
    empty = as_run({name: run[name][:0] for name in run.signals})
    with pytest.raises(RunFileError, match="no samples"):
        summary_figure(empty)


def test_a_run_without_clearance_has_no_waterfall(run: Run) -> None:
    with pytest.raises(RunFileError, match="clearance"):
        waterfall_figure(replace(run, references={}))
    assert clearance(replace(run, references={"clearance_m": 1e-5, "clearance_m_left": 2e-5}), "left") == 2e-5


def test_thinned_curves_keep_their_extremes() -> None:
    time_s = np.linspace(0.0, 1.0, 200_001)
    values = np.sin(400 * time_s)
    values[123_456] = 5.0
    line = Envelope(len(time_s))
    for first, last in ((0, 1), (1, 70_000), (70_000, len(time_s))):
        line.add(time_s[first:last], values[first:last])
    few, kept = line.points()
    assert len(few) < 1.1 * DRAWN_POINTS
    assert (np.diff(few) > 0.0).all()
    assert (kept.max(), kept.min()) == (5.0, values.min())
    assert few[-1] == 1.0


def test_fonts_of_a_pdf_are_those_that_journals_take(tmp_path: Path) -> None:
    figure = new_figure("title", "")
    content = save_figure(figure, tmp_path / "a.pdf").read_bytes()
    assert b"/Type3" not in content
    assert b"/TrueType" in content or b"/CIDFontType2" in content


@pytest.mark.parametrize(("suffix", "magic"), [(".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml")])
def test_pictures_are_written_as_their_name_says_and_alike_each_time(run: Run, tmp_path: Path, suffix: str,
                                                                     magic: bytes) -> None:  # fmt: skip
    first = save_figure(eccentricity_figure([run]), tmp_path / f"a{suffix}").read_bytes()
    assert first.startswith(magic)
    assert first == save_figure(eccentricity_figure([run]), tmp_path / f"b{suffix}").read_bytes()


@pytest.mark.parametrize("name", ["picture.gif", "picture", "nowhere/picture.png"])
def test_pictures_that_cannot_be_written_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError):
        save_figure(Figure(), tmp_path / name)


def test_a_png_is_the_one_that_matplotlib_saves(run: Run) -> None:
    """It is laid out once for its resolution; a second one is as if matplotlib had saved the first, too."""
    figure, theirs = summary_figure(run), summary_figure(run)
    for _ in range(2):
        saved = io.BytesIO()
        with styled():
            theirs.savefig(saved, dpi=72, metadata={"Software": MARK})
        assert picture(figure, ".png", 72) == saved.getvalue()
    assert figure.dpi == theirs.dpi


@pytest.mark.parametrize("window_s", [0.0, 1e-320])
def test_a_window_without_samples_is_refused(run: Run, window_s: float) -> None:
    with pytest.raises(InputError, match="does not fit the run"):
        run_spectra(run, "journal", window_s, "x")


def test_drawing_leaves_matplotlib_as_it_was(run: Run) -> None:
    before = dict(mpl.rcParams)
    summary_figure(run)
    assert dict(mpl.rcParams) == before


def test_drawing_does_not_import_pyplot() -> None:
    code = "import sys, frbcli.plot.summary, frbcli.plot.motion; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False).returncode == 0


@pytest.mark.parametrize(
    "text", ["not toml [", "a = " + "[" * 1000 + "]" * 1000, "a = 1" + "0" * 5000, "a." * 300 + "b = 1"]
)
def test_a_case_that_cannot_be_read_is_the_fault_of_its_run(run: Run, text: str) -> None:
    with pytest.raises(RunFileError, match="no readable case"):
        model(replace(run, case_text=text))


@pytest.mark.filterwarnings("ignore:Glyph")
def test_letters_of_a_title_are_neither_mathematics_nor_orders_to_a_terminal(run: Run, tmp_path: Path) -> None:
    figure = eccentricity_figure([replace(run, title="costs 5 $, \\foo 7 $ \x1b[31m 漢")])
    save_figure(figure, tmp_path / "a.svg")
    assert "costs 5 $, \\foo 7 $ ?[31m 漢" in (tmp_path / "a.svg").read_text()


def test_a_curve_is_the_same_however_it_is_read(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = curve(run, run.signal("eccentricity"), 100, 150_001)
    between = at_times(run, run.signal("speed_Hz"), np.linspace(0.0, 10.0, 333))
    monkeypatch.setattr("frbcli.plot.signals.pieces", lambda first, last: pieces(first, last, 777))
    for all_at_once, in_pieces in zip(whole, curve(run, run.signal("eccentricity"), 100, 150_001), strict=True):
        np.testing.assert_array_equal(all_at_once, in_pieces)
    np.testing.assert_array_equal(between, at_times(run, run.signal("speed_Hz"), np.linspace(0.0, 10.0, 333)))


def test_curves_over_speed_are_the_same_however_they_are_read(ringed: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def drawn() -> list[np.ndarray]:
        return [line.get_xydata() for axes in eccentricity_figure([ringed], over="speed").axes for line in axes.lines]

    whole = drawn()
    monkeypatch.setattr("frbcli.plot.curves.pieces", lambda first, last: pieces(first, last, 777))
    for all_at_once, in_pieces in zip(whole, drawn(), strict=True):
        np.testing.assert_array_equal(all_at_once, in_pieces)


def test_a_long_orbit_shows_all_that_can_be_seen(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    x, y = run.signal("journal_x_m"), run.signal("journal_y_m")
    monkeypatch.setattr("frbcli.plot.motion.ALL_DRAWN", 1000)
    begins, ends, gaps = np.stack(visible_steps(x, y, 0, len(run))).reshape(2, -1, 3).T
    assert np.isnan(gaps).all()
    assert len(begins) < 0.1 * len(run)
    lines = np.concatenate([begins + share * (ends - begins) for share in np.linspace(0.0, 1.0, 9)])
    cell = 2.0 * float(np.hypot(x.values, y.values).max()) / 600
    orbit = set(map(tuple, np.round(np.stack([x.values, y.values], axis=1) / cell).astype(int)))
    kept = set(map(tuple, np.round(lines / cell).astype(int)))
    reached = {(i + k, j + m) for i, j in kept for k in (-1, 0, 1) for m in (-1, 0, 1)}
    assert orbit <= reached


PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def case() -> frbcli.Case:
    return frbcli.load_case("jeffcott", ["film.theory=short", "speed.duration=0.3 s"])


def test_text_of_everything_is_a_few_lines(case: frbcli.Case, tmp_path: Path) -> None:
    run = frbcli.runup(case, tmp_path / "run.h5")
    found = frbcli.stability(case)
    plan = frbcli.make_plan(case)
    begins = {"Case jeffcott: ": case, "Plan\n": plan, "Run ": run, "Stability of jeffcott: ": found}
    for words, thing in begins.items():
        text = repr(thing)
        assert text.startswith(words)
        assert len(text.splitlines()) <= 20
        assert max(map(len, text.splitlines())) < 300
    assert "finished at 0.3 s" in repr(run)
    assert picture_of(found)._repr_png_().startswith(PNG)  # type: ignore[attr-defined]
    assert frbcli.picture(run).axes


def test_what_has_no_picture_says_what_has(case: frbcli.Case) -> None:
    with pytest.raises(frbcli.InputError, match=r"Case: has no picture. There are pictures of: AccuracyLadder"):
        picture_of(case)
    assert len(PICTURES) == 17


@pytest.mark.parametrize("kind", PICTURES)
def test_a_picture_is_of_the_result_that_its_function_takes(kind: str) -> None:
    module, _, name = PICTURES[kind].partition(":")
    draw = getattr(import_module(f"frbcli.plot.{module}"), name)
    taken = next(iter(inspect.signature(draw).parameters.values())).annotation
    assert taken == kind


def test_types_are_told() -> None:
    assert files("frbcli").joinpath("py.typed").is_file()


@pytest.mark.parametrize("per_sample", [0.05, 0.2, 0.35, 0.42])  # revolutions; half of one has no other shape
def test_a_motion_is_drawn_smoothly_between_its_samples(per_sample: float) -> None:
    """Samples as they are, and a motion on a slope between them within half a percent."""

    def moved(places: Array) -> Array:
        return np.asarray(3.0 + 0.01 * places + np.sin(2.0 * np.pi * per_sample * places + 0.3))

    signal = moved(np.arange(400.0))
    fine = between(signal, 100, 300, 8)
    np.testing.assert_allclose(fine[::8], signal[100:300], rtol=1e-13)
    np.testing.assert_allclose(fine, moved(np.arange(100.0, 299.01, 0.125)), atol=6e-3)
