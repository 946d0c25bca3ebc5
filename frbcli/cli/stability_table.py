"""The table of `frb stability` in 80 columns: resting positions and, for each speed, the modes with the least damping.

All growing modes are listed, then the least damped ones.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from frbcli.cli.common import Terminal
    from frbcli.linear.coefficients import RestingFilm
    from frbcli.linear.stability import Stability, StabilityPoint

MOST_SPEEDS, MOST_LINES = 20, 40  # of the table; JSON and the picture have every speed
MODES = 2  # in the one line of a single film
ONE_FILM = ("Hz", "eps", "attitude", *("mode Hz", "damping") * MODES, "growth 1/s")
FILMS = ("Hz", "film", "eps", "attitude", "mode Hz", "damping", "growth 1/s")
NONE = "none"  # no resting position


def tell_points(terminal: Terminal, found: Stability, every_speed: bool) -> None:
    """The table, and the speeds without a resting position. every_speed: show all speeds."""
    several = max((len(point.films) for point in found.points), default=0) > 1
    films = max(1, *(len(point.films) for point in found.points))
    most = min(MOST_SPEEDS, max(1, MOST_LINES // films))
    every = 1 if every_speed else math.ceil(len(found.points) / most)
    shown = found.points[every - 1 :: every]
    rows = [line for point in shown for line in (_film_lines(point) if several else _lines(point))]
    terminal.table(found.case.title or found.case.name, FILMS if several else ONE_FILM, rows)
    if several:
        terminal.result("Modes of the machine: all that grow (damping below 0), then the least damped.")
    if every > 1:
        told = f"{len(shown)} of {len(found.points)} speeds"
        terminal.result(f"{told}; --json gives all, --speed the given ones.")
    _tell_problems(terminal, found.points)


def _tell_problems(terminal: Terminal, points: Sequence[StabilityPoint]) -> None:
    missing = [point for point in points if point.problem]
    if len(missing) > 1:
        speeds = [point.speed_Hz for point in missing]
        span = f"from {min(speeds):.4g} to {max(speeds):.4g} Hz"
        terminal.result(f"No resting position at {len(missing)} of {len(points)} speeds {span}. The first of them:")
    for point in missing[:1]:
        terminal.result(point.problem)


def _lines(point: StabilityPoint) -> list[tuple[str, ...]]:
    """A line of a single film; further ones hold what else grows."""
    if not point.rests:
        return [(f"{point.speed_Hz:.4g}", NONE, *[""] * (len(ONE_FILM) - 2))]
    modes = point.modes[: max(MODES, len(point.growing))]
    cells = [_mode(value) for value in modes]
    lines = []
    for start in range(0, max(1, len(cells)), MODES):
        pairs = [cell for mode in cells[start : start + MODES] for cell in mode[:2]]
        fastest = cells[start][2] if cells else "-"
        place = _place(point.films[0]) if point.films else ("-", "-")
        head = (f"{point.speed_Hz:.4g}", *place) if start == 0 else ("",) * 3
        lines.append((*head, *pairs, *[""] * (2 * MODES - len(pairs)), fastest))
    return lines


def _film_lines(point: StabilityPoint) -> list[tuple[str, ...]]:
    """A line for each film, and beside them one for each mode."""
    if not point.rests:
        return [(f"{point.speed_Hz:.4g}", NONE, *[""] * (len(FILMS) - 2))]
    count = max(len(point.films), len(point.growing))
    films = [(film.name, *_place(film)) for film in point.films]
    modes = [_mode(value) for value in point.modes[:count]]
    films += [("",) * 3] * (count - len(films))
    modes += [("",) * 3] * (count - len(modes))
    speeds = [f"{point.speed_Hz:.4g}", *[""] * (count - 1)]
    return [(speed, *film, *mode) for speed, film, mode in zip(speeds, films, modes, strict=True)]


def _place(film: RestingFilm) -> tuple[str, str]:
    attitude = "-" if math.isnan(film.attitude_deg) else f"{film.attitude_deg:.1f}°"
    return f"{film.eccentricity:.4f}", attitude


def _mode(value: complex) -> tuple[str, str, str]:
    """Frequency in Hz, share of the critical damping (negative where the motion grows), growth in 1/s."""
    return f"{value.imag / (2 * math.pi):.1f}", f"{-value.real / abs(value):.4f}", f"{value.real:.1f}"
