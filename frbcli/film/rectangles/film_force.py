"""One film as the time loop sees it: force and derivatives from displacement, velocity and angular speed.

The kind of a film is its type: the compiler sees it and compiles what the films of a case need. A kind is a row of
POLAR if it is solved along and across the line of centres; films whose grooves stand still are solved in x and y.
"""

from __future__ import annotations

import math
from typing import Any

from frbcli.compiled import by_types, compiled, type_of
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.mean_fields import MeanFilm, mean_force
from frbcli.film.penalty_table.table import PenaltyTableFilm, source_force
from frbcli.film.rectangles.chain import ChainFilm, chain_force
from frbcli.film.rectangles.fields import FieldsFilm, fields_force
from frbcli.film.rectangles.short import ShortFilm, SuppliedShortFilm, short_closed, short_general
from frbcli.film.rectangles.table import TableFilm, table_force

FilmData = ShortFilm | SuppliedShortFilm | TableFilm | FieldsFilm | ChainFilm | PenaltyTableFilm | MeanFilm

NEAR_CENTRE = 1e-6  # below this eccentricity the direction of the line of centres is arbitrary, and does not matter

# What each kind says, but for the short bearing: the force (r, t), its derivatives by w (rr, rt, tr, tt) and by the
# eccentricity (r, t).
POLAR = {
    SuppliedShortFilm: lambda film, eccentricity, w_r, w_t, omega: short_general(
        eccentricity, w_r, w_t, film.slenderness, film.sigma, film.level
    ),
    TableFilm: lambda film, eccentricity, w_r, w_t, omega: table_force(film.table, eccentricity, w_r, w_t),
    FieldsFilm: lambda film, eccentricity, w_r, w_t, omega: fields_force(
        film.table, film.grid, eccentricity, w_r, w_t, film.sigma, film.level
    ),
    PenaltyTableFilm: lambda film, eccentricity, w_r, w_t, omega: source_force(
        film.table, film.numbers, eccentricity, w_r, w_t, omega
    ),
    MeanFilm: lambda film, eccentricity, w_r, w_t, omega: mean_force(film, eccentricity, w_r, w_t, omega),
}


@by_types(lambda film, *_: POLAR.get(type_of(film)), inline=False)
def _along_and_across(film: Any, eccentricity: float, w_r: float, w_t: float, omega: float) -> Any:
    """The eight numbers of POLAR for a film of any kind; the short bearing's are its own."""
    return short_closed(eccentricity, w_r, w_t, film.slenderness, film.clipped == 1)


@compiled()
def _polar(
    film: Any, d_x: float, d_y: float, w_x: float, w_y: float, omega: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """film_force of a film that is solved along and across the line of centres."""
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    c, s = (d_x / eccentricity, d_y / eccentricity) if eccentricity > NEAR_CENTRE else (1.0, 0.0)
    beyond = eccentricity > LARGEST_ECCENTRICITY
    eccentricity = min(max(eccentricity, NEAR_CENTRE), LARGEST_ECCENTRICITY)
    w_r, w_t = c * w_x + s * w_y, c * w_y - s * w_x
    f_r, f_t, w_rr, w_rt, w_tr, w_tt, e_r, e_t = _along_and_across(film, eccentricity, w_r, w_t, omega)
    if beyond:  # no table reaches there, and no run goes on there: an elastic shell leaves a gap, see contact_gap
        e_r = e_t = 0.0
    # Turning the displacement by dt turns force and w with it: dF/dt = (J F - dF/dw J w) / eps
    t_r = (w_rr * w_t - w_rt * w_r - f_t) / eccentricity
    t_t = (f_r + w_tr * w_t - w_tt * w_r) / eccentricity
    d_xx, d_xy, d_yx, d_yy = _turned(w_rr, w_rt, w_tr, w_tt, c, s)
    k_xx, k_xy, k_yx, k_yy = _turned(e_r, t_r, e_t, t_t, c, s)
    force = (c * f_r - s * f_t, s * f_r + c * f_t)
    return _with_rotation(film.force_scale, omega, force, (d_xx, d_xy, d_yx, d_yy), (k_xx, k_xy, k_yx, k_yy))


@compiled()
def _standing(
    film: ChainFilm, d_x: float, d_y: float, w_x: float, w_y: float, omega: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """film_force of a film whose grooves stand still: solved in the frame of the shell."""
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    if eccentricity > LARGEST_ECCENTRICITY:  # as in film_force
        d_x, d_y = d_x * LARGEST_ECCENTRICITY / eccentricity, d_y * LARGEST_ECCENTRICITY / eccentricity
    f_x, f_y, d_xx, d_xy, d_yx, d_yy, k_xx, k_xy, k_yx, k_yy = chain_force(
        film.table, film.grid, d_x, d_y, w_x, w_y, film.level, film.clipped == 1
    )
    return _with_rotation(film.force_scale, omega, (f_x, f_y), (d_xx, d_xy, d_yx, d_yy), (k_xx, k_xy, k_yx, k_yy))


@compiled()
def _with_rotation(
    scale: float, omega: float, force: tuple[float, float], by_velocity: tuple[float, float, float, float],
    by_displacement: tuple[float, float, float, float],
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """The ten numbers of film_force from derivatives at fixed w: dw/dd = -(omega/2) J adds to the stiffness."""
    half = 0.5 * omega
    d_xx, d_xy, d_yx, d_yy = by_velocity
    k_xx, k_xy, k_yx, k_yy = by_displacement
    return (
        scale * force[0], scale * force[1],
        scale * (k_xx - half * d_xy), scale * (k_xy + half * d_xx),
        scale * (k_yx - half * d_yy), scale * (k_yy + half * d_yx),
        scale * d_xx, scale * d_xy, scale * d_yx, scale * d_yy,
    )  # fmt: skip


@compiled()
def _turned(rr: float, rt: float, tr: float, tt: float, c: float, s: float) -> tuple[float, float, float, float]:
    """Q [[rr, rt], [tr, tt]] Q^T with Q the rotation by the angle of (c, s)."""
    e, f = c * rr - s * tr, c * rt - s * tt
    g, h = s * rr + c * tr, s * rt + c * tt
    return e * c - f * s, e * s + f * c, g * c - h * s, g * s + h * c


def _in_frame_of_shell(film, d_x, d_y, w_x, w_y, omega):  # type: ignore[no-untyped-def]
    return _standing(film, d_x, d_y, w_x, w_y, omega)


@by_types(lambda film, *_: _in_frame_of_shell if type_of(film) is ChainFilm else None, inline=False)
def _in_frame(film: Any, d_x: float, d_y: float, w_x: float, w_y: float, omega: float) -> Any:
    """film_force, by the frame in which the film is solved."""
    return _polar(film, d_x, d_y, w_x, w_y, omega)


@compiled()
def film_force(
    film: Any, d_x: float, d_y: float, v_x: float, v_y: float, omega: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """Force of one whole bearing on the journal.

    d: displacement over the clearance (|d| < 1 is the caller's duty); v: its rate in 1/s; omega: omega_J + omega_S in
    rad/s.
    Returns the force (x, y) in N, its derivatives by d (xx, xy, yx, yy) in N and by v (xx, xy, yx, yy) in N s: ten
    numbers.
    """
    # w = v - (omega/2) J d: the motion seen from a frame that turns with half the speed (4.5)
    return _in_frame(film, d_x, d_y, v_x + 0.5 * omega * d_y, v_y - 0.5 * omega * d_x, omega)  # type: ignore[no-any-return]
