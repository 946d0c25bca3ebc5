"""The expected error of a plan; the run states its own."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.scene.planning.planned import Plan

SUMMED = 10.0  # number of local errors that add up: 1 to 13 as measured (docs/accuracy.md)
REACH = 0.5  # usual eccentricity of a static equilibrium, the factor of an error of the force; cells have their own


@dataclass(frozen=True)
class ExpectedError:
    """eccentricity: of the eccentricities until a whirl grows; film_force: relative, None where it is not known:
    without films, and for cells, whose eccentricities have the known error."""

    eccentricity: float
    film_force: float | None


def expected_error(plan: Plan) -> ExpectedError:
    """From the tolerance of a step and the known error of the films of a plan."""
    form = plan.form
    reach = 1.0 if form.by_cells else REACH
    force = None if form.error_by_eccentricity or not form.solved else plan.film_error
    return ExpectedError(SUMMED * plan.tolerance + reach * plan.film_error, force)
