"""How pictures look by options, pictures on axes of one's own, and what a notebook shows. Labels and legends of
pictures: none covers another, and each is in words."""

import itertools
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
import picture_texts
import pytest
from click.testing import CliRunner
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image
from synthetic_run import Rotor, make_run

import frbcli
from frbcli.analysis.subsynchronous import with_whirl_names
from frbcli.case.reading.load import load_case
from frbcli.cli.main import frb
from frbcli.cli.options import Size
from frbcli.columns import table_of
from frbcli.linear.sheets.thrust import thrust_sheet
from frbcli.plot import style
from frbcli.plot.machine.bearing import thrust_figure
from frbcli.plot.machine.modes import campbell_figure
from frbcli.plot.motion import eccentricity_figure
from frbcli.plot.picture import fit
from frbcli.plot.style import (
    COLOURS,
    legend_below,
    name_of_key,
    new_figure,
    plain,
    styled,
    with_subscripts,
)
from frbcli.plot.summary import summary_figure
from frbcli.plot.waterfall import LevelScale, waterfall_figure
from frbcli.results.columns import EVENTS
from frbcli.results.store import Run


@pytest.fixture(scope="module")
def run() -> Run:
    return make_run(Rotor(duration_s=2.0, whirl_s=1.0))


@pytest.mark.parametrize(
    ("text", "mm"), [("160 mm x 90 mm", (160, 90)), ("160x90 mm", (160, 90)), ("16 cm x 0.09 m", (160, 90))]
)
def test_sizes_have_units(text: str, mm: tuple[float, float]) -> None:
    np.testing.assert_allclose(Size().convert(text, None, None), np.array(mm) / 25.4)


@pytest.mark.parametrize("text", ["160", "160 x 90 kg", "1 mm x 1 mm", "x", "160 mm x 90 mm x 3 mm"])
def test_other_sizes_are_refused(text: str) -> None:
    with pytest.raises(click.BadParameter):
        Size().convert(text, None, None)


def test_a_picture_has_its_size_and_resolution(tmp_path: Path) -> None:
    case = "jeffcott"
    words = ["stability", case, "--set", "film.theory=short", "-o", str(tmp_path / "c.png"), "--size", "100x80 mm"]
    done = CliRunner().invoke(frb, [*words, "--dpi", "254", "--speed", "50 Hz"], standalone_mode=False)
    assert done.exception is None
    with Image.open(tmp_path / "c.png") as image:
        assert image.size == (1000, 800)
    picture_texts.seen.clear()  # so small a picture has no room for its legend


def test_speeds_are_told_per_minute(run: Run) -> None:
    figure = fit(eccentricity_figure([run], over="speed"), x_limits=(6000.0, 12000.0), rpm=True)
    (axes,) = figure.axes
    assert axes.get_xlabel() == "rotor speed in rpm"
    assert axes.get_xlim() == (100.0, 200.0)  # of the data, which stay in Hz
    figure.canvas.draw()
    told = [float(label.get_text()) for label in axes.get_xticklabels()]
    places = axes.get_xticks()
    np.testing.assert_allclose(told, 60.0 * places)
    assert all(number % 500.0 == 0.0 for number in told)


def test_all_panels_of_a_picture_follow() -> None:
    found = frbcli.stability(frbcli.load_case("jeffcott", ["film.theory=short"]), [50.0, 150.0])
    figure = fit(campbell_figure(found), rpm=True, x_limits=(0.0, 6000.0), y_limits=(0.0, 100.0))
    assert [axes.get_xlim() for axes in figure.axes] == [(0.0, 100.0)] * 2
    assert figure.axes[0].get_ylim() == (0.0, 100.0)
    assert figure.axes[1].get_ylim() != (0.0, 100.0)  # another quantity


