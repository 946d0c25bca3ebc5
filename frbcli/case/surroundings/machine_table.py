"""Tables of a case for what surrounds its rotor, each with the rules that tie it to the rest of the machine."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

from frbcli.case.model import Model
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach

if TYPE_CHECKING:
    from frbcli.case.schema import Case


class MachineTable(Model):
    """A table of a case, or one of several with the same key, that has no effect without a rotor."""

    alone: ClassVar[bool] = False  # a single one has no number in its key

    @abstractmethod
    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        """Every rule that it breaks in a case with a rotor. path: its key in the case file, with its number."""


def machine_breaches(case: Case) -> Iterator[Breach]:
    """Every rule that tables of this kind break in a case."""
    for name, field in type(case).model_fields.items():
        given, key = getattr(case, name), field.alias or name
        for number, table in enumerate(given if isinstance(given, tuple) else (given,)):
            if isinstance(table, MachineTable):
                single = table is given or (table.alone and len(given) == 1)
                path: Path = (key,) if single else (key, number)
                if case.given_rotor is None:
                    yield Breach(path, "has no effect: a kinematic test moves its journal.", "Remove it.")
                else:
                    yield from table.breaches(case, path)
