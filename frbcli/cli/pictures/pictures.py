"""Pictures of commands: a failure is a remark, and never affects the results."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from frbcli.cli.common import Terminal
from frbcli.errors import InputError

if TYPE_CHECKING:
    from frbcli.plot.style import Picture

MISSING = re.compile(r"Glyph (\d+) .*missing from")  # how matplotlib begins its warning of a letter


def draw(terminal: Terminal, picture: Callable[[], Picture], target: Path, what: str = "picture") -> Path | None:
    """Draw a picture of printed results. None if that fails, with the reason as a remark."""
    try:
        return draw_wanted(terminal, picture, target, what)
    except InputError as error:
        reason = " ".join(f"{fault.problem} {fault.remedy}" for fault in error.faults)
    except Exception as error:  # of the fonts, of the memory, of matplotlib: the results stand without a picture
        reason = f"{type(error).__name__}: {error}"
    terminal.remark(f"No picture {target}: {_one_line(reason)}")
    return None


def draw_wanted(terminal: Terminal, picture: Callable[[], Picture], target: Path, what: str = "picture") -> Path:
    """Draw the picture that a command is for. Raises InputError if it cannot be written."""
    from frbcli.plot.look import fit
    from frbcli.plot.style import save_figure

    look = terminal.look
    with warnings.catch_warnings(record=True) as caught:
        warnings.filterwarnings("always", message="Glyph")
        figure = fit(picture(), look.size_in, look.x_limits, look.y_limits, look.rpm)
        save_figure(figure, target, look.dpi)
    terminal.result(f"{what}: {target}")
    texts = [str(warning.message) for warning in caught]
    letters = dict.fromkeys(chr(int(found[1])) for found in map(MISSING.match, texts) if found)
    if letters:
        shown = ", ".join(letter if letter.isprintable() else repr(letter) for letter in letters)
        terminal.remark(f"{target}: the font has no {shown}; boxes are drawn instead.")
    for text in dict.fromkeys(text for text in texts if not MISSING.match(text)):
        terminal.remark(f"{target}: {_one_line(text)}")
    return target


def _one_line(text: str) -> str:
    return " ".join(text.split())
