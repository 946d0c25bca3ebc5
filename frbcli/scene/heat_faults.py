"""What heat cannot be modelled together with."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.coupling import APART
from frbcli.scene.forms.published import is_published


def heat_faults(case: Case) -> Iterator[Fault]:
    """The faults of a case with heat."""
    if case.heat is None:
        return
    problem = "is not modelled together with [thermal]."
    if case.film.bearing_model:
        remedy = "Write finite, short or auto: a bearing model tells neither torque nor flow."
        yield Fault("film.theory", case.film.theory, None, problem, remedy)
    if is_published(case):
        yield Fault("film.two-phase.form", "published", None, problem, 'Write form = "conservative".')
    if case.film.coupling == APART:
        yield Fault("film.coupling", APART, None, problem, "Write auto.")
