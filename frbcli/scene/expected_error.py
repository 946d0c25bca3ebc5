"""The error that a plan is expected to leave, before anything is run; the run itself says what came out."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.scene.bearing_models import GIVEN
from frbcli.scene.plan import Plan

SUMMED = 10.0  # local errors of a step that live on at a time: 1 to 13 where it was measured (docs/accuracy.md)
REACH = 0.5  # eccentricity at which a rotor usually rests, and by which a wrong force moves it
# The same with cells: 0.2 to 0.8 of the shipped cases, held against twice the cells, which keep half of the error.
CELL_REACH = 1.5


@dataclass(frozen=True)
class ExpectedError:
    """eccentricity: of the eccentricities until a whirl grows; film_force: relative, None for a bearing model."""

    eccentricity: float
    film_force: float | None


def expected_error(plan: Plan) -> ExpectedError:
    """From the tolerance of a step and the known error of the films of a plan."""
    reach = REACH if plan.cells is None else CELL_REACH
    force = None if plan.form == GIVEN else plan.film_error
    return ExpectedError(SUMMED * plan.tolerance + reach * plan.film_error, force)
