"""One style for all pictures, and how they are saved.

Figures are made without pyplot: nothing is kept in global state, and no window system is asked for.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from frbcli.errors import InputError, input_error, printable
from frbcli.results.write import MARK, PICTURES, require_places, write

# Okabe and Ito: distinguishable also for the colour-blind
BLUE, ORANGE, GREEN, VERMILION = "#0072B2", "#E69F00", "#009E73", "#D55E00"
SKY, PURPLE, BLACK, GREY = "#56B4E9", "#CC79A7", "#000000", "#707070"
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK)
LEVEL_MAP = "viridis"  # rises evenly in lightness, so that it survives a grey print

Picture = Figure  # the name outside matplotlib

FORMATS = {
    ".png": {"Software": MARK},
    ".pdf": {"Creator": MARK, "CreationDate": None},
    ".svg": {"Creator": MARK, "Date": None},
}  # no dates, so that the same run gives the same file

SYMBOL = re.compile(r"(?<!\w)([^\W\d_])_([^\W_]{1,2})(?!\w)")  # with its index
LETTERS_PER_INCH, FEWEST_LETTERS = 12.5, 20  # of a title
LEGEND_ROW, FEW_COLUMNS = 0.2, 3  # inches; columns of a legend, of more the letters are smaller
LABEL_ROWS, LABEL_HEIGHT_pt, LABEL_GAP_pt = 3, 24, 6  # of labels above a panel
POINTS = 72.0  # of an inch
BAND = 0.25  # opacity of a band of uncertainty
MOST_MARKED = 50  # events in a picture, the first ones
MOST_NAMED = 40  # curves in a legend
LEGEND_ROW_pt, MOST_OF_PANEL = 12.0, 1.6  # of a legend next to a panel: a row, and its height over the panel's

STYLE: Any = {
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#D8D8D8",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.prop_cycle": cycler(color=COLOURS),
    "lines.linewidth": 1.0,
    "legend.frameon": False,
    "figure.constrained_layout.use": True,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,  # TrueType: journals refuse Type 3
    "svg.hashsalt": "frb",
    "text.usetex": False,  # texts are written for matplotlib itself
}


class NotebookFigure(Figure):
    """A figure that a notebook shows where a cell ends with it, also if pyplot has never been imported."""

    def _repr_png_(self) -> bytes:
        return picture(self, ".png", dpi=100)


@contextmanager
def styled() -> Iterator[None]:
    """Within it, matplotlib draws in the style of frb; afterwards as before."""
    with mpl.rc_context(STYLE):
        yield


def new_figure(title: str, subtitle: str, width: float = 7.2, height: float = 4.4) -> Figure:
    """An empty figure, width and height in inches, under the title of the case and what was computed."""
    figure = NotebookFigure(figsize=(width, height))
    set_title(figure, title, subtitle)
    return figure


def set_title(figure: Figure, title: str, subtitle: str) -> None:
    """Title and subtitle of a figure, above its panels."""
    words = with_subscripts(plain(title))
    figure.suptitle(f"{words}\n{plain(subtitle)}" if subtitle else words, x=0.01, ha="left", fontsize=10.0)
    wrap_title(figure)


def wrap_title(figure: Figure) -> None:
    """Break the lines of the title that are longer than the picture is wide."""
    width = max(FEWEST_LETTERS, int(LETTERS_PER_INCH * figure.get_figwidth()))
    lines = (fill(line, width, break_long_words=False) for line in figure.get_suptitle().split("\n"))
    figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=10.0)


def plain(text: str) -> str:
    """`text` as it is, without mathematics between dollars and without control characters."""
    return printable(text).replace("$", r"\$")


def with_subscripts(text: str) -> str:
    """`text`, see `plain`, in which the index of a symbol of one letter is a subscript: C_o, ω_F."""
    return SYMBOL.sub(r"\1$_{\2}$", text)


DIRECTION = re.compile(r"\b(force|stiffness|damping|spring|misalignment)\.([01])$")  # one of a pair of values, x, y


def name_of_key(key: str, unit: str = "") -> str:
    """A key of the case file in words, for an axis, with its unit: oil viscosity in mPa s, force 0 force x in N."""
    key = DIRECTION.sub(lambda match: f"{match[1]}.{'xy'[int(match[2])]}", key)
    words = " ".join(word for word in re.split(r"[._]", key) if word)
    return plain(f"{words} in {in_words(unit)}" if unit else words)


def in_words(quantity: str) -> str:
    """A quantity or unit of a case file as a picture shows it: 35 um and mPa*s become 35 µm and mPa s."""
    return re.sub(r"\bu(?=m\b)", "µ", quantity.replace("*", " ").replace("degC", "°C"))


def plain_numbers(axis: Axis) -> None:
    """Numbers on a logarithmic axis as they are, 1, 2, 5, 10, 20, instead of powers of ten with factors."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def mark_times(panels: Sequence[Axes], times_s: Sequence[float], labels: Sequence[str]) -> int:
    """Mark moments by lines through panels that share a time axis, labelled above the first one.

    A label that would run into its neighbour's is raised above it. Where there is no room in any row the line has no
    label; returns the number of these lines.
    """
    for axes in panels:
        on_map = any(isinstance(each, QuadMesh) for each in axes.collections)
        for time in times_s:
            axes.axvline(time, color="white" if on_map else GREY, linewidth=0.9, linestyle=(0, (4, 3)))
    figure = panels[0].get_figure()
    if not times_s or not isinstance(figure, Figure):
        return 0
    width_pt = panel_width_pt(figure)  # of the panel, in which the labels have to fit
    left, right = panels[0].get_xlim()
    free_from, left_out = [-math.inf] * LABEL_ROWS, 0
    for time, label in sorted(zip(times_s, labels, strict=True)):
        at = width_pt * (time - left) / (right - left)
        text = panels[0].annotate(
            label, (time, 1.0), xycoords=panels[0].get_xaxis_transform(), xytext=(0, 4), textcoords="offset points",
            fontsize=8.0, va="bottom", ha="left",
        )  # fmt: skip
        length = text.get_window_extent().width * POINTS / figure.dpi
        start = max(0.0, min(at, width_pt - length))
        row = next((row for row, free in enumerate(free_from) if start >= free), None)
        if row is None:
            text.remove()
            left_out += 1
            continue
        free_from[row] = start + length + LABEL_GAP_pt
        text.set_position((start - at, 4 + LABEL_HEIGHT_pt * row))
    return left_out


