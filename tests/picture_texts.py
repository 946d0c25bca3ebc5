"""Texts of pictures as they are drawn: which reach out of the figure, and which cover each other.

`watch` looks at every picture that the program draws from then on; conftest.py asks after each test what was seen.
"""

import itertools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from frbcli.plot import style

TOLERANCE_px = 1.5  # boxes of letters are larger than their ink
UPRIGHT = 90.0  # boxes of other angles hold more than the text

Drawn = dict[int, tuple[str, Bbox, Bbox, bool]]

seen: list[str] = []  # what the pictures of a test have shown


@contextmanager
def drawn_texts() -> Iterator[Drawn]:
    """Within it, each text that is drawn: its words, its box, that of its figure, whether it is upright."""
    drawn: Drawn = {}
    real = Text.draw

    def draw(self: Text, renderer: Any) -> None:
        real(self, renderer)
        figure = self.get_figure(root=True)
        if figure is not None and self.get_visible() and self.get_text().strip() and self.get_alpha() != 0.0:
            upright = self.get_rotation() % UPRIGHT == 0.0
            box = Bbox(Text.get_window_extent(self, renderer).get_points())  # without the arrow of an annotation
            drawn[id(self)] = self.get_text(), box, Bbox(figure.bbox.get_points()), upright

    Text.draw = draw  # type: ignore[method-assign]
    try:
        yield drawn
    finally:
        Text.draw = real  # type: ignore[method-assign]


def faults(drawn: Drawn) -> list[str]:
    """Texts that reach out of their figure, and pairs that cover each other."""
    outside = [
        f"{words!r} reaches out of the figure"
        for words, box, page, _ in drawn.values()
        if min(box.x0 - page.x0, box.y0 - page.y0, page.x1 - box.x1, page.y1 - box.y1) < -TOLERANCE_px
    ]
    upright = [(words, box) for words, box, _, straight in drawn.values() if straight]
    return outside + [
        f"{one!r} and {other!r} cover each other"
        for (one, a), (other, b) in itertools.combinations(upright, 2)
        if min(a.x1, b.x1) - max(a.x0, b.x0) > TOLERANCE_px and min(a.y1, b.y1) - max(a.y0, b.y0) > TOLERANCE_px
    ]


def watch() -> None:
    """From now on add the faults of every picture to `seen`."""
    if hasattr(style.picture, "watched"):
        return
    real: Callable[..., bytes] = style.picture

    def picture(figure: Figure, *arguments: Any, **options: Any) -> bytes:
        with drawn_texts() as drawn:
            content = real(figure, *arguments, **options)
        title = (figure.get_suptitle() or "without title").replace("\n", ", ")
        seen.extend(f"{title}: {fault}" for fault in faults(drawn))
        return content

    picture.watched = True  # type: ignore[attr-defined]
    style.picture = picture
