"""Films in shells that are not in line, around journals that keep their direction: the tilt of the gap is given."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.forms.form import SolveCounts
from frbcli.scene.forms.tilted import (
    LOOPS,
    MOVED,
    RUNS,
    TiltedForm,
    film_faults,
    heat_faults,
    law_faults,
    misalignment_faults,
    run_faults,
)
from frbcli.scene.gate.rule import FILMS, HEAT, RANGE, SHEETS, SPEED_CYCLES, STABILITY, WHIRLS, Rule
from frbcli.scene.keys import bearing_key
from frbcli.scene.shafts.table import shaft_of
from frbcli.scene.tilt import as_text, misaligned

AT_REST = (FILMS, HEAT, STABILITY, RANGE, *SHEETS, SPEED_CYCLES, WHIRLS)
WITHOUT = "Leave bearing.misalignment out."


def _shaft_faults(case: Case) -> Iterator[Fault]:
    """Rotors whose journals tilt as well."""
    if case.given_rotor is not None and shaft_of(case).tilts:
        for key, value in misaligned(case):
            problem = "tilts the shell, and the journal of this rotor tilts as well."
            remedy = f'Write film.tilt = "follows". {WITHOUT}'
            yield Fault(key, value, None, problem, remedy)


def _ring_faults(case: Case) -> Iterator[Fault]:
    """Shells around rings, which would tilt, too."""
    for index, bearing in enumerate(case.bearings):
        if isinstance(bearing, FloatingRingBearing) and bearing.misalignment is not None:
            problem = "tilts the shell around a ring, whose own tilt is modelled in films that follow it alone."
            key = f"{bearing_key(case, index)}.misalignment"
            yield Fault(key, as_text(bearing.misalignment), None, problem, WITHOUT)


@dataclass(frozen=True)
class InclinedForm(TiltedForm):
    """The cells of films that follow a tilt, with one that is given."""

    rules: ClassVar[tuple[Rule, ...]] = (
        Rule(_shaft_faults, (*AT_REST, *RUNS)),
        Rule(_ring_faults, (*AT_REST, *RUNS)),
        Rule(lambda case: film_faults(case, WITHOUT), (*AT_REST, *RUNS)),
        Rule(lambda case: heat_faults(case, WITHOUT), MOVED, moving=True),
        Rule(lambda case: law_faults(case, WITHOUT), AT_REST),
        Rule(lambda case: run_faults(case, WITHOUT), LOOPS),
        Rule(misalignment_faults, (*AT_REST, *RUNS)),
    )


INCLINED = InclinedForm("cells with the tilt of their shells", SolveCounts(1.2, 1.5, 2.3, (2.0, 1.0)), 30.0)
