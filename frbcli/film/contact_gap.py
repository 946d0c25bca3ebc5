"""The gap that is left under a journal pressed into its shell: surfaces are rough, a film between them never ends."""

from __future__ import annotations

import math

from frbcli.compiled import compiled
from frbcli.film.gap import LARGEST_ECCENTRICITY

KEPT = 0.2  # of the gap at which the surfaces touch: what no load presses out
ELASTIC_LIMIT = 1.5  # eccentricity that no journal exceeds even under elastic contact
LATEST = 1.0 - (1.0 - LARGEST_ECCENTRICITY) / KEPT  # beginning from which films can be computed in the gap that is kept


@compiled()
def closes_freely_until(contact_eccentricity: float) -> float:
    """Eccentricity from which on the film's gap closes more slowly than the journal moves: where the surfaces touch,
    or somewhat before if the gap that is kept would be too small for the films."""
    return min(contact_eccentricity, LATEST)


@compiled()
def contact_gap(
    begins: float, d_x: float, d_y: float, v_x: float, v_y: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """The motion that a film feels of a journal beyond the eccentricity `begins`, see closes_freely_until; d:
    displacement over the clearance, v: its rate.

    The felt eccentricity goes on as begins + room tanh((eps - begins) / room), room = (1 - KEPT) (1 - begins): its
    slope falls from 1 to 0, so that the gap, its rate and with them the force have no jump. The felt velocity is the
    rate of the felt displacement, as the balance of the oil asks for: a gap that does not close squeezes nothing.

    Returns ten numbers: felt displacement (x, y); felt velocity (x, y); the matrix G (xx, yy, xy), by which the felt
    displacement follows the displacement and the felt velocity the velocity; and the matrix (xx, yy, xy) by which the
    felt velocity G v follows the displacement. Both are symmetric: the felt displacement is a gradient.
    """
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    n_x, n_y, room = d_x / eccentricity, d_y / eccentricity, (1.0 - KEPT) * (1.0 - begins)
    share = math.tanh((eccentricity - begins) / room)
    # slopes of the felt displacement along and across the line of centres, and how they change with the eccentricity
    radial, along = 1.0 - share * share, (begins + room * share) / eccentricity
    bend, turn = -2.0 * share * radial / room, (radial - along) / eccentricity
    v_r, v_t = n_x * v_x + n_y * v_y, n_x * v_y - n_y * v_x
    u_r, u_t = radial * v_r, along * v_t
    rr, rt, tt = bend * v_r, turn * v_t, turn * v_r
    return (
        along * d_x,
        along * d_y,
        n_x * u_r - n_y * u_t,
        n_y * u_r + n_x * u_t,
        radial * n_x * n_x + along * n_y * n_y,
        radial * n_y * n_y + along * n_x * n_x,
        (radial - along) * n_x * n_y,
        rr * n_x * n_x - 2.0 * rt * n_x * n_y + tt * n_y * n_y,
        rr * n_y * n_y + 2.0 * rt * n_x * n_y + tt * n_x * n_x,
        (rr - tt) * n_x * n_y + rt * (n_x * n_x - n_y * n_y),
    )
