"""Fixed points of a map by Newton's method in the space that it contracts slowly, and by repetition in the rest.

Let x -> M(x, p) have a derivative with few eigenvalues that are not small, which belong to the rotor; oil is exchanged
within a period. An orthonormal basis V of the states of the rotor and of what the map makes of them (a Krylov space)
holds the slow motions, and dM/dx is taken as (M V) V^T with finite differences M V. Then

    dx = r + (M V) c + (dM/dp) dp,      (1 - V^T M V) c - V^T dM/dp dp = V^T r,      r = M(x) - x,

with as many further equations for the parameters p as there are (recursive projection: Shroff and Keller, SIAM J.
Numer. Anal. 30, 1993). One evaluation of the map makes one iteration. The change of the image from one iteration to the
next shows slow motions that V misses, such as oil that stays for many periods; Broyden's update adds them to V and M V.
The eigenvalues of V^T M V are the multipliers. """

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.rotor.loads import largest_first

Map = Callable[[Array, Array], Array]  # (N,) of a state (N,) and parameters (P,)

DIFFERENCE = 5e-3  # by which states and parameters are disturbed, at most: less blurs the images by the cells
MORE = 12  # images in addition to the images of the first states
NEW = 0.01  # part of an image outside of the space from which on it counts
ITERATIONS = 40
CLOSE, NOISE = 1e-7, 1e-5  # corrections that end the iteration: always, and if they become no smaller
PATIENCE = 10  # iterations in which corrections have to become half of what they were
STRAY = 0.5  # a correction beyond which the iteration is given up


@dataclass(frozen=True)
class SlowSpace:
    """states: (N, k) V; images: (N, k) M V; by_parameters: (N, P) dM/dp."""

    states: Array
    images: Array
    by_parameters: Array

    @property
    def reduced(self) -> Array:
        """(k, k) V^T M V."""
        return np.asarray(self.states.T @ self.images)


@dataclass(frozen=True)
class Conditions:
    """Further equations: by_state (P, N) (x - x_0) + by_parameters (P, P) (p - p_0) = 0."""

    by_state: Array
    by_parameters: Array


def slow_space(mapped: Map, x: Array, p: Array, first: Array, by: float = DIFFERENCE) -> SlowSpace:
    """The space at a state x. first: (N, j) states that it begins with; by: what x and p are disturbed by."""
    states: list[Array] = []
    images: list[Array] = []
    waiting = list(first.T)
    while waiting and len(states) < first.shape[1] + MORE:
        direction = waiting.pop(0)
        length = float(np.linalg.norm(direction))
        for _ in range(2):  # once more, against round-off
            for state in states:
                direction = direction - (state @ direction) * state
        outside = float(np.linalg.norm(direction))
        if outside < NEW * max(length, 1.0):
            continue
        direction = direction / outside
        states.append(direction)
        images.append(_difference(mapped, x, p, by * direction, 0.0 * p) / by)
        waiting.append(images[-1])
    columns = [_difference(mapped, x, p, 0.0 * x, by * unit) / by for unit in np.eye(len(p))]
    by_parameters = np.transpose(columns) if columns else np.zeros((len(x), 0))
    return SlowSpace(np.transpose(states), np.transpose(images), by_parameters)


def _difference(mapped: Map, x: Array, p: Array, dx: Array, dp: Array) -> Array:
    """Half of what the map changes by between both sides of a state."""
    return 0.5 * (mapped(x + dx, p + dp) - mapped(x - dx, p - dp))


@dataclass(frozen=True)
class FixedPoint:
    """x (N,), p (P,), image (N,) of x; space: what is known of the slow motions after the iteration."""

    x: Array
    p: Array
    image: Array
    space: SlowSpace


