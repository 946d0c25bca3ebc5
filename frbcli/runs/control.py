"""What the time loop may do in a run."""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.scene.plan import Plan
from frbcli.solve.state import Control

LONGEST_STEP = 1e-3  # s; a slow rotor still falls, and its shaft still vibrates


def control_of(case: Case, plan: Plan) -> Control:
    """What the case and its plan allow the time loop to do."""
    contact = case.contact
    stiffness = contact.stiffness if contact.policy == "elastic" and contact.stiffness is not None else 0.0
    return Control(
        tolerance=plan.tolerance,
        steps_per_revolution=plan.steps_per_revolution,
        longest_step=LONGEST_STEP if plan.macro_step is None else min(LONGEST_STEP, plan.macro_step),
        output_step=case.output.step,
        contact_eccentricity=contact.eccentricity,
        contact_stiffness=stiffness,
        linearised=plan.coupling == "dynamic-static-semi-implicit",
    )
