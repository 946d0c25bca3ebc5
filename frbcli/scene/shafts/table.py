"""The kinds of shafts: one row for each rotor of a case file."""

from __future__ import annotations

from typing import Any

from frbcli.case.rotor import JeffcottRotor, RigidRotor, TurbochargerRotor
from frbcli.case.schema import Case
from frbcli.scene.shafts.shaft import Shaft
from frbcli.scene.shafts.symmetric import JeffcottShaft, RigidShaft
from frbcli.scene.shafts.turbocharger import TurbochargerShaft

SHAFTS: dict[type[Any], type[Any]] = {
    RigidRotor: RigidShaft,
    JeffcottRotor: JeffcottShaft,
    TurbochargerRotor: TurbochargerShaft,
}


def shaft_of(case: Case) -> Shaft:
    """The shaft of a case. Raises InputError for a case without a rotor."""
    shaft: Shaft = SHAFTS[type(case.rotor)](case, case.rotor)
    return shaft