def fixed_point(
    mapped: Map, x: Array, p: Array, space: SlowSpace, conditions: Conditions, close: float = CLOSE
) -> FixedPoint | None:
    """Near to a guess x_0, p_0; None if it does not converge. close: correction that ends the iteration. The map may
    raise Unreachable."""
    guess_x, guess_p, sizes = x, p, [np.inf]
    image = mapped(x, p)
    nearest = FixedPoint(x, p, image, space)
    for _ in range(ITERATIONS):
        dx, dp = correction(space, conditions, image - x, x - guess_x, p - guess_p)
        size = float(np.linalg.norm(dx) + np.linalg.norm(dp))
        # Corrections go to and fro while motions are learned of. Those that become no smaller are the noise of the
        # cells if the smallest is small.
        stays = len(sizes) > PATIENCE and size > 0.5 * min(sizes[:-PATIENCE])
        if size < min(sizes):
            nearest = FixedPoint(x, p, image, space)
        if size < close or (stays and min(*sizes, size) < NOISE):
            return nearest
        if size > STRAY or stays:
            return None
        x, p, before = x + dx, p + dp, image
        image = mapped(x, p)
        if float(np.linalg.norm(dx)) > NEW * size:  # else the parameters alone change the image
            space = taught(space, dx, image - before - space.by_parameters @ dp)
        sizes.append(size)
    return None


def taught(space: SlowSpace, dx: Array, change: Array) -> SlowSpace:
    """The space that knows what the image changes by along dx, with the direction of dx in it (Broyden's update)."""
    inside = space.states.T @ dx
    outside = dx - space.states @ inside
    outside = outside - space.states @ (space.states.T @ outside)  # once more, against round-off
    length = float(np.linalg.norm(dx))
    if length == 0.0:
        return space
    off = change - space.images @ inside
    states, images = space.states, space.images
    if float(np.linalg.norm(outside)) > NEW * length:
        states = np.column_stack([states, outside / np.linalg.norm(outside)])
        images = np.column_stack([images, np.zeros(len(dx))])
    return SlowSpace(states, images + np.outer(off, states.T @ dx) / length**2, space.by_parameters)


def correction(
    space: SlowSpace, conditions: Conditions, residual: Array, off_x: Array, off_p: Array
) -> tuple[Array, Array]:
    """(dx, dp) of a residual M(x) - x; off_x, off_p: how far x and p are from the guess."""
    k, parameters = space.states.shape[1], space.by_parameters.shape[1]
    matrix, right = np.zeros((k + parameters, k + parameters)), np.zeros(k + parameters)
    matrix[:k, :k] = np.eye(k) - space.reduced
    matrix[:k, k:] = -space.states.T @ space.by_parameters
    right[:k] = space.states.T @ residual
    matrix[k:, :k] = conditions.by_state @ space.images
    matrix[k:, k:] = conditions.by_state @ space.by_parameters + conditions.by_parameters
    right[k:] = -conditions.by_state @ (residual + off_x) - conditions.by_parameters @ off_p
    answer = np.linalg.solve(matrix, right)
    return residual + space.images @ answer[:k] + space.by_parameters @ answer[k:], answer[k:]


def direction_along(space: SlowSpace, held: Array, before: Array) -> Array:
    """(N + P,) unit tangent of the curve of fixed points with one parameter more than conditions, which are that it is
    across `held` (N + P,); turned along `before` (N + P,)."""
    k, parameters = space.states.shape[1], space.by_parameters.shape[1]
    size = len(space.states)
    rows = np.zeros((k + parameters, k + parameters))
    rows[:k, :k] = np.eye(k) - space.reduced
    rows[:k, k:] = -space.states.T @ space.by_parameters
    rows[k, :k] = held[:size] @ space.images
    rows[k, k:] = held[:size] @ space.by_parameters + held[size:]
    along = before[:size]
    rows[k + 1, :k] = along @ space.images
    rows[k + 1, k:] = along @ space.by_parameters + before[size:]
    answer = np.linalg.solve(rows, np.eye(k + parameters)[-1])
    tangent = np.concatenate([space.images @ answer[:k] + space.by_parameters @ answer[k:], answer[k:]])
    return np.asarray(tangent / np.linalg.norm(tangent))


def ritz(space: SlowSpace) -> tuple[Complex, Complex]:
    """(k,) eigenvalues of V^T M V by falling size, and (N, k) their states."""
    values, vectors = np.linalg.eig(space.reduced)
    order = largest_first(values)
    return values[order].astype(complex), (space.states @ vectors[:, order]).astype(complex)