def test_bars_of_a_campbell_diagram_are_the_errors_of_its_eigenvalues() -> None:
    """A bar for each dot, and none where the coefficients are given and their errors are not known."""
    case = frbcli.load_case("jeffcott", ["film.theory=short", "speed.from=150 Hz", "speed.to=200 Hz"])
    found = frbcli.stability(case, [150.0], threshold=True)
    above, below = campbell_figure(found).axes
    told = [(point.speed_Hz, mode.error / (2.0 * np.pi)) for point in found.sweep for mode in point.modes_with_errors]
    assert found.threshold is not None
    np.testing.assert_allclose(sorted(bars_of(above)), sorted(told), rtol=1e-9)
    for axes in (above, below):
        (span,) = axes.patches
        assert span.get_width() == pytest.approx(2.0 * found.threshold.speed_uncertainty_Hz)
    band = below.collections[-1].get_paths()[0].vertices
    assert np.ptp(band[band[:, 0] == 200.0, 1]) == pytest.approx(2.0 * found.sweep[-1].critical_error)
    assert bars_of(campbell_figure(frbcli.stability(frbcli.load_case("seal"), [50.0])).axes[0]) == []


def test_growth_has_a_gap_where_no_position_of_rest_was_found() -> None:
    """And the edge of the diagram does not cut the dots at its last speed."""
    found = frbcli.stability(frbcli.load_case("jeffcott", ["film.theory=short"]))
    lost = replace(found.sweep[5], films=(), eigenvalues=np.zeros(0, dtype=complex), problem="not found")
    above, below = campbell_figure(replace(found, sweep=(*found.sweep[:5], lost, *found.sweep[6:]))).axes
    assert np.flatnonzero(np.isnan(below.lines[0].get_ydata())).tolist() == [5]
    assert above.get_xlim()[1] > found.sweep[-1].speed_Hz


def bars_of(axes: Axes) -> list[tuple[float, float]]:
    """Place and half length of each vertical bar."""
    lines = [collection for collection in axes.collections if isinstance(collection, LineCollection)]
    return [(bar[0, 0], 0.5 * (bar[1, 1] - bar[0, 1])) for each in lines for bar in each.get_segments()]


def test_linear_amplitudes_are_in_micrometres(run: Run) -> None:
    figure = waterfall_figure(run, scale=LevelScale(linear=True))
    mesh = figure.axes[0].collections[0]
    found = frbcli.waterfall(
        run["time_s"], run["journal_x_m"], run["journal_y_m"], run["speed_Hz"], 35e-6, max_frequency_Hz=360.0
    )
    assert mesh.get_array().max() == pytest.approx(1e6 * found.amplitude.max(), rel=1e-6)
    assert figure.axes[-1].get_ylabel() == "amplitude in µm"
    ranged = waterfall_figure(run, scale=LevelScale(limits=(-80.0, -20.0)))
    assert ranged.axes[0].collections[0].get_clim() == (-80.0, -20.0)


def test_chosen_orders_are_drawn(run: Run) -> None:
    axes = waterfall_figure(run, scale=LevelScale(orders=(1.0, 0.25))).axes[0]
    assert [text.get_text() for text in axes.texts] == ["1X", "0.25X"]
    first, second = (np.asarray(line.get_ydata()) for line in axes.get_lines())
    np.testing.assert_allclose(second, 0.25 * first)


def linear() -> tuple[object, object, object]:
    case = frbcli.load_case("jeffcott", ["film.theory=short"])
    return (
        frbcli.stability(case, [50.0, 100.0]), frbcli.response(case, [50.0, 100.0]), frbcli.bearing_sheet(case, [50.0]),
    )  # fmt: skip


@pytest.mark.parametrize(
    "draw",
    [
        frbcli.draw_eccentricity,
        frbcli.draw_orbit,
        frbcli.draw_waterfall,
        lambda run, ax=None: frbcli.draw_spectrum(run, 1.5, ax),
    ],
    ids=["eccentricity", "orbit", "waterfall", "spectrum"],
)
def test_runs_are_drawn_on_axes_of_ones_own(run: Run, draw: Callable[..., Axes]) -> None:
    _, axes = Figure().subplots(1, 2)
    assert draw(run, ax=axes) is axes
    assert axes.has_data()
    assert axes.get_xlabel()
    assert axes.get_ylabel()
    alone = draw(run)
    assert alone is not axes
    assert alone.has_data()


def test_results_are_drawn_on_axes_of_ones_own() -> None:
    stability, response, sheet = linear()
    for draw, found in (
        (frbcli.draw_campbell, stability), (frbcli.draw_response, response), (frbcli.draw_bearing, sheet),
    ):  # fmt: skip
        axes = Figure().subplots()
        assert draw(found, ax=axes) is axes
        assert axes.has_data()
        assert axes.get_xlabel()
        assert axes.get_ylabel()


