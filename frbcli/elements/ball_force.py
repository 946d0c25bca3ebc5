"""Force and stiffness of a ball bearing from the displacement of its inner ring: plain functions, compiled in runs.

A ball between raceway grooves (Harris, Rolling Bearing Analysis, chapter 7; Jones): its centre lies `u` along the axis
and `v` outwards from the centre of the outer groove, the centre of the inner groove at

    a = A sin(alpha_0) + z,    r = A cos(alpha_0) + x cos(psi) + y sin(psi)

with the displacement (x, y, z) of the inner ring and the angle psi of the ball from the x-axis. Contacts are springs
Q = K delta^1.5 along the lines of centres; the ball also bears its centrifugal force. Friction and gyroscopic moments
are left out. The energy of contacts and balls is convex in all displacements, so that there is one equilibrium.

Hertz's contact of two elastic bodies with four principal curvatures: approach, ellipse and largest pressure.

Harris, Rolling Bearing Analysis, chapter 6: with the ellipticity kappa = a / b, complete elliptic integrals K and E of
the parameter m = 1 - 1 / kappa^2, the sum S of the curvatures and 1 / E* = sum of (1 - nu^2) / E,

    F = ((kappa^2 + 1) E - 2 K) / ((kappa^2 - 1) E)          the difference of the curvatures over S
    a = (2 kappa^2 E / pi)^(1/3) L,  b = a / kappa,  L = (3 Q / (2 S E*))^(1/3)
    delta = (2 K / pi) (pi / (2 kappa^2 E))^(1/3) S L^2 / 2
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from frbcli.arrays import Array
from frbcli.materials import Elastic

NEARLY_ROUND = 1e-4  # difference of the curvatures below which F is 3/4 ln kappa but for its third power


@dataclass(frozen=True)
class HertzContact:
    """A contact without its load. curvature: sum S of the principal curvatures, 1/m; modulus: E* in Pa; ellipticity:
    long over short axis; first, second: the complete elliptic integrals K and E."""

    curvature: float
    modulus: float
    ellipticity: float
    first: float
    second: float

    @property
    def stiffness(self) -> float:
        """K in N/m^1.5 of the load Q = K delta^1.5."""
        kappa, s = self.ellipticity, self.curvature
        approach = 2.0 * self.first / math.pi * (math.pi / (2.0 * kappa**2 * self.second)) ** (1.0 / 3.0)
        return float(2.0 * self.modulus * s / 3.0 * (2.0 / (s * approach)) ** 1.5)

    def axes(self, load: float) -> tuple[float, float]:
        """Long and short half axis in m of the ellipse under a load in N."""
        size = (1.5 * load / (self.curvature * self.modulus)) ** (1.0 / 3.0)
        long = (2.0 * self.ellipticity**2 * self.second / math.pi) ** (1.0 / 3.0) * size
        return long, long / self.ellipticity

    def pressure(self, load: float) -> float:
        """Largest pressure in Pa under a load in N."""
        if load <= 0.0:
            return 0.0
        long, short = self.axes(load)
        return 1.5 * load / (math.pi * long * short)


def contact(one: Elastic, other: Elastic, rolling: float, across: float) -> HertzContact:
    """The contact of two bodies; rolling, across: sums of both bodies' curvatures in 1/m along two directions at right
    angles, concave ones negative. Raises ValueError if a body does not touch the other in a point."""
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipkm1

    low, high = sorted((rolling, across))
    if low <= 0.0:
        raise ValueError(f"curvatures of {low:.4g} 1/m along a contact: the bodies are not apart next to it")
    total, difference = rolling + across, (high - low) / (rolling + across)

    def integrals(kappa: float) -> tuple[float, float]:
        return float(ellipkm1(1.0 / kappa**2)), float(ellipe(1.0 - 1.0 / kappa**2))

    def missed(log_kappa: float) -> float:
        kappa = math.exp(log_kappa)
        first, second = integrals(kappa)
        return float(((kappa**2 + 1.0) * second - 2.0 * first) / ((kappa**2 - 1.0) * second) - difference)

    log_kappa = 4.0 / 3.0 * difference
    if difference > NEARLY_ROUND:  # kappa is below the ratio of the curvatures
        log_kappa = float(brentq(missed, 0.5 * difference, math.log(high / low), xtol=1e-15))
    kappa = math.exp(log_kappa)
    modulus = 1.0 / (one.compliance + other.compliance)
    return HertzContact(total, modulus, kappa, *integrals(kappa))


# Imbalance over the forces from which on one more step leaves the round-off alone, for its error is squared: of a ball,
# and of the rings along the axis
NEAR, NEAR_ALONG = 1e-7, 1e-6
STEPS = 60  # at most, with those that are halved or bisected: mostly three, for balls ten
ROPE = 3  # steps to a place near which a ball rests
SMALLEST = 1e-9  # share of a step below which it is no longer halved
REACH = 1e-5  # m, the longest first step along the axis; each further one may be twice as long
KNOWN = 8  # numbers for each ball, see ball
RINGS = 5  # numbers before them: the displacement z, x, y of the last call, and the derivatives of z by x and y
BELOW = -0.5 * math.pi  # where the first ball stands at the cage angle 0: in the line of the weight


class BallNumbers(NamedTuple):
    """What a ball bearing is to the kernels, SI units.

    points: places of balls around; share: balls of all rows for each place; axial, radial: distances A sin(alpha_0) and
    A cos(alpha_0) of the groove centres without load; inner, outer: distances of the centre of a ball from the groove
    centres where it touches; k_inner, k_outer: of the contacts, N/m^1.5; centrifugal: force of a ball over the square
    of the speed of the shaft, N s^2; held: 1 if the rings are held along the axis, else 0; preload: on all rows in N,
    or, of rings that are held, their axial displacement; cage: its speed over the shaft's, 0 for the mean over its
    angle; thrust: what an axial load adds to the preload, over the square of the speed of the shaft, N s^2; split: of
    the deflection of both contacts in series, the share of the inner one; turn_cos, turn_sin: of the angle between
    places; load_friction, viscous_friction, least_friction: of ball_friction, in m, N m s^(2/3) and N m."""

    points: int
    share: float
    axial: float
    radial: float
    inner: float
    outer: float
    k_inner: float
    k_outer: float
    centrifugal: float
    held: float
    preload: float
    cage: float
    thrust: float
    split: float
    turn_cos: float
    turn_sin: float
    load_friction: float
    viscous_friction: float
    least_friction: float
    rows: int
    load: float


def ball_numbers(numbers: Array) -> BallNumbers:
    """The bearing whose numbers (21,) are in an array."""
    return BallNumbers(
        int(numbers[0]), numbers[1], numbers[2], numbers[3], numbers[4], numbers[5], numbers[6], numbers[7], numbers[8],
        numbers[9], numbers[10], numbers[11], numbers[12], numbers[13], numbers[14], numbers[15],
        numbers[16], numbers[17], numbers[18], int(numbers[19]), numbers[20],
    )  # fmt: skip


def of_balls(of: BallNumbers, omega: float) -> tuple[float, float]:
    """What all balls have alike at omega rad/s: the centrifugal force in N, and how far off the outer groove's centre a
    ball rests on the outer ring alone, m."""
    centrifugal = of.centrifugal * omega * omega
    return centrifugal, of.outer + (centrifugal / of.k_outer) ** (2.0 / 3.0)


def ball(
    of: BallNumbers, a: float, r: float, centrifugal: float, rest: float, memory: Array, at: int
) -> tuple[float, float, float, float, float]:
    """A ball at rest between the centres of the outer groove, (0, 0), and of the inner one, (a, r), in m.

    centrifugal, rest: see of_balls. memory: from place `at` on a, r, u, v of a ball at rest near by, and the
    derivatives of u and v by a and r, u_a, u_r, v_a, v_r; zeros if not known. The values of this ball are left there.

    Returns the force (a, r) in N of the inner ring on the ball, and its derivative (aa, ar, rr) by its groove's place.

    Newton's method on the balance of forces; steps that do not help are halved. The last one acts by derivatives.
    """
    inner, outer, k_inner, k_outer = of.inner, of.outer, of.k_inner, of.k_outer
    length = math.sqrt(a * a + r * r)
    if centrifugal <= 0.0 and length <= inner + outer:  # between both rings, where it touches neither
        return _alone(a, r, a * outer / (inner + outer), r * outer / (inner + outer), memory, at)
    if centrifugal > 0.0 and a * a + (r - rest) * (r - rest) <= inner * inner:  # on the outer ring alone
        return _alone(a, r, 0.0, rest, memory, at)
    by_a, by_r = a - memory[at], r - memory[at + 1]
    u = memory[at + 2] + memory[at + 4] * by_a + memory[at + 5] * by_r
    v = memory[at + 3] + memory[at + 6] * by_a + memory[at + 7] * by_r
    outside = u * u + v * v > outer * outer
    if not outside:
        u, v = _near(of, a, r, length, centrifugal)
    step_u = step_v = f_a = f_r = s_aa = s_ar = s_rr = h_uu = h_uv = h_vv = inverse = 0.0
    least, size = math.inf, 1.0
    for _ in range(STEPS):
        t_u, t_v = u + step_u, v + step_v
        i_a, i_r = a - t_u, r - t_v
        l_i, l_o = math.sqrt(i_a * i_a + i_r * i_r), math.sqrt(t_u * t_u + t_v * t_v)
        d_i, d_o = max(l_i - inner, 0.0), max(l_o - outer, 0.0)
        root_i, root_o = k_inner * math.sqrt(d_i), k_outer * math.sqrt(d_o)
        q_i, q_o = root_i * d_i, root_o * d_o
        by_i, by_o = 1.0 / l_i, 1.0 / l_o
        m_a, m_r, n_a, n_r = i_a * by_i, i_r * by_i, t_u * by_o, t_v * by_o
        g_u, g_v = q_o * n_a - q_i * m_a, q_o * n_r - q_i * m_r - centrifugal
        missed = g_u * g_u + g_v * g_v
        if (missed >= least or d_i + d_o <= 0.0) and size > SMALLEST:
            size, step_u, step_v = 0.5 * size, 0.5 * step_u, 0.5 * step_v
            if outside:  # what is known does not help
                u, v = _near(of, a, r, length, centrifugal)
                outside, least, size, step_u, step_v = False, math.inf, 1.0, 0.0, 0.0
            continue
        u, v, least, size, f_a, f_r = t_u, t_v, missed, 1.0, q_i * m_a, q_i * m_r
        along, across = 1.5 * root_i, q_i * by_i
        s_aa = along * m_a * m_a + across * m_r * m_r
        s_ar = (along - across) * m_a * m_r
        s_rr = along * m_r * m_r + across * m_a * m_a
        along, across = 1.5 * root_o, q_o * by_o
        h_uu = s_aa + along * n_a * n_a + across * n_r * n_r
        h_uv = s_ar + (along - across) * n_a * n_r
        h_vv = s_rr + along * n_r * n_r + across * n_a * n_a
        determinant = h_uu * h_vv - h_uv * h_uv
        if determinant <= 0.0:
            return _alone(a, r, 0.0, rest, memory, at)
        inverse = 1.0 / determinant
        step_u = -(h_vv * g_u - h_uv * g_v) * inverse
        step_v = -(h_uu * g_v - h_uv * g_u) * inverse
        near = NEAR * (q_i + q_o + centrifugal)
        if missed <= near * near:
            break
    # the derivative with the ball eliminated: S - S H^-1 S
    u_a, v_a = (h_vv * s_aa - h_uv * s_ar) * inverse, (h_uu * s_ar - h_uv * s_aa) * inverse
    u_r, v_r = (h_vv * s_ar - h_uv * s_rr) * inverse, (h_uu * s_rr - h_uv * s_ar) * inverse
    memory[at], memory[at + 1], memory[at + 2], memory[at + 3] = a, r, u + step_u, v + step_v
    memory[at + 4], memory[at + 5], memory[at + 6], memory[at + 7] = u_a, u_r, v_a, v_r
    return (
        f_a - s_aa * step_u - s_ar * step_v, f_r - s_ar * step_u - s_rr * step_v,
        s_aa - s_aa * u_a - s_ar * v_a, s_ar - s_aa * u_r - s_ar * v_r, s_rr - s_ar * u_r - s_rr * v_r,
    )  # fmt: skip


def _alone(a: float, r: float, u: float, v: float, memory: Array, at: int) -> tuple[float, float, float, float, float]:
    """A ball at u, v without force on the inner ring. See ball."""
    for i in range(KNOWN):
        memory[at + i] = 0.0
    memory[at], memory[at + 1], memory[at + 2], memory[at + 3] = a, r, u, v
    return 0.0, 0.0, 0.0, 0.0, 0.0


def _near(of: BallNumbers, a: float, r: float, length: float, centrifugal: float) -> tuple[float, float]:
    """u, v in m of a ball near its equilibrium, which it touches with both contacts. length: from (0, 0) to (a, r).

    The contacts pull like a rope between the groove centres that the ball pushes aside by w: it is longer by
    excess + bend w^2 / 2, and bears the part of the centrifugal force across it. Newton's method from above, where it
    descends to w. The ball then lies at the distances from both centres that belong to its contacts' forces.
    """
    inner, outer, k_inner, k_outer = of.inner, of.outer, of.k_inner, of.k_outer
    excess, bend = length - inner - outer, 1.0 / inner + 1.0 / outer
    both, across, w = k_inner * of.split * math.sqrt(of.split), centrifugal * abs(a) / length, 0.0
    if across > 0.0:
        w = math.sqrt(math.sqrt(across / (both * bend * 0.5 * bend * math.sqrt(0.5 * bend))))
        if excess > 0.0:
            w = min(w, across / (both * bend * excess * math.sqrt(excess)))
        else:
            w = math.sqrt(w * w - 2.0 * excess / bend)
        for _ in range(ROPE):
            longer = max(excess + 0.5 * bend * w * w, 0.0)
            root = both * bend * math.sqrt(longer)
            w -= (root * longer * w - across) / (root * (longer + 1.5 * bend * w * w))
    longer = max(excess + 0.5 * bend * w * w, 0.0)
    pressed = both * longer * math.sqrt(longer) + centrifugal * max(r, 0.0) / length
    l_o, l_i = outer + (pressed / k_outer) ** (2.0 / 3.0), inner + of.split * longer
    if l_o + l_i <= length:
        return l_o * a / length, l_o * r / length
    along = 0.5 * (l_o * l_o - l_i * l_i + length * length) / length
    aside = math.copysign(math.sqrt(max(l_o * l_o - along * along, 0.0)), a)
    return (along * a - aside * r) / length, (along * r + aside * a) / length


Sums = tuple[float, float, float, float, float, float, float, float, float]


def rings(of: BallNumbers, d_x: float, d_y: float, d_z: float, omega: float, cage: float, memory: Array) -> Sums:
    """All balls: the force (x, y, z) in N that holds the inner ring at a displacement in m, and its
    derivative (xx, xy, yy, xz, yz, zz) in N/m.

    omega: of the shaft, rad/s; cage: its angle, rad. memory: see ball_bearing_force.
    """
    centrifugal, rest = of_balls(of, omega)
    c, s = math.cos(BELOW + cage), math.sin(BELOW + cage)
    if of.rows > 1:
        return _pair(of, d_x, d_y, d_z, c, s, centrifugal, rest, memory)[0]
    return _around(of, d_x, d_y, d_z, c, s, centrifugal, rest, memory, RINGS)


def _around(
    of: BallNumbers, d_x: float, d_y: float, d_z: float, c: float, s: float, centrifugal: float, rest: float,
    memory: Array, first: int,
) -> Sums:  # fmt: skip
    """See rings; c, s: cosine and sine of the angle of the first ball, at the place `first` of the memory; centrifugal,
    rest: see of_balls."""
    a, turn_c, turn_s = of.axial + d_z, of.turn_cos, of.turn_sin
    f_x = f_y = f_z = k_xx = k_xy = k_yy = k_xz = k_yz = k_zz = 0.0
    for j in range(of.points):
        r, at = of.radial + d_x * c + d_y * s, first + KNOWN * j
        q_a, q_r, aa, ar, rr = ball(of, a, r, centrifugal, rest, memory, at)
        f_x, f_y, f_z = f_x + q_r * c, f_y + q_r * s, f_z + q_a
        k_xx, k_xy, k_yy = k_xx + rr * c * c, k_xy + rr * c * s, k_yy + rr * s * s
        k_xz, k_yz, k_zz = k_xz + ar * c, k_yz + ar * s, k_zz + aa
        c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
    n = of.share
    return n * f_x, n * f_y, n * f_z, n * k_xx, n * k_xy, n * k_yy, n * k_xz, n * k_yz, n * k_zz


def _pair(
    of: BallNumbers, d_x: float, d_y: float, d_z: float, c: float, s: float, centrifugal: float, rest: float,
    memory: Array,
) -> tuple[Sums, float]:  # fmt: skip
    """See _around, of both rows of a pair, whose second one moves away by d_z; and the sum of their axial forces."""
    second = RINGS + KNOWN * of.points
    a = _around(of, d_x, d_y, of.preload + d_z, c, s, centrifugal, rest, memory, RINGS)
    b = _around(of, d_x, d_y, of.preload - d_z, c, s, centrifugal, rest, memory, second)
    forces = a[0] + b[0], a[1] + b[1], a[2] - b[2]
    slopes = a[3] + b[3], a[4] + b[4], a[5] + b[5], a[6] - b[6], a[7] - b[7], a[8] + b[8]
    return forces + slopes, a[2] + b[2]


def ball_bearing_force(
    of: BallNumbers, d_x: float, d_y: float, omega: float, cage: float, memory: Array
) -> tuple[float, float, float, float, float, float]:
    """Force (x, y) in N on the inner ring at its displacement in m, and -dF/dd (xx, xy, yx, yy) in N/m,
    both with the axial displacement at which the preload is balanced, or the axial load of a pair.

    omega: of the shaft, rad/s; cage: its angle in rad, by which the first ball stands off the -y axis. memory:
    (RINGS + KNOWN rows points,) what the last call left, zeros at first: the displacement of the ring, and what is
    known of each ball. The result does not depend on it.

    The axial force rises with the axial displacement: Newton's method, or half of the interval that holds the answer
    where its step leaves it or the imbalance has not been halved.
    """
    if of.held:
        f_x, f_y, _, xx, xy, yy, _, _, _ = rings(of, d_x, d_y, of.preload, omega, cage, memory)
        return -f_x, -f_y, xx, xy, xy, yy
    d_z = memory[0] + memory[3] * (d_x - memory[1]) + memory[4] * (d_y - memory[2])
    low, high, last, reach = -math.inf, math.inf, math.inf, REACH
    carried = (of.load if of.rows > 1 else of.preload) + of.thrust * omega * omega
    (centrifugal, rest), c, s, size = of_balls(of, omega), math.cos(BELOW + cage), math.sin(BELOW + cage), abs(carried)
    for _ in range(STEPS):
        if of.rows > 1:
            sums, size = _pair(of, d_x, d_y, d_z, c, s, centrifugal, rest, memory)
        else:
            sums = _around(of, d_x, d_y, d_z, c, s, centrifugal, rest, memory, RINGS)
        f_x, f_y, f_z, xx, xy, yy, xz, yz, zz = sums
        missed = f_z - carried
        step = reach if missed < 0.0 else -reach
        if zz > 0.0 and abs(missed) < zz * reach:
            step = -missed / zz
        if abs(missed) <= NEAR_ALONG * size:
            break
        if missed < 0.0:
            low = d_z
        else:
            high = d_z
        if math.isfinite(high - low) and (abs(missed) > 0.5 * last or not low < d_z + step < high):
            step = 0.5 * (low + high) - d_z
        d_z, last, reach = d_z + step, abs(missed), 2.0 * reach
    x, y = (xz / zz, yz / zz) if zz > 0.0 else (0.0, 0.0)
    memory[0], memory[1], memory[2], memory[3], memory[4] = d_z + step, d_x, d_y, -x, -y
    return -f_x - xz * step, -f_y - yz * step, xx - x * xz, xy - x * yz, xy - x * yz, yy - y * yz


def ball_friction(of: BallNumbers, omega: float, memory: Array) -> tuple[float, float]:
    """Torque in N m on the shaft at omega rad/s with the balls that the last call has left in the memory, and by how
    much it falls with the speed.

    Palmgren (Harris, chapter 14): M_1 = f_1 D F with the sum F of the loads of the balls at the inner ring, and of the
    lubricant M_0 = 0.1 f_0 D^3 (nu n)^(2/3), SI but for nu in mm^2/s and n in rpm, at least 16 f_0 D^3. A rotor of free
    speed turns forwards: as a constant load, they brake it until it stands.
    """
    loads, viscous, speed = 0.0, of.least_friction, abs(omega)
    for j in range(of.rows * of.points):
        at = RINGS + KNOWN * j
        along, out = memory[at] - memory[at + 2], memory[at + 1] - memory[at + 3]
        depth = max(math.sqrt(along * along + out * out) - of.inner, 0.0)
        loads += of.k_inner * depth * math.sqrt(depth)
    turning = of.viscous_friction * speed ** (2.0 / 3.0)
    grip = 0.0
    if turning > viscous:
        viscous, grip = turning, 2.0 / 3.0 * turning / speed
    return -(viscous + of.load_friction * of.share * loads), grip
