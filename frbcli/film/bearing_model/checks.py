"""A bearing model is checked before anything runs: finite forces and flows everywhere, derivatives that are those."""

from __future__ import annotations

import hashlib
import itertools
import math
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from frbcli.film.bearing_model.compiled import CENTRAL, compiled_flow, compiled_model
from frbcli.film.bearing_model.film import NO_FLOW, BearingModelFilm, model_flow
from frbcli.film.bearing_model.model import BearingDimensions, BearingModel
from frbcli.film.rectangles.film_force import film_force

Pair = tuple[float, float]
State = tuple[float, float, float, float, float]
# States that are tried: displacements (eccentricity, angle in rad), velocities over the clearance and the speed.
PLACES: tuple[Pair, ...] = ((0.0, 0.0), (0.1, 2.0), (0.5, -1.2), (0.9, -0.4), (0.99, 1.0))
MOTIONS: tuple[Pair, ...] = ((0.0, 0.0), (0.2, -0.1), (-0.3, 0.5))
COMPARED = PLACES[1:4]  # where derivatives are held against differences, off the centre
WRONG = 1e-2  # of the largest derivative, by which one that a model tells may be off
NOISE = 1e-5  # of the force over the unit of a motion: what derivatives by differences cannot tell
ROUND_OFF, TINY = 1e-13, float(np.finfo(float).tiny)  # of the largest force; of a size that is divided by
SLOW = 60.0  # rad/s: size of the velocities of a journal that hardly turns


def model_film(model: BearingModel, dimensions: BearingDimensions, values: tuple[float, ...]) -> BearingModelFilm:
    """The film of a bearing; values: of the model's keys, in their order."""
    numbers = np.array((*astuple(dimensions), *values), dtype=np.float64)
    flow = NO_FLOW if model.flow is None else compiled_flow(model).address
    return BearingModelFilm(compiled_model(model).address, flow, 0, numbers)


def problem_of(model: BearingModel, film: BearingModelFilm, omega: float) -> str:
    """Fault of the forces of a bearing whose journal turns with up to omega in rad/s, or nothing."""
    for place, motion, speed in itertools.product(PLACES, MOTIONS, dict.fromkeys((0.0, omega))):
        state = _state(place, motion, speed)
        if not np.all(np.isfinite(film_force(film._replace(central=1), *state))):
            what = "force" if model.derivatives is None else "force or derivative"
            return f"has no finite {what} at {_told(film, state)}"
        if film.flow != NO_FLOW and not 0.0 <= model_flow(film, *state) < math.inf:
            return f"tells a flow of {model_flow(film, *state):.4g} m^3/s at {_told(film, state)}"
    return "" if model.derivatives is None else _wrong_derivatives(film, omega)


def fingerprint(film: BearingModelFilm, omega: float) -> str:
    """Digest of the forces and flows of a bearing, to nine digits: models of one name that differ have different
    ones."""
    states = [_state(place, motion, omega) for place, motion in itertools.product(PLACES, MOTIONS)]
    forces = np.array([film_force(film, *state)[:2] for state in states])
    sizes = np.hypot(forces[:, 0], forces[:, 1])[:, None]
    forces = np.where(sizes > ROUND_OFF * sizes.max(), np.round(forces / np.maximum(sizes, TINY), 9) + 0.0, 0.0)
    told = [*(f"{size:.8e}" for size in sizes.ravel() * (forces != 0.0).any(axis=1)), *map(str, forces.ravel())]
    if film.flow != NO_FLOW:
        told += [f"{model_flow(film, *state):.8e}" for state in states]
    return hashlib.sha256(" ".join(told).encode()).hexdigest()[:16]


def _wrong_derivatives(film: BearingModelFilm, omega: float) -> str:
    """Whether the derivatives are wrong at every state that is compared: a force that has a corner at one of them is
    not wrong."""
    told = ""
    for place, motion in zip(COMPARED, MOTIONS, strict=True):
        state = _state(place, motion, omega)
        units = np.array([[1.0], [max(abs(omega), SLOW)]])  # of displacements over the clearance, of their rates
        force = float(np.hypot(*film_force(film, *state)[:2]))
        given, expected = np.array(film_force(film, *state)[2:]).reshape(2, 4), _differences(film, state, units)
        size = np.maximum(np.max(np.abs(expected), axis=1, keepdims=True), NOISE * force / units)
        off = np.abs(given - expected) / np.maximum(size, TINY)
        if np.max(off) <= WRONG:
            return ""
        by, row = np.unravel_index(int(np.argmax(off)), off.shape)
        name, c = f"dF_{'xxyy'[row]} / d{'dv'[by]}_{'xyxy'[row]}", film.clearance
        told = f"tells {name} = {given[by, row] / c:.6g} at {_told(film, state)}, where differences of its force are "
        told += f"{expected[by, row] / c:.6g}"
    return told


def _differences(film: BearingModelFilm, state: State, units: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2, 4) derivatives by displacement and by velocity as film_force has them, xx, xy, yx, yy, by central
    differences. units: (2, 1) of the two."""
    found = np.empty((2, 4))
    for by in range(4):
        step = np.zeros(5)
        step[by] = CENTRAL * units[by // 2, 0] * (1.0 - math.hypot(*state[:2]) if by < 2 else 1.0)
        above, below = (np.array(film_force(film, *(np.array(state) + side * step))[:2]) for side in (1.0, -1.0))
        found[by // 2, by % 2 :: 2] = (above - below) / (2.0 * step[by])
    return found


def _state(place: Pair, motion: Pair, omega: float) -> State:
    """Arguments of film_force for one of PLACES and one of MOTIONS, whose velocities are those of a whirl."""
    (e, angle), rate = place, max(abs(omega), SLOW)
    return e * math.cos(angle), e * math.sin(angle), rate * motion[0], rate * motion[1], omega


def _told(film: BearingModelFilm, state: State) -> str:
    c, (d_x, d_y, v_x, v_y, omega) = film.clearance, state
    return f"d = ({c * d_x:.4g}, {c * d_y:.4g}) m, v = ({c * v_x:.4g}, {c * v_y:.4g}) m/s, omega = {omega:.4g} rad/s"
