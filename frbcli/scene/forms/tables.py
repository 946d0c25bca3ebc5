"""Films of gaps that are made of rectangles: closed forms, tables, fields, and chains between axial grooves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.table import law_named
from frbcli.film.grid import CHAIN_MODES, FINER, SAMPLES
from frbcli.scene.forms.form import FilmForm, SolveCounts, mean_us

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.scene.planning.planned import Plan

TABLE_s, TABLE_MODES = 3.2e-5, 14  # per element around and mode along; modes that cost as much as the lines
MODES_s = 3e-9  # of the axial modes, per cube of the elements along
DIRECT_s, STATE_s = 4.5e-7, 2e-3  # of a film solved at one state, per element around and mode along, and of any
SHORT_POINTS = 96, 32  # around and along, in kinematic tests
FIELD_ELEMENTS = 64  # around
# Solves of a stage over the number in another whirl, where a full film is pressed, whose journal comes to 2e-4 of the
# gap.
FULL_PRESSED = 6.0
CHAIN_ELEMENTS, CHAIN_SHARE = 144, 0.55  # 3 x 48; share of a solve that grows with the elements


@dataclass(frozen=True)
class TableForm(FilmForm):
    """lines: modes that cost as much as the evaluation of the table at its lines."""

    lines: int = 0

    any_theory: ClassVar[bool] = True

    def pressed(self, plan: Plan) -> tuple[float, float]:
        full = plan.theory == "finite" and not law_named(plan.cavitation).cavitates
        return (self.work.pressed[0], FULL_PRESSED) if full else self.work.pressed

    def table_s(self, plan: Plan) -> float:
        if plan.theory == "short":
            return 0.0
        return _modes_s(plan) + TABLE_s * plan.mesh.circumferential * (plan.mesh.axial + self.lines)

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        axial, around = FINER * plan.mesh.axial, FINER * plan.mesh.circumferential
        return MODES_s * axial**3 + SAMPLES * films * (STATE_s + DIRECT_s * axial * around)


@dataclass(frozen=True)
class FieldsForm(TableForm):
    """Fields that are clipped at every call."""

    solved_each_call: ClassVar[bool] = True

    def solve_us(self, case: Case, plan: Plan) -> float:
        """See FilmForm: 0 next to films that are cheap."""
        return mean_us(plan.films, self, self.us / FIELD_ELEMENTS)


@dataclass(frozen=True)
class ModalForm(FilmForm):
    """Modal films, of kinematic tests alone."""

    modal: ClassVar[bool] = True

    def decision_in_tests(self, case: Case, law: type[Law]) -> tuple[str, str]:
        return self.name, f"{law.name} in a rectangular gap"


@dataclass(frozen=True)
class ShortForm(FilmForm):
    """Films of the short bearing, of kinematic tests alone."""

    theory_in_tests: ClassVar[str] = "short"
    parts: ClassVar[tuple[str, str]] = "points", "around x along"

    def parts_in_tests(self, case: Case) -> tuple[tuple[int, int], str] | None:
        return SHORT_POINTS, "at which the pressure is given; the force is exact"

    def decision_in_tests(self, case: Case, law: type[Law]) -> tuple[str, str]:
        return self.name, f"{law.name} of the short bearing, set in the case"


@dataclass(frozen=True)
class ChainForm(FilmForm):
    """Films between axial grooves, solved at every call."""

    solved_each_call: ClassVar[bool] = True
    why: ClassVar[str] = "no table: the grooves do not turn with the line of centres"

    def solve_us(self, case: Case, plan: Plan) -> float:
        elements = min(plan.mesh.axial, CHAIN_MODES) * plan.mesh.circumferential
        return self.us * (1.0 - CHAIN_SHARE + CHAIN_SHARE * elements / CHAIN_ELEMENTS)

    def table_s(self, plan: Plan) -> float:
        return _modes_s(plan)

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        return machines * MODES_s * (FINER * plan.mesh.axial) ** 3 + SAMPLES * films * STATE_s


def _modes_s(plan: Plan) -> float:
    return MODES_s * plan.mesh.axial**3


CLOSED_FORM = TableForm("closed form", SolveCounts(1.0, 1.0, 1.6, (1.0, 2.0)), 0.35)
CLIPPED = TableForm("clipped exactly along z, 96 points around", SolveCounts(1.0, 1.0, 2.2, (1.2, 2.5)), 14.0)
TABLE = TableForm("table over eccentricity and direction", SolveCounts(1.0, 1.0, 1.6, (1.0, 2.0)), 0.35, TABLE_MODES)
FIELDS = FieldsForm("tabulated fields, clipped at every call", SolveCounts(1.0, 1.0, 2.2, (1.2, 2.5)), 10.5)
CHAINS = ChainForm("solved between the grooves at every call", SolveCounts(1.0, 1.0, 1.7, (3.3, 2.4)), 17.5)
MODAL = ModalForm("modal, quadratic elements", SolveCounts(1.0, 1.0, 1.0, (1.0, 1.0)), 1e3)
SHORT = ShortForm("closed form of the short bearing", SolveCounts(1.0, 1.0, 1.0, (1.0, 1.0)), 1.0)
MOST_EXPENSIVE_FIRST = (CHAINS, FIELDS, CLIPPED, TABLE, CLOSED_FORM)
