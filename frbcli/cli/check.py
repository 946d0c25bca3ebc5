"""`frb check`: is the case sound, and what will be modelled for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options

if TYPE_CHECKING:
    from frbcli.case.schema import Case


@click.command()
@case_argument
@output_options
def command(case: Case, terminal: Terminal) -> None:
    """Validate CASE; show its SI values and the plan: what will be modelled, what is left out, and why."""
    from frbcli.case.listing import values
    from frbcli.scene.kinematic import kinematic_plan
    from frbcli.scene.plan import make_plan

    listed = values(case)
    rows = [(value.key, _in_si(value.value, value.unit), value.shown if value.unit else "") for value in listed]
    terminal.table(f"{case.name}: {case.title}".rstrip(": "), ("key", "SI", "reads"), rows)
    kinematic = case.motion is not None and (case.given_rotor is None or case.given_speed is None)
    test = "squeeze" if case.motion is not None and case.motion.frequency else "rotation"
    # after the values, which help to see why a plan is refused
    plan = kinematic_plan(case, test=test) if kinematic else make_plan(case)
    terminal.table("plan", ("choice", "value", "reason"), [(d.choice, d.value, d.reason) for d in plan.decisions])
    terminal.emit(
        {
            "command": "check",
            "case": case.name,
            "title": case.title,
            "status": "ok",
            "values": [{"key": value.key, "value": value.value, "unit": value.unit} for value in listed],
            "plan": [{"choice": d.choice, "value": d.value, "reason": d.reason} for d in plan.decisions],
        }
    )


def _in_si(value: float | int | str, unit: str) -> str:
    number = f"{value:.6g}" if isinstance(value, float) else str(value)
    return f"{number} {unit}".rstrip()
