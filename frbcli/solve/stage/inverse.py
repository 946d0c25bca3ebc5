"""The inverse of the rotor behind all implicit stages of a step, see equations.py. Compiled."""

from __future__ import annotations

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.dense import solve_dense
from frbcli.solve.state import INVERSE_G, INVERSE_SPEED, RotorData

LASTS = 0.01  # relative change of the speed over which a gyroscopic rotor keeps its inverse
LAG_SWEEPS = 2  # iterations that bring the rest of the gyroscopic term below 1e-8: each gains a factor of 1000

# Products of the inverse E with the matrices and the loads.
E_DAMPING, E_STIFFNESS, E_GYROSCOPIC = range(3)
E_STATIC, E_COS, E_SIN = range(3)


@compiled(inline=True)
def outdated(numbers: Array, g: float, speed: float, gyroscopic: bool, follows_speed: bool) -> bool:
    """Whether the inverse noted in the numbers does not serve a stage with this g and speed."""
    if follows_speed:
        return bool(g != numbers[INVERSE_G] or speed != numbers[INVERSE_SPEED])
    return g != numbers[INVERSE_G] or (gyroscopic and abs(speed - numbers[INVERSE_SPEED]) > LASTS * abs(speed))


@compiled()
def add_table(rotor: RotorData, g: float, speed: float, dynamic: Array, right: Array) -> None:
    """Add what elements put on the rotor at this speed to M + g D + g^2 K, and to the columns of D and K in `right`."""
    n, last, below = rotor.mass.shape[0], rotor.table_speeds.shape[0] - 1, 0
    while below < last and rotor.table_speeds[below + 1] <= speed:
        below += 1
    above = min(below + 1, last)
    width = rotor.table_speeds[above] - rotor.table_speeds[below]
    share = max(speed - rotor.table_speeds[below], 0.0) / width if width > 0.0 else 0.0
    for i in range(n):
        for j in range(n):
            m, d = rotor.table_mass[below, i, j], rotor.table_damping[below, i, j]
            k = rotor.table_stiffness[below, i, j]
            m += share * (rotor.table_mass[above, i, j] - m)
            d += share * (rotor.table_damping[above, i, j] - d)
            k += share * (rotor.table_stiffness[above, i, j] - k)
            dynamic[i, j] += m + g * (d + g * k)
            right[i, j] += d
            right[i, n + j] += k


@compiled()
def prepare(
    rotor: RotorData, selection: Array, numbers: Array, g: float, speed: float, products: Array, loads: Array,
    spread: Array, compliance: Array, elimination: Array,
) -> None:  # fmt: skip
    """Make the inverse E for this g and speed, keep its products, and book in the numbers for what they are.

    products (3, n, n), loads (3, n): of E with the matrices and loads in the order of E_...; spread (n, m): with the
    forces on the journals; compliance (m, m): S of equations.py; elimination (2, n, 3 n + 3 + m): to work in.
    """
    n, m = rotor.mass.shape[0], selection.shape[0]
    numbers[INVERSE_G], numbers[INVERSE_SPEED] = g, speed
    # One elimination for all right-hand sides: the three matrices, the three loads, the journals.
    dynamic, right = elimination[0], elimination[1]
    for i in range(n):
        for j in range(n):
            dynamic[i, j] = rotor.mass[i, j] + g * (
                rotor.damping[i, j] + speed * rotor.gyroscopic[i, j] + g * rotor.stiffness[i, j]
            )
            right[i, j] = rotor.damping[i, j]
            right[i, n + j] = rotor.stiffness[i, j]
            right[i, 2 * n + j] = rotor.gyroscopic[i, j]
        right[i, 3 * n] = rotor.static_load[i]
        right[i, 3 * n + 1] = rotor.unbalance_cos[i]
        right[i, 3 * n + 2] = rotor.unbalance_sin[i]
        for k in range(m):
            right[i, 3 * n + 3 + k] = selection[k, i] * rotor.multiplicity[k // 2]
    if rotor.table_speeds.shape[0] > 0:
        add_table(rotor, g, speed, dynamic, right)
    solve_dense(dynamic, right)
    for i in range(n):
        for j in range(n):
            products[E_DAMPING, i, j] = right[i, j]
            products[E_STIFFNESS, i, j] = right[i, n + j]
            products[E_GYROSCOPIC, i, j] = right[i, 2 * n + j]
        for k in range(3):
            loads[k, i] = right[i, 3 * n + k]
        for k in range(m):
            spread[i, k] = right[i, 3 * n + 3 + k]
    for k in range(m):
        for j in range(m):
            total = 0.0
            for i in range(n):
                total += selection[k, i] * spread[i, j]
            compliance[k, j] = g * total