def panel_width_pt(figure: Figure) -> float:
    """The width that panels above each other will have: what their ticks, labels and legends leave of the figure's, but
    for ticks that a layout changes. A layout, to find it, would take a tenth of the time of a picture."""
    panels = [axes for axes in figure.axes if axes.get_subplotspec() is not None]
    extents = [(axes.get_window_extent(), axes.get_tightbbox(for_layout_only=True)) for axes in panels]
    left = max(inner.x0 - outer.x0 for inner, outer in extents if outer is not None)
    right = max(outer.x1 - inner.x1 for inner, outer in extents if outer is not None)
    layout = figure.get_layout_engine()
    pad = layout.get()["w_pad"] if isinstance(layout, ConstrainedLayoutEngine) else 0.0
    return float(POINTS * (figure.get_figwidth() - (left + right) / figure.dpi - 2.0 * pad))


def orbit_axes(axes: Axes, reach: float, x: float = 0.0, y: float = 0.0) -> None:
    """Equal axes of an orbit in um, to all sides as far as `reach` from a point."""
    axes.set(xlim=(x - reach, x + reach), ylim=(y - reach, y + reach), aspect="equal")
    axes.set(xlabel="x in µm", ylabel="y in µm")


def draw_bands(axes: Axes, half: float | None) -> None:
    """A band about each curve of a panel: its uncertainty in the unit of the panel, None for none."""
    if half is None or not half > 0.0:
        return
    for line in list(axes.lines):
        place, value = (np.asarray(values, dtype=np.float64) for values in line.get_data())
        axes.fill_between(place, value - half, value + half, color=line.get_color(), alpha=BAND, linewidth=0.0)


