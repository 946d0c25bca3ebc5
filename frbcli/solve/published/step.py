"""The stages of one step of a rotor with a film in the published two-phase form, around the compiled solve_stage."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.film.grid import Array
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.unknown import pressures_of
from frbcli.rotor.excitation import rotation
from frbcli.solve.inverse import outdated, prepare
from frbcli.solve.published.equations import FilmEquations, Room, film_equations, make_room
from frbcli.solve.published.stage import solve_stage
from frbcli.solve.published.state import film_layers, unknowns_in
from frbcli.solve.scratch import make_scratch
from frbcli.solve.stage import OMEGA, U, accelerate, guess, limit_of, start_stage
from frbcli.solve.state import HISTORY, SOLVES, STEP_DONE, Control, RotorData, State
from frbcli.solve.step import begin_past, begin_stages
from frbcli.solve.tableau import Tableau

LARGEST_GUESS = 0.5  # of an unknown's change by extrapolation: further, and a step theta(p) is overshot


class Scratch(NamedTuple):
    """What the stages of a step share, see scratch.py; past as in time_loop.py; thetas, rates (stages, e, 9): oil
    fraction and rate; w (nodes,) unknowns of the film."""

    selection: Array
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
    stages, points = tableau.times.shape[0], film.mesh.angle.shape
    own = (
        np.zeros((HISTORY + stages - 1, 3)),
        np.zeros((stages, *points)),
        np.zeros((stages, *points)),
        np.zeros(film.mesh.phi.size),
    )
    scratch = Scratch(*[*make_scratch(rotor, state.numbers, stages), *own])
    return Parts(
        rotor,
        film,
        film_equations(film),
        make_room(film),
        tableau,
        control,
        scratch,
        float(rotor.clearances[0]),
        limit_of(control.contact_stiffness),
    )


def solve_stages(parts: Parts, state: State, piece: int, t: float, step: float) -> bool:
    """Solve the stages of a step into the scratch arrays. Returns whether that was possible."""
    scratch, weights = parts.scratch, parts.tableau.stage
    begin_past(state.past, scratch.past)
    begin_stages(state.v, state.a, scratch.stage_v, scratch.stage_a)
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
    at, film, selection = scratch.at, scratch.film, scratch.selection
    t_s = t + parts.tableau.times[s] * step
    times, speeds, angles = rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    acceleration, speed, angle = rotation(times, speeds, angles, piece, t_s)
    if outdated(numbers, g, 0.0, False):
        prepare(rotor, selection, numbers, g, 0.0, scratch.products, scratch.loads, scratch.spread, scratch.compliance)
    start_stage(weights, s, step, g, state.q, state.v, scratch.stage_v, scratch.stage_a, scratch.products,
                scratch.loads, selection, acceleration, speed, angle, False, at, film)  # fmt: skip
    guess(scratch.past, parts.tableau.guess, s, selection, state.q, rotor.clearances, g, t_s, parts.limit, film)
    film[OMEGA] = rotor.turning[0, 0, 0] * speed
    past = (fraction + step * np.tensordot(weights[s, :s], scratch.rates[:s], axes=1)) / g
    control = parts.control
    solved, _, cost = solve_stage(
        parts.equations, parts.room, scratch.compliance, parts.clearance, g, control.contact_eccentricity,
        control.contact_stiffness, control.tolerance, past, scratch.w, film)  # fmt: skip
    numbers[SOLVES] += cost
    if not solved:
        return False
    accelerate(s, g, 0.0, scratch.products, scratch.spread, selection, at, film, scratch.stage_v, scratch.stage_a)
    scratch.thetas[s] = parts.film.fraction(pressures(parts))
    scratch.rates[s] = scratch.thetas[s] / g - past
    scratch.past[HISTORY + s - 1] = t_s, film[U, 0], film[U, 1]
    return True


def pressures(parts: Parts) -> Array:
    """(2 a, 2 k + 1) scaled gauge pressures of the film's unknowns in the scratch."""
    pressure: Array = pressures_of(parts.equations.unknowns, parts.equations.step, parts.scratch.w)[0]
    return pressure.reshape(parts.film.mesh.phi.shape)
