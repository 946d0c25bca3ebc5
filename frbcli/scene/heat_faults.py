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
    if case.film.bearing_model:
        problem = "tells neither torque nor flow, of which the balance of [thermal] is made."
        yield Fault("film.theory", case.film.theory, None, problem, "Write finite, short or auto.")
    if is_published(case):
        problem = "creates oil, which would carry away heat that nobody has put in: no balance of [thermal]."
        yield Fault("film.two-phase.form", "published", None, problem, 'Write form = "conservative".')
    if case.film.coupling == APART:
        problem = "exchanges forces alone between rotor and films; [thermal] would follow a film that is not there yet."
        yield Fault("film.coupling", APART, None, problem, "Write auto.")
