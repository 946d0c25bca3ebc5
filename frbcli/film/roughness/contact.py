"""Journal and shell that touch.

- Smooth surfaces on an elastic shell: what the film of a journal pressed into it feels, and what pushes it back.
  The time loop has the same in solve/stage/forces.py.
- Rough surfaces: the asperities of a film act in parallel to it, with force, friction, torques and all derivatives. A
  ring that sticks and slips follows the motion, so that the torques on journal and shell count as the force does. The
  time loop, which has the speeds from stage to stage, takes `rub` alone.
- What a gap between rough surfaces lets flow and how it resists sliding, compiled; see asperities.py. Gaps h and
  roughness are over the clearance; a roughness of 0: smooth surfaces.

The gap that is left under a journal pressed into its shell: surfaces are rough, a film between them never ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.film import Motion
from frbcli.film.cells.loads import FilmLoads
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.rectangles.film import FilmForce, none_of
from frbcli.film.roughness.asperities import (
    CUT,
    DEPTH,
    FADES,
    FAR,
    LAST_STRESS,
    RATE,
    SERIES,
    SLOW,
    SPREAD,
    STRESS_A,
    STRESS_B,
    STRESS_C,
    STRESS_D,
    TERMS,
    A,
    Asperities,
    B,
    C,
    D,
    rub,
    standing_eccentricity,
    touch,
    touch_along,
)


@dataclass(frozen=True)
class ElasticShell:
    """The shells of all films. begins: eccentricity at which the surfaces touch; stiffness: N/m of one bearing."""

    begins: float
    stiffness: float

    def felt(self, place: Array, clearance: float) -> Array:
        """(2,) m: the displacement that a film feels of a journal at `place` (2,) in m."""
        d_x, d_y = (place / clearance).tolist()
        begins = closes_freely_until(self.begins)
        if np.hypot(d_x, d_y) <= begins:
            return place
        return clearance * np.array(contact_gap(begins, d_x, d_y, 0.0, 0.0)[:2])

    def pressed(self, load: float, clearance: float) -> float:
        """Eccentricity in m of a journal that the shell alone carries under a load in N."""
        return self.begins * clearance + load / self.stiffness

    def force(
        self, film: Callable[[Array, Array], FilmForce], place: Array, rate: Array, clearance: float
    ) -> FilmForce:
        """Force and derivatives of a film, by displacement and velocity, and of its shell together, with the journal at
        `place` (2,) in m with a velocity (2,) in m/s."""
        (d_x, d_y), (v_x, v_y) = (place / clearance).tolist(), (rate / clearance).tolist()
        eccentricity, begins = float(np.hypot(d_x, d_y)), closes_freely_until(self.begins)
        if eccentricity <= begins:
            return film(place, rate)
        x, y, u, w, g_xx, g_yy, g_xy, r_xx, r_yy, r_xy = contact_gap(begins, d_x, d_y, v_x, v_y)
        force = film(clearance * np.array([x, y]), clearance * np.array([u, w]))
        felt, rated = np.array([[g_xx, g_xy], [g_xy, g_yy]]), np.array([[r_xx, r_xy], [r_xy, r_yy]])
        outwards = place / np.hypot(*place)
        along = self.stiffness if eccentricity > self.begins else 0.0
        push = along * clearance * (eccentricity - self.begins)
        across = push / (eccentricity * clearance)
        spring = across * np.eye(2) + (along - across) * np.outer(outwards, outwards)
        return FilmForce(
            force.force - push * outwards,
            force.by_displacement @ felt + force.by_velocity @ rated - spring,
            force.by_velocity @ felt,
            force.field,
            force.fraction,
            off=force.off,
        )


@dataclass(frozen=True)
class Rubbing:
    """surfaces: None between smooth ones; film: its number of these; clearance: m."""

    surfaces: Asperities | None
    film: int
    clearance: float

    def force(self, place: Array, rate: Array, slip: float, shell: float = 0.0) -> FilmForce:
        """What the summits do to a journal at `place` (2,) in m with a velocity (2,) in m/s; slip: omega_J - omega_S,
        shell: omega_S, rad/s."""
        if self.surfaces is None:
            return none_of(2)
        (e_x, e_y), (v_x, v_y) = place[:2].tolist(), rate[:2].tolist()
        rubbed = rub(self.surfaces, self.film, self.clearance, e_x, e_y, v_x, v_y, slip, shell)
        by_place, by_rate = (np.array(rubbed[first : first + 4]).reshape(2, 2) for first in (2, 6))
        return FilmForce(np.array(rubbed[:2]), by_place, by_rate)

    def with_summits(self, film: FilmForce, place: Array, rate: Array, slip: float, shell: float = 0.0) -> FilmForce:
        """A film and its summits, see force."""
        if self.surfaces is None:
            return film
        return film.plus(self.force(place, rate, slip, shell))

    def power(self, place: Array, total: float, slip: float) -> float:
        """Heat in W that friction makes while the journal rests at `place` (2,) in m; total, slip: omega_J + omega_S
        and omega_J - omega_S in rad/s."""
        if self.surfaces is None:
            return 0.0
        e_x, e_y = place[:2].tolist()
        shell = 0.5 * (total - slip)
        return rub(self.surfaces, self.film, self.clearance, e_x, e_y, 0.0, 0.0, slip, shell).power

    def slopes(self, motions: Array) -> Array:
        """(k, QUANTITIES, COLUMNS) force and torques with all derivatives in motions (k, 6), see rub_slopes."""
        if self.surfaces is None:
            return np.zeros((len(motions), QUANTITIES, COLUMNS))
        return rub_slopes(self.surfaces, self.film, self.clearance, motions)

    def standing(self, load: float) -> float:
        """Eccentricity in m of a journal that stands still on its summits under a load in N; 0 between smooth
        surfaces, and if they do not carry it up to two clearances."""
        far = 2.0 * self.clearance
        if self.surfaces is None or touch(self.surfaces, self.film, self.clearance, far).radial < load:
            return 0.0
        return standing_eccentricity(self.surfaces, self.film, self.clearance, load)

    def loads(self, film: FilmLoads, motion: Motion, turning: float = 0.0) -> FilmLoads:
        """The loads of a film with its summits. motion: in a shell at rest, seen from a frame that turns with `turning`
        rad/s, as the force is."""
        if self.surfaces is None:
            return film
        c, (d_x, d_y), (v_x, v_y) = self.clearance, motion.d, motion.v
        slip = motion.omega + 2.0 * turning
        rubbed = rub(self.surfaces, self.film, c, c * d_x, c * d_y, c * v_x, c * v_y, slip, -turning)
        x, y = film.force
        torque = replace(film.torque, summits=(rubbed.torque, -rubbed.shell_torque))
        return replace(film, force=(x + rubbed.f_x, y + rubbed.f_y), torque=torque)

    def share_of_error(self, film: FilmLoads, whole: FilmLoads) -> float:
        """Relative error of the force with the summits over the error of the film alone."""
        size = math.hypot(*whole.force)
        return math.hypot(*film.force) / size if self.surfaces is not None and size > 0.0 else 1.0


# Quantities: force on the journal in N, torques in N m on the journal and on the shell, each about its own middle
F_X, F_Y, ON_JOURNAL, ON_SHELL, QUANTITIES = range(5)
# Columns of each: its value, and its derivatives by displacement, velocity, slip and speed of the shell
VALUE, BY_X, BY_Y, BY_V_X, BY_V_Y, BY_SLIP, BY_SHELL, COLUMNS = range(8)
LEAST = 1e-300  # m: eccentricity in the middle, which has no line of centres


def rub_slopes(asperities: Asperities, f: int, clearance: float, motions: Array) -> Array:
    """(k, QUANTITIES, COLUMNS) of film f in motions (k, 6): displacement in m and velocity in m/s of the journal in its
    shell, slip omega_J - omega_S and speed omega_S of the shell in rad/s. See rub of asperities.py."""
    place, rate, (slip, shell) = motions[:, :2], motions[:, 2:4], motions[:, 4:].T
    e = np.maximum(np.hypot(*place.T), LEAST)
    touched = np.zeros((len(motions), 4))
    touch_along(asperities, f, clearance, e, touched)
    normal, radial, normal_slope, radial_slope = touched.T
    radius, away = float(asperities.radii[f]), place / e[:, None]
    across = np.column_stack([-away[:, 1], away[:, 0]])  # to which the line of centres turns
    share = radial / np.maximum(normal, LEAST)
    along = np.sum(across * rate, axis=1) - shell * e
    outwards = (radial_slope - share * normal_slope) / np.maximum(normal, LEAST) * along - share * shell
    turned = -share * np.sum(away * rate, axis=1) / e

    def spread(value: Array, by_e: Array | float, by_turn: Array | float, by_rate: Array, last: list[Array]) -> Array:
        """(k, COLUMNS) by derivatives outwards, across, by the velocity across, and by both speeds."""
        by_place = np.reshape(by_e, (-1, 1)) * away + np.reshape(by_turn, (-1, 1)) * across
        return np.column_stack([value, by_place, by_rate[:, None] * across, *last])

    sliding = spread(
        radius * slip + share * along, outwards, turned, share, [np.full_like(e, radius), -share * e]
    )
    held = np.tanh(sliding[:, VALUE] / SLOW)
    coefficient = asperities.friction / SLOW * (1.0 - held**2)[:, None] * sliding
    coefficient[:, VALUE] = asperities.friction * held

    def by_friction(size: Array, by_e: Array) -> Array:
        """(k, COLUMNS) of the coefficient of friction times a size, which the eccentricity changes."""
        forces = size[:, None] * coefficient
        forces[:, BY_X : BY_Y + 1] += (coefficient[:, VALUE] * by_e)[:, None] * away
        return forces

    friction = by_friction(radial, radial_slope)
    still = np.zeros_like(e)
    pressed = spread(radial, radial_slope, 0.0, still, [still, still])
    force = -away[:, :, None] * pressed[:, None] - across[:, :, None] * friction[:, None]
    turns = across / e[:, None]  # by which both directions turn with the displacement
    force[:, :, BY_X : BY_Y + 1] += (
        friction[:, None, :1] * away[:, :, None] - pressed[:, None, :1] * across[:, :, None]
    ) * turns[:, None]
    on_journal = by_friction(-radius * normal, -radius * normal_slope)
    on_shell = by_friction(e * radial + radius * normal, radial + e * radial_slope + radius * normal_slope)
    return np.concatenate([force, on_journal[:, None], on_shell[:, None]], axis=1)


@compiled()
def rough_flow(h: float, roughness: float) -> tuple[float, float]:
    """phi_x and its derivative by h."""
    fading = DEPTH * math.exp(-RATE * h / roughness)
    return 1.0 - fading, RATE / roughness * fading


@compiled(inline=True)
def flowing_cube(h: float, roughness: float) -> tuple[float, float]:
    """phi_x h^3 and its derivative by h."""
    cube, slope = h * h * h, 3.0 * h * h
    if roughness > 0.0:
        factor, grows = rough_flow(h, roughness)
        cube, slope = factor * cube, factor * slope + grows * cube
    return cube, slope


@compiled()
def sheared_gap(h: float, roughness: float, sliding: float) -> tuple[float, float]:
    """Phi_s sigma times a sliding speed, by which a rough surface carries more than its mean plane, and its derivative
    by h."""
    if sliding == 0.0:
        return 0.0, 0.0
    x = h / roughness
    if x > FAR:
        near = A * FAR**B * math.exp(-C * FAR + D * FAR * FAR)
        factor = sliding * near * math.exp(-FADES * (x - FAR))
        return roughness * factor, -FADES * factor
    factor = sliding * A * math.exp(B * math.log(x) - C * x + D * x * x)
    return roughness * factor, factor * (B / x - C + 2.0 * D * x)


@compiled()
def stress_factor(h: float, roughness: float) -> float:
    """phi_f + Phi_fs; 1 between smooth surfaces."""
    if roughness == 0.0:
        return 1.0
    x = h / roughness
    z = x / SPREAD
    if z > SERIES:
        factor, moment, power = 1.0, 1.0, 1.0
        for k in range(1, TERMS + 1):
            moment, power = moment * (2.0 * k - 1.0) / (2.0 * k + 7.0), power * z * z
            factor += moment / power
    else:
        low, high = z - 1.0 if z > 1.0 else CUT, z + 1.0
        a, b = 1.0 - z * z, 2.0 * z
        whole, p, q = a**3 * math.log(high / low), low, high
        square = b * b
        powers = (3.0 * a * a * b, 3.0 * a * (square - a), b * (square - 6.0 * a), 3.0 * (a - square), 3.0 * b, -1.0)
        for k in range(6):
            whole += powers[k] * (q - p) / (k + 1.0)
            p, q = p * low, q * high
        factor = 35.0 / 32.0 * z * whole
    if x < LAST_STRESS:
        factor += STRESS_A * math.exp(STRESS_B * math.log(x) - STRESS_C * x + STRESS_D * x * x)
    return factor


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
