"""Amplitudes by order: motion of a journal or a disk at a multiple of the rotor speed, exact also in a ramp."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.analysis.orders.revolutions import Tracked, track
from frbcli.analysis.signals import RunLike, located, point_of
from frbcli.analysis.spectra.spectrum import DIRECTIONS, Direction
from frbcli.arrays import Array, Complex
from frbcli.errors import input_error

REVOLUTIONS = 16  # of the window, by default: it parts orders that are a fifth from each other
FEWEST, MOST = 3, 1024
HIGHEST = 100.0  # order


@dataclass(frozen=True)
class OrderTrack:
    """The motion of a point with an order of the rotor speed, at even angles of the rotor.

    order: multiple of the rotor speed; signal: the point; revolutions: of the windows; time_s (m,), speed_Hz (m,):
    middle of each window and rotor speed there; forward, backward (m,): complex amplitudes in m of what turns with the
    rotor and against it, x + iy = forward exp(i order phi) + backward exp(-i order phi) with the rotor's angle phi.
    """

    order: float
    signal: str
    revolutions: int
    time_s: Array
    speed_Hz: Array
    forward: Complex
    backward: Complex

    def along(self, direction: Direction = "x") -> Complex:
        """Complex amplitude (m,) in m of x = Re(A exp(i order phi)), y = Re(A exp(i order phi)), or the forward one.

        direction: "x", "y" or "forward"; InputError for any other."""
        if direction not in DIRECTIONS:
            raise input_error("orders", "direction", direction, "is unknown.", f"Use one of {', '.join(DIRECTIONS)}.")
        if direction == "forward":
            return self.forward
        against = np.conj(self.backward)
        return self.forward + against if direction == "x" else -1j * (self.forward - against)

    def amplitude(self, direction: Direction = "x") -> Array:
        """Peak amplitude (m,) in m."""
        return np.asarray(np.abs(self.along(direction)))

    def phase_deg(self, direction: Direction = "x") -> Array:
        """Phase (m,) in deg to the rotor's angle, continuous."""
        return np.asarray(np.degrees(np.unwrap(np.angle(self.along(direction)))))


def order_track(run: RunLike, order: float, signal: str = "journal", revolutions: int = REVOLUTIONS) -> OrderTrack:
    """Compute the motion of a point with a multiple of the rotor speed, however fast that changes.

    Parameters
    ----------
    run : Run
        A run, which is read in pieces.
    order : float
        Multiple of the rotor speed, above 0.
    signal : str
        The point: "journal", "disk", or the name of a bearing or disk.
    revolutions : int
        Length of the windows, squares of Hann windows, which part orders that are 3/revolutions from each other.

    Returns
    -------
    OrderTrack
        Complex amplitudes in m over time and rotor speed.

    Raises
    ------
    InputError
        For an invalid order or window, a point that the run does not have, or a run that is shorter than a window.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> track = frbcli.order_track(run, 0.5)  # doctest: +SKIP
    >>> track.amplitude("x").max()  # doctest: +SKIP
    """
    return order_tracks(run, (order,), signal, revolutions)[0]


def order_tracks(
    run: RunLike, orders: Sequence[float], signal: str = "journal", revolutions: int = REVOLUTIONS
) -> tuple[OrderTrack, ...]:
    """Several orders at once, in their order; otherwise as order_track. Raises what order_track raises, and InputError
    without an order."""
    wrong = [order for order in orders if not (math.isfinite(order) and 0.0 < order <= HIGHEST)]
    if wrong or not orders:
        value = ", ".join(f"{order:g}" for order in wrong)
        raise input_error("orders", "order", value, f"is not between 0 and {HIGHEST:g}.", "Use e.g. 1 or 0.5.")
    if not FEWEST <= revolutions <= MOST or int(revolutions) != revolutions:
        limits = f"Use {FEWEST} to {MOST} whole revolutions."
        raise input_error("orders", "revolutions", f"{revolutions:g}", "is not a valid window length.", limits)
    point_of(run, signal)  # raises for none
    kind, name = located(run, signal)
    signs = [sign * order for order in orders for sign in (1.0, -1.0)]
    wanted = [Tracked(kind, name, order, int(revolutions), power=2) for order in signs]
    turns, motions = track(run, wanted)
    if len(motions[0]) == 0:
        turned = f"{turns.revolution[-1]:.3g}" if len(turns.revolution) else "no"
        problem = f"of {revolutions} revolutions is longer than the run, which makes {turned}."
        raise input_error("orders", "window", "", problem, "Resume the run, or take a shorter window.")
    inside = slice(wanted[0].half, -wanted[0].half)
    return tuple(
        OrderTrack(order, signal, int(revolutions), turns.time_s[inside], turns.speed_Hz[inside], forward, backward)
        for order, forward, backward in zip(orders, motions[::2], motions[1::2], strict=True)
    )
