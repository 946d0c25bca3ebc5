"""What heat asks of the films of the time loop, and what it makes of them: the oil that leaves them, their oil and
their scale. Compiled; as in steps.py, the type of the films decides which kind is meant.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.extending import overload

from frbcli.arrays import Array
from frbcli.compiled import AS_KERNELS, compiled
from frbcli.film.cells.balance.side_flow import side_flow
from frbcli.film.cells.cavity_edge import CellEnds
from frbcli.film.cells.data import GIVEN_PRESSURE, VolumeFilms
from frbcli.film.rectangles.end_flow import end_flow
from frbcli.film.state import OIL
from frbcli.solve.films.cell_steps import oil_fraction
from frbcli.solve.films.kinds import CELLS, by_kind, kind_of
from frbcli.thermal.exchange import CLEARANCE, ETA, SCALE


def leaving(
    ends: Any, films: Any, work: Any, f: int, d_x: float, d_y: float, v_x: float, v_y: float, total: float,
    scale: float,
) -> float:  # fmt: skip
    """Flow through the ends of film f over its clearance, m^2/s, see end_flow; total: omega_J + omega_S."""
    raise NotImplementedError


def oil_share(films: Any, work: Any, f: int) -> float:
    """Share of the gap of film f that is oil."""
    raise NotImplementedError


def keep_oil(films: Any, wet: Any, f: int, narrower: float) -> None:
    """The oil of film f and its rate, over the clearance, times `narrower`: the clearance before over that now."""
    raise NotImplementedError


@compiled()
def _scale_oil(wet: Array, f: int, factor: float) -> None:
    """keep_oil of finite-volume films."""
    if factor != 1.0:
        for layer in range(OIL, wet.shape[0]):  # oil and gas with their rates
            for i in range(wet.shape[2]):
                for j in range(wet.shape[3]):
                    wet[layer, f, i, j] *= factor


def set_scale(ends: Any, films: Any, f: int, now: Array, reference: float) -> None:
    """Finite-volume films <- pressures and law of film f at its scale; tabulated ones are asked for scaled
    velocities."""
    raise NotImplementedError


@overload(leaving, jit_options=AS_KERNELS, inline="always")
def _leaving(ends, films, work, f, d_x, d_y, v_x, v_y, total, scale):  # type: ignore[no-untyped-def]
    if kind_of(films) == CELLS:
        return lambda ends, films, work, f, d_x, d_y, v_x, v_y, total, scale: (
            ends.units[f]
            * side_flow(
                films.films[f], films.ring[f], films.cells[f], work.states[f],
                work.grids[f].x, work.grids[f].y, ends.far_open[f] != 0,
            )
        )  # fmt: skip
    return lambda ends, films, work, f, d_x, d_y, v_x, v_y, total, scale: _flow_of(
        ends, f, d_x, d_y, v_x + 0.5 * total * d_y, v_y - 0.5 * total * d_x, scale
    )


def _flow_of(ends: Any, f: int, d_x: float, d_y: float, w_x: float, w_y: float, scale: float) -> float:
    """end_flow of film f of those whose outflow follows from w."""
    raise NotImplementedError


@overload(_flow_of, jit_options=AS_KERNELS, inline="always")
def _flow_of_one(ends, f, d_x, d_y, w_x, w_y, scale):  # type: ignore[no-untyped-def]
    if isinstance(ends, types.UniTuple):
        return lambda ends, f, d_x, d_y, w_x, w_y, scale: end_flow(ends[f], d_x, d_y, w_x, w_y, scale)
    if len(ends) == 1:
        return lambda ends, f, d_x, d_y, w_x, w_y, scale: end_flow(ends[0], d_x, d_y, w_x, w_y, scale)

    def several(ends, f, d_x, d_y, w_x, w_y, scale):  # type: ignore[no-untyped-def]
        if f == 0:
            return end_flow(ends[0], d_x, d_y, w_x, w_y, scale)
        return _flow_of(ends[1:], f - 1, d_x, d_y, w_x, w_y, scale)

    return several


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


by_kind(
    keep_oil,
    inline=True,
    others=lambda films, wet, f, narrower: None,
    cells=lambda films, wet, f, narrower: _scale_oil(wet, f, narrower),
)
by_kind(
    oil_share,
    inline=True,
    others=lambda films, work, f: 1.0,
    cells=lambda films, work, f: oil_fraction(films.cells[f], work.states[f]),
)
by_kind(
    set_scale,
    inline=True,
    others=lambda ends, films, f, now, reference: None,
    cells=lambda ends, films, f, now, reference: _scale_cells(ends, films, f, now, reference),
)
