"""The limits of the time loop in a run."""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.scene.costs.course import longest_step, steps_of_a_turn
from frbcli.scene.coupling import coupling_named
from frbcli.scene.planning.planned import Plan
from frbcli.solve.state import Control


def control_of(case: Case, plan: Plan) -> Control:
    """The limits of the time loop, from the case and its plan."""
    contact = case.contact
    stiffness = contact.stiffness if contact.policy == "elastic" and contact.stiffness is not None else 0.0
    return Control(
        tolerance=plan.tolerance,
        steps_per_revolution=steps_of_a_turn(case, plan),
        longest_step=longest_step(case, plan),
        output_step=case.output.step,
        contact_eccentricity=contact.eccentricity,
        contact_stiffness=stiffness,
        linearised=coupling_named(plan.coupling).once,
    )
