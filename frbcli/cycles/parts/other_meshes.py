"""Plans of the same machine on other meshes, for the errors of limit cycles, or why there are none."""

from __future__ import annotations

from frbcli.equilibrium.static_films import other_plans
from frbcli.scene.planning.planned import Plan

UNKNOWN = "Hopf points, folds and cycles have no errors by the mesh:"


def cycle_plans(plan: Plan) -> tuple[tuple[Plan, float], ...]:
    """Plans of other meshes, with the share of the difference to each that is the error. There are none of films that
    are made of cells, whose tables would cost more than the diagram, and of bearing models."""
    return () if plan.form.fine_when_static else other_plans(plan)


def why_no_error(plan: Plan) -> str:
    """Why cycles of a plan have no errors, a sentence; empty if they have some."""
    if plan.form.fine_when_static:
        return f"{UNKNOWN} the tables of the films are made from cells, and others would cost more than the diagram."
    return "" if plan.form.solved else f"{UNKNOWN} that of a bearing model added from Python is not known."
