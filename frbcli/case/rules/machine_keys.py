"""Which keys of a case are numbers of the machine, and which say how it is run, computed and recorded."""

from __future__ import annotations

import re

from frbcli.case.schema import Case
from frbcli.errors import Fault

OF_THE_RUN = ("name", "title", "confirm", "speed", "motion", "start", "accuracy", "output")
TABLES = tuple(
    key for key in (field.alias or name for name, field in Case.model_fields.items()) if key not in OF_THE_RUN
)
# Keys of these tables that are no numbers of the machine: of the reduction of its rotor, of kinematic tests, of the
# course and the end of a run.
OTHERS = re.compile(
    r"rotor\.cutoff|drive\.(start|to|duration|down_duration|reaction)|.*\.ramp|.*\.clearance_steps\..*\.time|"
    r".*\.loss\.time|thermal\.hottest_film|contact\.eccentricity"
)

_NUMBERED = re.compile(r"\.\d+(?=\.|$)")


def machine_fault(key: str, option: str) -> Fault | None:
    """Why a key cannot be varied as a number of the machine; None if it is one. option: where it was given."""
    table = key.partition(".")[0].strip()
    if table in TABLES and not OTHERS.fullmatch(_NUMBERED.sub(".0", key.strip())):
        return None
    problem = "is no number of the machine: it is a setting of the run or of its computation."
    tables = ", ".join(f"[{name}]" for name in TABLES[:-1])
    remedy = f"Vary a key of {tables} or [{TABLES[-1]}], e.g. bearing.clearance; frb sweep takes any key."
    return Fault(option, key, None, problem, remedy)
