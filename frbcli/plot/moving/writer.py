"""Moving pictures: GIF, or MP4 where ffmpeg is installed."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import matplotlib as mpl
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.figure import Figure

from frbcli.plot.style import refused
from frbcli.results.files.write import MARK, PICTURES, require_places, written

FORMATS = (".gif", ".mp4")
FRAMES, PER_SECOND = 80, 20
DPI = 90
GIF_ENDS = b";"

Observer = Callable[[int, int], None]  # frames drawn, and how many there are


def check_animation(path: Path, force: bool = False) -> None:
    """Raises InputError if a moving picture cannot have this name or this place, or its program is missing. force: also
    replace a file that frb did not write."""
    if path.suffix.lower() not in FORMATS:
        raise refused(path, "is not a format of moving pictures.", f"End it with {' or '.join(FORMATS)}.")
    if path.suffix.lower() == ".mp4" and _ffmpeg() is None:
        raise refused(path, "needs the program ffmpeg, which is not here.", "Install it, or end the name with .gif.")
    require_places([(path, PICTURES[path.suffix.lower()])], force=force)


def _ffmpeg() -> str | None:
    """The program ffmpeg, not one of the current folder; None if there is none."""
    program = shutil.which(mpl.rcParams["animation.ffmpeg_path"])
    return program if program is not None and os.path.isabs(program) else None


def write_animation(
    path: Path, figure: Figure, draw: Callable[[int], None], frames: int, dpi: int = DPI,
    observe: Observer | None = None, force: bool = False,
) -> None:  # fmt: skip
    """Write a figure as a moving picture; draw: changes it to a frame of that number; force: see check_animation."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # it would be sought anew for each frame
    moving: Any = FuncAnimation(figure, draw, frames=frames, blit=False)
    as_film = path.suffix.lower() == ".mp4"
    writer: Any = FFMpegWriter(PER_SECOND, metadata={"comment": MARK}) if as_film else PillowWriter(PER_SECOND)
    progress = None if observe is None else lambda frame, _: observe(frame + 1, frames)
    with written(path, PICTURES[path.suffix.lower()], force=force) as part, TemporaryDirectory(prefix="frb-") as folder:
        drawn = Path(folder) / f"moving{path.suffix.lower()}"  # by which its writers know the format
        with mpl.rc_context({"animation.ffmpeg_path": _ffmpeg() or ""}):
            moving.save(str(drawn), writer=writer, dpi=dpi, progress_callback=progress)
        if not as_film:
            _comment(drawn)
        shutil.copyfile(drawn, part)


def _comment(gif: Path) -> None:
    """Put the mark of frb into a GIF, as a comment in front of the byte that ends it."""
    with gif.open("r+b") as file:
        file.seek(-len(GIF_ENDS), os.SEEK_END)
        file.write(b"!\xfe" + bytes([len(MARK)]) + MARK.encode() + b"\0" + GIF_ENDS)