def legend_below(figure: Figure, *panels: Axes, columns: int = 3) -> None:
    """A legend of the curves of panels under the picture, where it hides no curve, each name once; none for one curve,
    or for more than there is room for. The picture grows by its rows beyond two."""
    named = {label: handle for axes in panels for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    if 1 < len(named) <= MOST_NAMED:
        columns = min(len(named), columns)
        size = "medium" if columns <= FEW_COLUMNS else "small"
        figure.legend(list(named.values()), list(named), loc="outside lower center", ncols=columns, fontsize=size)
        rows = math.ceil(len(named) / columns)
        figure.set_figheight(figure.get_figheight() + LEGEND_ROW * max(0, rows - 2))


def narrowed(figure: Figure, width: float, columns: int) -> None:
    """Give a picture another width in inches, its panels the shape that they had, and the legend below it so many
    columns."""
    rows = 0
    for legend in list(figure.legends):
        names = [text.get_text() for text in legend.get_texts()]
        rows = math.ceil(len(names) / columns)
        legend.remove()
        curves = [curve for curve in legend.legend_handles if curve is not None]
        figure.legend(curves, names, loc="outside lower center", ncols=columns, fontsize="small", frameon=False)
    across, high = figure.get_size_inches()
    figure.set_size_inches(width, high * width / across + LEGEND_ROW * max(0, rows - 2))


def legend_above(axes: Axes) -> None:
    """A legend above a panel in one row, where it hides no curve and takes no width; none for one curve."""
    count = len(axes.get_legend_handles_labels()[0])
    if count > 1:
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=count, fontsize="small", borderaxespad=0.2)


def legend_beside(axes: Axes) -> None:
    """A legend to the right of a panel, where it hides no curve; none for one curve, or for more than fit there: a
    taller legend would leave the other panels no height."""
    figure = axes.get_figure(root=True)
    height_pt = axes.get_window_extent().height * POINTS / (figure.dpi if figure else POINTS)
    if 1 < len(axes.get_legend_handles_labels()[0]) <= MOST_OF_PANEL * height_pt / LEGEND_ROW_pt:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small")


def check_picture(path: Path, force: bool = False) -> None:
    """Raises InputError if a picture cannot have this name or this place; called before the work. force: also replace
    a file that frb did not write."""
    if path.suffix.lower() not in FORMATS:
        raise refused(path, "is not a picture format of frb.", f"End it with {', '.join(FORMATS)}.")
    require_places([(path, PICTURES[path.suffix.lower()])], force=force)


def save_figure(figure: Figure, path: str | Path, dpi: int = 150, force: bool = False) -> Path:
    """Write a figure as PNG, PDF or SVG, as the suffix of `path` says. Raises InputError if that does not work.

    It is drawn before the file is touched. force: see check_picture.
    """
    path = Path(path)
    check_picture(path, force)
    try:
        content = picture(figure, path.suffix.lower(), dpi)
    except (OSError, ValueError) as error:
        raise refused(path, f"cannot be drawn: {error}.", "") from error
    write(path, PICTURES[path.suffix.lower()], content, force)
    return path


def picture(figure: Figure, suffix: str, dpi: int = 150, own_letters: bool = False) -> bytes:
    """A figure as one of FORMATS. own_letters: of an SVG, as outlines, so that it looks the same everywhere."""
    content = io.BytesIO()
    with styled(), mpl.rc_context({"svg.fonttype": "path"} if own_letters else {}):
        if suffix == ".png":
            _draw_png(figure, dpi, content)
        else:
            figure.savefig(content, dpi=dpi, format=suffix[1:], metadata=FORMATS[suffix])
    return content.getvalue()


def _draw_png(figure: Figure, dpi: float, content: io.BytesIO) -> None:
    """Lay a figure out and draw it, once; matplotlib's `savefig` draws a figure with a layout twice."""
    engine, own_dpi, canvas = figure.get_layout_engine(), figure.dpi, figure.canvas
    figure.dpi = dpi
    try:
        if engine is not None:
            engine.execute(figure)
            figure.set_layout_engine("none")
        agg: Any = FigureCanvasAgg(figure)  # its methods have no types
        agg.print_png(content, metadata=FORMATS[".png"])
    finally:
        if engine is not None:
            figure.set_layout_engine(engine)
        figure.set_canvas(canvas)
        figure.dpi = own_dpi


def refused(path: Path, problem: str, remedy: str) -> InputError:
    """Why a picture cannot be written."""
    return input_error(f"picture {path}", "output", "", problem, remedy)
