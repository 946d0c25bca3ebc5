"""Rough surfaces that touch: summits, their pressure over the gap, and its integrals over a bearing.

How many summits of two rough surfaces meet, and how hard, at a distance x of their mean planes over the roughness.

F_n(x) is the mean of (s - x)^n over the summits s > x of a normal distribution. The force of elastic summits goes with
F_5/2, and the area in which they touch with F_2.

Source: Greenwood, Tripp: The contact of two nominally flat rough surfaces. Proc. Instn. Mech. Engrs. 185 (1970),
625-633.

Force and friction of the summits between a rough journal and its rough shell, compiled.

The mean planes of the surfaces have the distance of the smooth gap, h = c - e cos(theta), with theta from the line of
centres: it is the same along the axis, so that the integrals over the bearing depend on the eccentricity alone. The
trapezoidal rule over the arc where summits meet converges exponentially, as the pressure fades out at its ends.

Source of pressure and area: Greenwood, Tripp 1970. Boundary friction is Coulomb's.

How oil resists the sliding of rough surfaces of no direction, over the gap of their mean planes by the combined
roughness, x = h / sigma, on arrays.

Source: Patir, Cheng: An average flow model for determining effects of three-dimensional roughness on partial
hydrodynamic lubrication. J. Lubr. Technol. 100 (1978), 12-17; Application of average flow model to lubrication between
rough sliding surfaces. J. Lubr. Technol. 101 (1979), 220-230. Their fits hold for gaps of at least half the roughness.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled

FLAT, LAST = -4.0, 8.0  # distances between which ln F_5/2 is a polynomial; at the second one no summits meet any more
# Chebyshev coefficients of ln F_5/2 from FLAT to LAST, from the integral
LOGARITHM = (
    -11.6123107489, -20.6174528323, -6.26345464158, -0.736466893402, 0.119477905162, 0.00873086096364,
    -0.0117519214807, 0.00233129505546, 0.000762388731151, -0.000563719733282, 7.16204341107e-05, 6.52624069993e-05,
    -3.49232427432e-05, 1.33684259964e-06, 5.71061698373e-06, -2.38287262562e-06, -1.51399698645e-07,
    5.0642086078e-07, -1.68236249287e-07, -3.1447994786e-08, 4.51476375396e-08,
)  # fmt: skip
# Binomial coefficients of (s - x)^(5/2) in s / x, of even order, times the moments of s: all summits meet
PRESSED = (1.0, 1.875, -0.1171875, -0.0732421875, -0.144195556640625)


@compiled()
def elastic_summits(x: float) -> tuple[float, float]:
    """F_5/2(x) and its derivative, to 1e-6 of the function; 0 from LAST on."""
    if x >= LAST:
        return 0.0, 0.0
    if x < FLAT:
        square = 1.0 / (x * x)
        series, slope = 0.0, 0.0
        for k in range(len(PRESSED) - 1, -1, -1):
            series = series * square + PRESSED[k]
            slope = slope * square + (2.5 - 2 * k) * PRESSED[k]
        power = (-x) ** 1.5
        return -x * power * series, -power * slope
    t = (2.0 * x - FLAT - LAST) / (LAST - FLAT)
    after, own, after_slope, own_slope = 0.0, 0.0, 0.0, 0.0
    for k in range(len(LOGARITHM) - 1, 0, -1):  # Clenshaw's sum and its derivative
        own_slope, after_slope = 2.0 * own + 2.0 * t * own_slope - after_slope, own_slope
        own, after = LOGARITHM[k] + 2.0 * t * own - after, own
    value = math.exp(LOGARITHM[0] + t * own - after)
    return value, value * (own + t * own_slope - after_slope) * 2.0 / (LAST - FLAT)


@compiled()
def touching_summits(x: float) -> tuple[float, float]:
    """F_2(x), in closed form, and its derivative; 0 from LAST on."""
    if x >= LAST:
        return 0.0, 0.0
    share, density = 0.5 * math.erfc(x / math.sqrt(2.0)), math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    return (1.0 + x * x) * share - x * density, -2.0 * (density - x * share)


POINTS = 40  # of the trapezoidal rule over half of the arc
HALVINGS = 60  # of the bracket of an eccentricity
SLOW = 1e-3  # m/s: friction is fully developed at some times this sliding speed, and below it holds the surfaces


class Asperities(NamedTuple):
    """Rough surfaces of all films. roughness: combined, in m; elastic: Pa, pressure of elastic summits over F_5/2;
    plastic: Pa, the same of summits that yield over F_2, infinite if they never do; friction: coefficient; radii,
    widths: (films,) m of the bearings; mean_height: of the summits of both surfaces over their mean planes, m."""

    roughness: float
    elastic: float
    plastic: float
    friction: float
    radii: Array
    widths: Array
    mean_height: float = 0.0


def make_asperities(
    roughness: float, summit_radius: float, summit_density: float, modulus: float, hardness: float | None,
    friction: float, radii: Array, widths: Array, mean_height: float = 0.0,
) -> Asperities:  # fmt: skip
    """Asperities of Hertzian summits: pairs that meet by s - x touch with (32/15) pi E (radius/2)^(1/2) radius
    (s - x)^(5/2) of force and pi^2 radius^2 (s - x)^2 of area, by the density of both surfaces. SI units."""
    crowd = summit_density * summit_radius * roughness
    elastic = 16.0 * math.sqrt(2.0) * math.pi / 15.0 * crowd**2 * math.sqrt(roughness / summit_radius) * modulus
    plastic = math.inf if hardness is None else math.pi**2 * crowd**2 * hardness
    return Asperities(roughness, elastic, plastic, friction, radii, widths, mean_height)


class Touch(NamedTuple):
    """Integrals over a bearing, N, and their derivatives by the eccentricity in N/m. normal: of the pressure, which
    friction turns with; radial: of its part along the line of centres, which carries."""

    normal: float
    radial: float
    normal_slope: float
    radial_slope: float


class Rub(NamedTuple):
    """What the summits do to a journal. Force (x, y) in N and its derivatives by displacement in N/m and velocity in
    N s/m, row by row; torque: on the journal about its middle, N m; shell_torque: on the shell about its own; radial:
    force that pushes the surfaces apart, N; power: that friction turns into heat, W; grip, drift: what the torque falls
    by per slip, N m s, and the friction across the line of centres grows by, N s."""

    f_x: float
    f_y: float
    k_xx: float
    k_xy: float
    k_yx: float
    k_yy: float
    d_xx: float
    d_xy: float
    d_yx: float
    d_yy: float
    torque: float
    shell_torque: float
    radial: float
    power: float
    grip: float
    drift: float


APART = Rub(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled()
def summit_pressure(x: float, elastic: float, plastic: float) -> tuple[float, float]:
    """Pressure in Pa at a distance x over the roughness, and its derivative: of elastic summits, but of no more than
    their area carries at the hardness of the softer surface."""
    value, slope = elastic_summits(x)
    value, slope = elastic * value, elastic * slope
    if plastic < math.inf:
        area, area_slope = touching_summits(x)
        if plastic * area < value:
            return plastic * area, plastic * area_slope
    return value, slope


@compiled()
def reach(asperities: Asperities) -> float:
    """Distance of the mean planes in m from which on no summits meet."""
    return asperities.mean_height + LAST * asperities.roughness


@compiled()
def meets(asperities: Asperities, clearance: float, eccentricity: float) -> bool:
    """Whether any summits meet; eccentricity in m."""
    return clearance - eccentricity < reach(asperities)


@compiled()
def touch(asperities: Asperities, f: int, clearance: float, eccentricity: float) -> Touch:
    """The integrals of film f at an eccentricity in m, where summits meet."""
    roughness = asperities.roughness
    end = (clearance - reach(asperities)) / eccentricity if eccentricity > 0.0 else -1.0
    arc = math.acos(max(-1.0, min(1.0, end)))
    normal = radial = normal_slope = radial_slope = 0.0
    for k in range(POINTS + 1):
        along = math.cos(k * arc / POINTS)
        pressure, slope = summit_pressure(
            (clearance - eccentricity * along - asperities.mean_height) / roughness,
            asperities.elastic,
            asperities.plastic,
        )
        weight = 0.5 if k in (0, POINTS) else 1.0
        normal += weight * pressure
        radial += weight * pressure * along
        normal_slope -= weight * slope * along / roughness
        radial_slope -= weight * slope * along * along / roughness
    area = 2.0 * asperities.radii[f] * asperities.widths[f] * arc / POINTS
    return Touch(area * normal, area * radial, area * normal_slope, area * radial_slope)


@compiled()
def rub(
    asperities: Asperities, f: int, clearance: float, e_x: float, e_y: float, v_x: float, v_y: float, slip: float,
    shell_speed: float,
) -> Rub:  # fmt: skip
    """What the summits of film f do: displacement e in m and velocity v in m/s of the journal in its shell; slip:
    omega_J - omega_S, shell_speed: omega_S, rad/s.

    Friction has one direction over the arc, the direction of the mean sliding speed weighted with the pressure; so it
    only dissipates. """
    eccentricity = math.sqrt(e_x * e_x + e_y * e_y)
    if eccentricity == 0.0 or not meets(asperities, clearance, eccentricity):
        return APART
    normal, radial, normal_slope, radial_slope = touch(asperities, f, clearance, eccentricity)
    if normal == 0.0:
        return APART
    radius, n_x, n_y = asperities.radii[f], e_x / eccentricity, e_y / eccentricity
    v_r, v_t = n_x * v_x + n_y * v_y, n_x * v_y - n_y * v_x
    share, across = radial / normal, v_t - shell_speed * eccentricity
    sliding = radius * slip + share * across
    held = math.tanh(sliding / SLOW)
    bend = asperities.friction * (1.0 - held * held) / SLOW
    coefficient = asperities.friction * held
    # Derivatives of the sliding speed by the eccentricity and by a displacement across it
    by_r = (radial_slope - share * normal_slope) / normal * across - share * shell_speed
    by_t = -share * v_r / eccentricity
    friction = coefficient * radial
    rr, rt = -radial_slope, friction / eccentricity
    tr, tt = -coefficient * radial_slope - bend * radial * by_r, -radial / eccentricity - bend * radial * by_t
    damping = -bend * radial * share  # of a velocity across
    torque = -coefficient * radius * normal
    return Rub(
        -radial * n_x + friction * n_y,
        -radial * n_y - friction * n_x,
        rr * n_x * n_x - (rt + tr) * n_x * n_y + tt * n_y * n_y,
        (rr - tt) * n_x * n_y + rt * n_x * n_x - tr * n_y * n_y,
        (rr - tt) * n_x * n_y + tr * n_x * n_x - rt * n_y * n_y,
        rr * n_y * n_y + (rt + tr) * n_x * n_y + tt * n_x * n_x,
        damping * n_y * n_y,
        -damping * n_x * n_y,
        -damping * n_x * n_y,
        damping * n_x * n_x,
        torque,
        eccentricity * friction - torque,
        radial,
        coefficient * normal * sliding,
        bend * radius * radius * normal,
        bend * radius * radial,
    )


def standing_eccentricity(asperities: Asperities, f: int, clearance: float, load: float) -> float:
    """Eccentricity in m at which the summits of film f carry a load in N alone, without sliding."""
    if load <= 0.0:
        return 0.0
    low, high = clearance - reach(asperities), clearance
    while touch(asperities, f, clearance, high).radial < load:
        high += clearance
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if touch(asperities, f, clearance, middle).radial < load else (low, middle)
    return 0.5 * (low + high)


@compiled()
def wear_along(
    asperities: Asperities, f: int, clearances: Array, motions: Array, scale: float, depths: Array
) -> None:
    """Add the depth in m that each place around the shell of film f loses at every sample; clearances, motions: see
    rub_along; scale: wear rate in m^2/N times the time between samples; depths: (m,) at even angles, from the top on
    counter-clockwise."""
    for k in range(motions.shape[0]):
        e_x, e_y, v_x, v_y, slip, shell_speed = motions[k]
        eccentricity = math.sqrt(e_x * e_x + e_y * e_y)
        if eccentricity == 0.0 or not meets(asperities, clearances[k], eccentricity):
            continue
        normal, radial, _, _ = touch(asperities, f, clearances[k], eccentricity)
        if normal == 0.0:
            continue
        across = (e_x * v_y - e_y * v_x) / eccentricity - shell_speed * eccentricity
        path = scale * abs(asperities.radii[f] * slip + radial / normal * across)
        for j in range(depths.shape[0]):
            phi = 2.0 * math.pi * j / depths.shape[0]
            gap = clearances[k] + e_x * math.sin(phi) - e_y * math.cos(phi) - asperities.mean_height
            depths[j] += path * summit_pressure(gap / asperities.roughness, asperities.elastic, asperities.plastic)[0]


@compiled()
def rub_along(asperities: Asperities, f: int, clearances: Array, motions: Array, rows: Array) -> None:
    """Force (x, y) on the journal in N, torque on it in N m and power of friction in W of film f: rows (k, 4), by
    clearances (k,) and motions (k, 6), the arguments of `rub` from e_x on."""
    for k in range(motions.shape[0]):
        e_x, e_y, v_x, v_y, slip, shell_speed = motions[k]
        each = rub(asperities, f, clearances[k], e_x, e_y, v_x, v_y, slip, shell_speed)
        rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3] = each.f_x, each.f_y, each.torque, each.power


@compiled()
def touch_along(asperities: Asperities, f: int, clearance: float, eccentricities: Array, rows: Array) -> None:
    """rows (k, 4) <- the integrals of film f as touch has them, at eccentricities (k,) in m; 0 where no summits
    meet."""
    for k in range(eccentricities.shape[0]):
        rows[k] = 0.0
        if meets(asperities, clearance, eccentricities[k]):
            own = touch(asperities, f, clearance, eccentricities[k])
            rows[k, 0], rows[k, 1] = own.normal, own.radial
            rows[k, 2], rows[k, 3] = own.normal_slope, own.radial_slope


# Isotropic surfaces. Flow of the pressure: 1 - DEPTH exp(-RATE x)
DEPTH, RATE = 0.90, 0.56
# Flow that a rough surface carries in addition to its mean plane: A x^B exp(-C x + D x^2) up to FAR, then falling with
# exp(-FADES x), from 1.126 exp(-5 / 4) on
A, B, C, D, FAR, FADES = 1.899, 0.98, 0.92, 0.05, 5.0, 0.25
# Stress in addition to the local gap's: A x^B exp(-C x + D x^2) up to LAST_STRESS, then none
STRESS_A, STRESS_B, STRESS_C, STRESS_D, LAST_STRESS = 11.1, 2.31, 2.38, 0.11, 7.0
SPREAD = 3.0  # largest height over the roughness, of heights with the density (35 / 32) (1 - s^2)^3, s over it
CUT = 1.0 / 300.0  # local gap over the largest height, below which surfaces touch and shear no oil
SERIES, TERMS = 3.0, 8  # gap over the largest height from which the moments of the heights serve, and their number


def shear_stress(x: Array) -> Array:
    """phi_f + Phi_fs: force that resists the sliding, over that between smooth surfaces.

    phi_f = h <1 / h_T> is of the local gaps h_T. A rough surface that slides presses oil through its narrow places: the
    stress on the smooth one is larger by Phi_fs, that on itself less, and what pushes on its flanks twice as large. So
    both feel the same force, whichever of them is rough.
    """
    z = np.asarray(x) / SPREAD
    near = np.minimum(z, SERIES)
    low = np.where(near > 1.0, near - 1.0, CUT)
    # (1 - (u - z)^2)^3 in powers of u = z + s
    a, b = 1.0 - near**2, 2.0 * near
    powers = (3.0 * a**2 * b, 3.0 * a * b**2 - 3.0 * a**2, b**3 - 6.0 * a * b, 3.0 * a - 3.0 * b**2, 3.0 * b, -1.0)
    high = 1.0 + near
    whole = a**3 * np.log(high / low)
    for k, power in enumerate(powers, start=1):
        whole = whole + power * (high**k - low**k) / k
    local = 35.0 / 32.0 * near * whole
    series, moment = np.ones_like(near), 1.0
    for k in range(1, TERMS + 1):
        moment *= (2.0 * k - 1.0) / (2.0 * k + 7.0)
        series = series + moment / np.maximum(z, SERIES) ** (2 * k)
    close = np.minimum(x, LAST_STRESS)
    moving = STRESS_A * close**STRESS_B * np.exp(-STRESS_C * close + STRESS_D * close**2)
    return np.asarray(np.where(z > SERIES, series, local) + np.where(x < LAST_STRESS, moving, 0.0))
