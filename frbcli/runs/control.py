"""The limits of the time loop in a run."""

from __future__ import annotations

import numpy as np

from frbcli.case.schema import Case
from frbcli.film.roughness.asperities import Asperities
from frbcli.scene.costs.course import longest_step, steps_of_a_turn
from frbcli.scene.coupling import coupling_named
from frbcli.scene.planning.planned import Plan
from frbcli.solve.stage.rough_contact import RoughContact
from frbcli.solve.state import Control

HELD_BY_SUMMITS = 1e-9  # N/m: films keep a contact gap and a run goes on as with an elastic shell, which pushes nothing


def control_of(case: Case, plan: Plan, asperities: Asperities | None = None) -> Control:
    """The limits of the time loop, from the case and its plan. asperities: of its machine, see System."""
    contact = case.contact
    stiffness = contact.stiffness if contact.policy == "elastic" and contact.stiffness is not None else 0.0
    rough: RoughContact | tuple[()] = ()
    if asperities is not None:
        stiffness, rough = HELD_BY_SUMMITS, RoughContact(asperities, np.zeros((len(asperities.radii), 2)))
    return Control(
        tolerance=plan.tolerance,
        steps_per_revolution=steps_of_a_turn(case, plan),
        longest_step=longest_step(case, plan),
        output_step=case.output.step,
        contact_eccentricity=contact.eccentricity,
        contact_stiffness=stiffness,
        linearised=coupling_named(plan.coupling).once,
        rough=rough,
    )