def test_results_over_each_other_have_other_colours_and_names(run: Run) -> None:
    other = replace(run, case_name="other")
    axes = Figure().subplots()
    frbcli.draw_eccentricity(run, ax=axes, label="up")
    frbcli.draw_eccentricity(other, ax=axes, label="down")
    assert [line.get_label() for line in axes.lines] == ["up", "down"]
    assert [line.get_color() for line in axes.lines] == [COLOURS[0], COLOURS[1].lower()]
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["up", "down"]
    orbits = Figure().subplots()
    for each, name in ((run, "a"), (other, "b")):
        frbcli.draw_orbit(each, ax=orbits, label=name)
    curves = {line.get_label(): line.get_color() for line in orbits.lines if not line.get_label().startswith("_")}
    assert curves == {"a": COLOURS[0], "b": COLOURS[1].lower()}


def test_several_results_have_one_picture(run: Run) -> None:
    stability, response, sheet = linear()
    for pair in ([run, replace(run, case_name="other")], [stability] * 2, [response] * 2, [sheet] * 2):
        (axes,) = frbcli.picture(pair).axes
        names = [text.get_text() for text in axes.get_legend().get_texts()]
        assert len(names) == len(set(names)) >= 2
    for wrong in ([], [run, stability], [frbcli.load_case("jeffcott")]):
        with pytest.raises(frbcli.InputError):
            frbcli.picture(wrong)


def test_a_notebook_shows_what_there_is(run: Run) -> None:
    case = frbcli.load_case("jeffcott", ["film.theory=short", 'title="a < b & c"'])
    stability, response, sheet = linear()
    for thing, word in (
        (case, "shaft_stiffness"), (frbcli.make_plan(case), "integrator"), (run, "finished"),
        (stability, "Stability"), (response, "Response"), (sheet, "BearingSheet"),
    ):  # fmt: skip
        text = thing._repr_html_()  # type: ignore[attr-defined]
        assert word in text
        assert text.count("<tr>") == text.count("</tr>") > 0 or thing is run
        assert not re.search(r"<(?!/?(p|b|table|thead|tbody|tr|th|td)\b)", text)
    assert "a &lt; b &amp; c" in case._repr_html_()


def overlapping(texts: list[Text], figure: Figure) -> list[tuple[str, str]]:
    """Pairs of texts of a drawn figure that cover each other, by their boxes."""
    figure.draw_without_rendering()
    boxes = [(text.get_text(), text.get_window_extent()) for text in texts if text.get_text()]
    return [(a, b) for (a, one), (b, other) in itertools.combinations(boxes, 2) if one.overlaps(other)]


@pytest.mark.parametrize(
    ("texts", "fault"),
    [
        (((0.5, 0.5, "one"), (0.5, 0.52, "two")), "'one' and 'two' cover each other"),
        (((0.98, 0.5, "too long"),), "'too long' reaches out of the figure"),
        (((0.1, 0.5, "one"), (0.1, 0.7, "two")), ""),
    ],
)
def test_a_text_that_covers_another_or_reaches_out_is_seen(
    texts: tuple[tuple[float, float, str], ...], fault: str
) -> None:
    """Of the watch that looks at the pictures of all tests; after this one it is told to forget."""
    for suffix in (".png", ".svg"):
        figure = new_figure("", "")
        for x, y, words in texts:
            figure.text(x, y, words)
        style.picture(figure, suffix)
        assert picture_texts.seen == ([f"without title: {fault}"] if fault else [])
        picture_texts.seen.clear()


@pytest.mark.parametrize(
    ("title", "shown"),
    [
        ("Floating ring, C_o = 90 um", "Floating ring, C$_{o}$ = 90 um"),
        ("ω_F and my_file, a_b_c", "ω$_{F}$ and my_file, a_b_c"),
        ("5 $ for C_i", r"5 \$ for C$_{i}$"),
    ],
)
def test_indices_of_symbols_are_subscripts(title: str, shown: str) -> None:
    assert with_subscripts(plain(title)) == shown


