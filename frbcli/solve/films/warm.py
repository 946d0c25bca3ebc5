"""What heat asks of the films of the time loop, and what it makes of them: the oil that leaves them, their oil and
their scale. Compiled; as in steps.py, the type of the films decides which kind is meant.
"""

from __future__ import annotations

from typing import Any

from frbcli.arrays import Array
from frbcli.compiled import compiled, of_several
from frbcli.film.cells.balance.side_flow import side_flow
from frbcli.film.cells.cavity_edge import CellEnds
from frbcli.film.cells.data import GIVEN_PRESSURE, OIL, VolumeFilms
from frbcli.film.cells.tilted.motion import level
from frbcli.film.rectangles.end_flow import end_flow
from frbcli.solve.films.cell_steps import oil_fraction
from frbcli.solve.films.kinds import by_kind
from frbcli.thermal.exchange import CLEARANCE, ETA, SCALE

_flow_of = of_several(end_flow, inline=True)


def _leaving_cells(ends, films, work, f, d_x, d_y, v_x, v_y, total, scale):  # type: ignore[no-untyped-def]
    return ends.units[f] * side_flow(
        films.films[f], films.ring[f], films.places[f], films.cells[f], work.states[f],
        level(work.grids[f].x, work.grids[f].y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        ends.far_open[f] != 0,
    )  # fmt: skip


@by_kind(inline=True, cells=_leaving_cells)
def leaving(
    ends: Any, films: Any, work: Any, f: int, d_x: float, d_y: float, v_x: float, v_y: float, total: float,
    scale: float,
) -> Any:  # fmt: skip
    """Flow through the ends of film f over its clearance, m^2/s, see end_flow; total: omega_J + omega_S."""
    return _flow_of(ends, f, d_x, d_y, v_x + 0.5 * total * d_y, v_y - 0.5 * total * d_x, scale)


@by_kind(inline=True, cells=lambda films, work, f: oil_fraction(films.cells[f], work.states[f]))
def oil_share(films: Any, work: Any, f: int) -> float:
    """Share of the gap of film f that is oil."""
    return 1.0


@compiled()
def _scale_oil(wet: Array, f: int, factor: float) -> None:
    """keep_oil of finite-volume films."""
    if factor != 1.0:
        for layer in range(OIL, wet.shape[0]):  # oil and gas with their rates
            for i in range(wet.shape[2]):
                for j in range(wet.shape[3]):
                    wet[layer, f, i, j] *= factor


@by_kind(inline=True, cells=lambda films, wet, f, narrower: _scale_oil(wet, f, narrower))
def keep_oil(films: Any, wet: Any, f: int, narrower: float) -> None:
    """The oil of film f and its rate, over the clearance, times `narrower`: the clearance before over that now."""


@compiled()
def _scale_cells(ends: CellEnds, films: VolumeFilms, f: int, now: Array, reference: float) -> None:
    """Scaled pressures are those in Pa over 12 eta / psi^2: what is given in Pa falls with the scale, forces rise."""
    scale = now[SCALE, f]
    film, made = films.films[f], ends.films[f]
    film.scales.cavitation, film.scales.ambient = made.scales.cavitation / scale, made.scales.ambient / scale
    film.far.pressure, film.supply = made.far.pressure / scale, made.supply / scale
    film.centrifugal = made.centrifugal / scale
    film.force_scale, film.roughness = made.force_scale * scale, made.roughness * reference / now[CLEARANCE, f]
    film.given = made.given * reference / now[CLEARANCE, f]
    film.line = made.line * reference / now[CLEARANCE, f]
    for p in range(ends.exponents.shape[1]):
        if ends.exponents[f, p] != 0.0:
            film.parameters[p] = made.parameters[p] * scale ** ends.exponents[f, p]
    for i in range(films.cells.shape[2]):
        for j in range(films.cells.shape[3]):
            films.cells[f, GIVEN_PRESSURE, i, j] = ends.given[f, i, j] / scale
    for q in range(films.feed_holes.shape[0]):
        hole, at_first = films.feed_holes[q], ends.feed_holes[q]
        if hole.film == f:
            hole.pressure_scale = at_first.pressure_scale * scale
            hole.flow_scale = at_first.flow_scale * now[CLEARANCE, f] / reference
    for k in range(films.channels.shape[0]):  # filled with the oil of the outer film, or of a groove
        channel = films.channels[k]
        filled_from = channel.outer if channel.outer >= 0 else channel.inner
        if films.feed_holes[filled_from].film == f:
            channel.resistance = ends.resistance[k] * now[ETA, f]


@by_kind(inline=True, cells=lambda ends, films, f, now, reference: _scale_cells(ends, films, f, now, reference))
def set_scale(ends: Any, films: Any, f: int, now: Array, reference: float) -> None:
    """Finite-volume films <- pressures and law of film f at its scale; tabulated ones are asked for scaled
    velocities."""
