"""Scratch arrays of the loop, and its sense of rotation.

Arrays that the stages of a step work in, whichever loop takes them: made before the compiled loop is called.

To make them inside of it would cost seconds of compilation.

The prescribed rotation of the rotor as the time loop evaluates it, compiled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.rotor import loads as speed_profile
from frbcli.solve.stage.equations import JOURNAL_ROWS, STAGE_ROWS, STANDING, prepare
from frbcli.solve.stage.forces import prepare_cones, prepare_loads
from frbcli.solve.state import INVERSE_G, INVERSE_SPEED, RotorData


class Scratch(NamedTuple):
    """selection (m, n): see selected; products, loads, spread, compliance, elimination:
    see prepare of equations.py; at (STAGE_ROWS, n), journal (JOURNAL_ROWS, m): rows of equations.py; stage_v, stage_a
    (n, stages)."""

    selection: Array
    products: Array
    loads: Array
    spread: Array
    compliance: Array
    elimination: Array
    at: Array
    journal: Array
    stage_v: Array
    stage_a: Array


def selected(rotor: RotorData) -> Array:
    """(m, n) what Newton's method sees of the displacements of a rotor: its journals, then its ports."""
    n = rotor.mass.shape[0]
    seen = rotor.journals.reshape(-1, n)
    return np.concatenate([seen, rotor.ports.places.reshape(-1, n)]) if len(rotor.ports) else np.ascontiguousarray(seen)


def make_scratch(rotor: RotorData, numbers: Array, stages: int) -> Scratch:
    """Scratch for a rotor; its inverse is the one noted in the numbers, if any."""
    n, selection = rotor.mass.shape[0], selected(rotor)
    m = len(selection)
    scratch = Scratch(
        selection,
        np.zeros((3, n, n)),
        np.zeros((3, n)),
        np.zeros((n, m)),
        np.zeros((m, m)),
        np.zeros((2, n, 3 * n + 3 + m)),
        np.zeros((STAGE_ROWS, n)),
        np.zeros((JOURNAL_ROWS, m)),
        np.zeros((n, stages)),
        np.zeros((n, stages)),
    )
    if len(rotor.standing):
        scratch.journal[STANDING, : rotor.standing.size] = rotor.standing.ravel()
    if numbers[INVERSE_G] > 0.0:
        prepare(rotor, scratch.selection, numbers, numbers[INVERSE_G], numbers[INVERSE_SPEED], *scratch[1:6])
        prepare_loads(rotor.loads, rotor, numbers[INVERSE_G], numbers[INVERSE_SPEED])
        prepare_cones(rotor.cones, rotor, numbers[INVERSE_G], numbers[INVERSE_SPEED])
    return scratch


rotation = compiled()(speed_profile.rotation)
