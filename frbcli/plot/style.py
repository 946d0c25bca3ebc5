"""One style for all pictures, and how they are saved.

Figures are made without pyplot: nothing is kept in global state, and no window system is asked for.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.errors import Fault, InputError, printable
from frbcli.results.files.kinds import PICTURES
from frbcli.results.files.place import require_places
from frbcli.results.files.write import write

# Okabe and Ito: distinguishable also for the colour-blind
BLUE, ORANGE, GREEN, VERMILION = "#0072B2", "#E69F00", "#009E73", "#D55E00"
SKY, PURPLE, BLACK, GREY = "#56B4E9", "#CC79A7", "#000000", "#707070"
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK)
LEVEL_MAP = "viridis"  # rises evenly in lightness, so that it survives a grey print

Picture = Figure  # the name outside matplotlib

FORMATS = {
    ".png": {},
    ".pdf": {"CreationDate": None},
    ".svg": {"Date": None},
}  # no dates, so that the same run gives the same file

LABEL_WIDTH = 0.19  # of a label above a panel, relative to the panel
LABEL_ROWS = 3
MOST_MARKED = 50  # events in a picture, the first ones
MOST_NAMED = 40  # curves in a legend

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
    words = printable(f"{title}\n{subtitle}" if subtitle else title)
    figure.suptitle(words, x=0.01, ha="left", fontsize=10.0, parse_math=False)  # a $ in a title is one
    return figure


def plain(text: str) -> str:
    """`text` as it is, without mathematics between dollars and without control characters."""
    return printable(text).replace("$", r"\$")


def mark_times(panels: Sequence[Axes], times_s: Sequence[float], labels: Sequence[str]) -> None:
    """Mark moments by lines through panels that share a time axis, labelled above the first one.

    A label that would run into its neighbour's is raised above it.
    """
    left, right = panels[0].get_xlim()
    free_from = [left] * LABEL_ROWS
    for time, label in zip(times_s, labels, strict=True):
        width = LABEL_WIDTH * (right - left)
        start = min(time, right - width)
        row = next((row for row, free in enumerate(free_from) if start >= free), LABEL_ROWS - 1)
        free_from[row] = start + width
        for axes in panels:
            axes.axvline(time, color=GREY, linewidth=0.9, linestyle=(0, (4, 3)))
        panels[0].annotate(
            label,
            (time, 1.0),
            xycoords=panels[0].get_xaxis_transform(),
            xytext=(0, 4 + 24 * row),
            textcoords="offset points",
            ha="left" if start == time else "right",
            va="bottom",
            fontsize=8.0,
        )


def legend_below(figure: Figure, axes: Axes) -> None:
    """A legend under the picture, where it hides no curve; none for one curve, or for more than there is room for."""
    handles, labels = axes.get_legend_handles_labels()
    if 1 < len(handles) <= MOST_NAMED:
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(handles), 3))


def legend_beside(axes: Axes) -> None:
    """A legend to the right of a panel, where it hides no curve; none for one curve, or for more than there is room
    for."""
    if 1 < len(axes.get_legend_handles_labels()[0]) <= MOST_NAMED:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small")


def check_picture(path: Path) -> None:
    """Raises InputError if a picture cannot have this name or this place; called before the work."""
    if path.suffix.lower() not in FORMATS:
        raise _refuse(path, "is not a picture format of frb.", f"End it with {', '.join(FORMATS)}.")
    require_places([(path, PICTURES[path.suffix.lower()])])


def save_figure(figure: Figure, path: str | Path, dpi: int = 150) -> Path:
    """Write a figure as PNG, PDF or SVG, as the suffix of `path` says. Raises InputError if that does not work.

    It is drawn before the file is touched.
    """
    path = Path(path)
    check_picture(path)
    try:
        content = picture(figure, path.suffix.lower(), dpi)
    except (OSError, ValueError) as error:
        raise _refuse(path, f"cannot be drawn: {error}.", "") from error
    write(path, PICTURES[path.suffix.lower()], content)
    return path


def picture(figure: Figure, suffix: str, dpi: int = 150, own_letters: bool = False) -> bytes:
    """A figure as one of FORMATS. own_letters: of an SVG, as outlines, so that it looks the same everywhere."""
    content = io.BytesIO()
    with styled(), mpl.rc_context({"svg.fonttype": "path"} if own_letters else {}):
        figure.savefig(content, dpi=dpi, format=suffix[1:], metadata=FORMATS[suffix])
    return content.getvalue()


def _refuse(path: Path, problem: str, remedy: str) -> InputError:
    return InputError(f"picture {path}", (Fault(key="output", value="", line=None, problem=problem, remedy=remedy),))
