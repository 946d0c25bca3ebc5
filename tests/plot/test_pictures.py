"""Labels and legends of pictures: none covers another, and each is in words."""

import itertools
from dataclasses import replace

import numpy as np
import picture_texts
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from synthetic_run import make_run

from frbcli.analysis.subsynchronous import with_whirl_names
from frbcli.case.reading.load import load_case
from frbcli.columns import table_of
from frbcli.linear.sheets.thrust import thrust_sheet
from frbcli.plot import style
from frbcli.plot.machine.bearing import thrust_figure
from frbcli.plot.style import (
    legend_below,
    name_of_key,
    new_figure,
    plain,
    styled,
    with_subscripts,
)
from frbcli.plot.summary import summary_figure
from frbcli.results.columns import EVENTS


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