@pytest.mark.parametrize(
    ("key", "unit", "words"),
    [("oil.viscosity", "mPa*s", "oil viscosity in mPa s"), ("bearing.0.inner.clearance", "um",
      "bearing 0 inner clearance in µm"), ("disk.mass", "", "disk mass"),
     ("force.0.force.1", "N", "force 0 force y in N")],
)  # fmt: skip
def test_axes_name_keys_in_words(key: str, unit: str, words: str) -> None:
    assert name_of_key(key, unit) == words


def test_a_legend_below_covers_no_panel_and_stays_in_the_picture() -> None:
    with styled():
        figure = new_figure("Title", "of a picture with many curves")
        above, below = figure.subplots(2, 1)
        for number in range(9):
            above.plot([0, 1], [0, number], label=f"run-down, {100 + number} Hz/s")
        below.plot([0, 1], [1, 0], label="(ω$_R$ + ω$_F$)/2")
        below.plot([0, 1], [1, 0], label="run-down, 100 Hz/s")
        below.set_xlabel("rotor speed in Hz")
        legend_below(figure, above, below, columns=4)
        figure.draw_without_rendering()
        (legend,) = figure.legends
        assert len(legend.get_texts()) == 10  # one of two curves of one name
        box = legend.get_window_extent()
        assert not box.overlaps(below.get_tightbbox())
        assert figure.bbox.x0 <= box.x0
        assert box.x1 <= figure.bbox.x1
        assert not overlapping(legend.get_texts(), figure)


def onset(film: str, t_s: float) -> dict[str, object]:
    return {"kind": "onset", "film": film, "t_s": t_s, "speed_Hz": 30.0 * t_s, "frequency_Hz": 9.0 * t_s,
            "frequency_ratio": 0.3}  # fmt: skip


def test_names_of_whirls_are_one_in_table_and_picture_and_count_as_they_begin() -> None:
    """An outer film that whirls before the second whirl of an inner one has number 2."""
    films = ("rear_inner", "front_inner", "front_outer", "rear_outer", "front_inner")
    events = [onset(film, 1.0 + 1.5 * number) for number, film in enumerate(films)]
    cells = [row[0] for row in table_of(EVENTS, with_whirl_names(events)).cells()]
    assert cells == ["onset Sub 1 rear inner", "onset Sub 1 front inner", "onset Sub 2 front outer",
                     "onset Sub 2 rear outer", "onset Sub 3 front inner"]  # fmt: skip
    figure = summary_figure(replace(make_run(), events=events))
    written = [text.get_text().split("\n")[0] for text in figure.axes[0].texts]
    assert written == ["Sub 1 rear inner", "Sub 2 front outer", "Sub 3 front inner"]


@pytest.mark.parametrize("times", [np.linspace(5.0, 6.0, 6), [9.7, 9.8, 9.9, 9.95], np.linspace(0.0, 10.0, 40)])
def test_labels_of_events_cover_neither_each_other_nor_the_rim(times: list[float]) -> None:
    events = [onset("", t) | {"kind": "critical-speed"} for t in times]
    figure = summary_figure(replace(make_run(), events=events))
    labels = figure.axes[0].texts
    assert len(labels) >= 3
    assert not overlapping(list(labels), figure)
    assert all(figure.bbox.x0 <= text.get_window_extent().x0 for text in labels)
    assert all(text.get_window_extent().x1 <= figure.bbox.x1 for text in labels)
    lines = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
    assert len(lines) == len(times)
    told = str(figure.get_suptitle())
    assert ("have no room" in told) == (len(labels) < len(times))


@pytest.mark.parametrize(
    ("gaps", "speeds", "along", "words"),
    [
        ([12e-6], [900.0], [], "load"),
        ([12e-6, 20e-6], [900.0], ["gap in µm"] * 2, "thrust bearing"),
    ],
)
def test_curves_of_a_thrust_bearing_have_more_than_a_point(
    gaps: list[float], speeds: list[float], along: list[str], words: str
) -> None:
    """A single state is the pressure on the pads and its load in the title."""
    figure = thrust_figure(thrust_sheet(load_case("thrust"), gaps, speeds))
    *panels, pads, _ = figure.axes
    assert [panel.get_xlabel() for panel in panels] == along
    assert all(len(line.get_xdata()) > 1 for panel in panels for line in panel.lines)
    assert pads.get_xlabel() == "mm"
    assert words in figure.get_suptitle()
