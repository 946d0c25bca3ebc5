"""The stages of one step of a rotor with a film in the published two-phase form, around the compiled solve_stage."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.film.grid import Array
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.unknown import pressures_of
from frbcli.rotor.excitation import rotation
from frbcli.solve.march import ELASTIC_LIMIT
from frbcli.solve.published_equations import FilmEquations, Room, film_equations, make_room
from frbcli.solve.published_stage import solve_stage
from frbcli.solve.published_state import film_layers, unknowns_in
from frbcli.solve.stage import JOURNAL_ROWS, OMEGA, STAGE_ROWS, U, accelerate, guess, prepare, start_stage
from frbcli.solve.state import HISTORY, INVERSE_G, SOLVES, STEP_DONE, Control, RotorData, State
from frbcli.solve.tableau import Tableau

LARGEST_GUESS = 0.5  # of an unknown's change by extrapolation: further, and a step theta(p) is overshot


class Scratch(NamedTuple):
    """What the stages of a step share, see advance of march.py; thetas, rates (stages, e, 9): oil fraction and rate."""

    pick: Array
    products: Array
    loads: Array
    spread: Array
    compliance: Array
    at: Array
    film: Array
    stage_v: Array
    stage_a: Array
    past: Array
    thetas: Array
    rates: Array
    w: Array


class Parts(NamedTuple):
    """What does not change while the loop runs."""

    rotor: RotorData
    film: PublishedFilm
    equations: FilmEquations
    room: Room
    tableau: Tableau
    control: Control
    scratch: Scratch
    clearance: float
    limit: float


def make_parts(rotor: RotorData, film: PublishedFilm, tableau: Tableau, control: Control, state: State) -> Parts:
    n, stages = state.q.shape[0], tableau.times.shape[0]
    pick = np.ascontiguousarray(rotor.journals[0])
    scratch = Scratch(
        pick,
        np.zeros((3, n, n)),
        np.zeros((3, n)),
        np.zeros((n, 2)),
        np.zeros((2, 2)),
        np.zeros((STAGE_ROWS, n)),
        np.zeros((JOURNAL_ROWS, 2)),
        np.zeros((n, stages)),
        np.zeros((n, stages)),
        np.zeros((HISTORY + stages - 1, 3)),
        np.zeros((stages, *film.mesh.angle.shape)),
        np.zeros((stages, *film.mesh.angle.shape)),
        np.zeros(film.mesh.phi.size),
    )
    if state.numbers[INVERSE_G] > 0.0:
        _prepare(rotor, scratch, float(state.numbers[INVERSE_G]))
    # Under elastic contact the shell gives way; without, a journal beyond the shell is no state at all.
    limit = ELASTIC_LIMIT if control.contact_stiffness > 0.0 else 1.0
    return Parts(
        rotor,
        film,
        film_equations(film),
        make_room(film),
        tableau,
        control,
        scratch,
        float(rotor.clearances[0]),
        limit,
    )


def _prepare(rotor: RotorData, scratch: Scratch, g: float) -> None:
    prepare(rotor, scratch.pick, g, 0.0, scratch.products, scratch.loads, scratch.spread, scratch.compliance)


def solve_stages(parts: Parts, state: State, piece: int, t: float, step: float) -> bool:
    """Solve the stages of a step into the scratch arrays. Returns whether that was possible."""
    scratch, weights = parts.scratch, parts.tableau.stage
    scratch.past[:HISTORY] = state.past
    scratch.stage_v[:, 0], scratch.stage_a[:, 0] = state.v, state.a
    layers = film_layers(state)
    scratch.rates[0] = layers.rate
    first, before = unknowns_in(parts.film, layers.w), unknowns_in(parts.film, layers.w_before)
    for s in range(1, len(weights)):
        if s == 1:
            ahead = parts.tableau.times[1] * step / state.numbers[STEP_DONE]
            change = ahead * (first - before)
        else:
            change = parts.tableau.times[s] / parts.tableau.times[s - 1] * (scratch.w - first)
        scratch.w[:] = first + np.clip(change, -LARGEST_GUESS, LARGEST_GUESS)
        if not _stage(parts, state, piece, t, step, s, layers.fraction):
            return False
    return True


def _stage(parts: Parts, state: State, piece: int, t: float, step: float, s: int, fraction: Array) -> bool:
    """Solve stage s; the film's unknowns are guessed in scratch.w. Returns whether it converged."""
    rotor, scratch, numbers = parts.rotor, parts.scratch, state.numbers
    weights, g = parts.tableau.stage, parts.tableau.stage[1, 1] * step
    at, film, pick = scratch.at, scratch.film, scratch.pick
    t_s = t + parts.tableau.times[s] * step
    times, speeds, angles = rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    acceleration, speed, angle = rotation(times, speeds, angles, piece, t_s)
    if g != numbers[INVERSE_G]:
        numbers[INVERSE_G] = g
        _prepare(rotor, scratch, g)
    start_stage(weights, s, step, g, state.q, state.v, scratch.stage_v, scratch.stage_a, scratch.products,
                scratch.loads, pick, acceleration, speed, angle, False, at, film)  # fmt: skip
    guess(scratch.past, parts.tableau.guess, s, pick, state.q, rotor.clearances, g, t_s, parts.limit, film)
    film[OMEGA] = rotor.turning[0, 0, 0] * speed
    past = (fraction + step * np.tensordot(weights[s, :s], scratch.rates[:s], axes=1)) / g
    control = parts.control
    solved, _, cost = solve_stage(
        parts.equations, parts.room, scratch.compliance, parts.clearance, g, parts.limit, control.contact_eccentricity,
        control.contact_stiffness, control.tolerance, past, scratch.w, film)  # fmt: skip
    numbers[SOLVES] += cost
    if not solved:
        return False
    accelerate(s, g, 0.0, scratch.products, scratch.spread, pick, at, film, scratch.stage_v, scratch.stage_a)
    scratch.thetas[s] = parts.film.fraction(pressures(parts))
    scratch.rates[s] = scratch.thetas[s] / g - past
    scratch.past[HISTORY + s - 1] = t_s, film[U, 0], film[U, 1]
    return True


def pressures(parts: Parts) -> Array:
    """(2 a, 2 k + 1) scaled gauge pressures of the film's unknowns in the scratch."""
    pressure: Array = pressures_of(parts.equations.unknowns, parts.equations.step, parts.scratch.w)[0]
    return pressure.reshape(parts.film.mesh.phi.shape)
