"""The expected error of a plan; the run states its own."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.scene.bearing_models import GIVEN
from frbcli.scene.plan import Plan

SUMMED = 10.0  # number of local errors that add up: 1 to 13 as measured (docs/accuracy.md)
REACH = 0.5  # usual eccentricity of a resting position, the factor of a relative error of the force
# The same for finite-volume films: 0.2 to 0.8 in the shipped cases, against twice the cells, with half of the error.
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
