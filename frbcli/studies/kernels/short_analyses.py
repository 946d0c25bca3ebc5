"""Analyses of a case as short as can be: they compile the kernels that the whole ones need."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from frbcli.bearing_tests import kinematic
from frbcli.case.schema import Case
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.linear.stability import stability_points
from frbcli.runs.inputs import films_change, machine_inputs
from frbcli.runs.run import runup
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import BEARING, KINEMATIC, ROTATION, RUN, STABILITY
from frbcli.scene.machine.elements import element_parts
from frbcli.scene.planning.film_choice import form_of
from frbcli.scene.planning.kinematic_plan import kinematic_plan
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.planning.planned import Decision
from frbcli.scene.shafts.table import shaft_of

MOMENT_s = 1e-3  # of a run
PERIODS = 1e-3  # of a squeeze or a whirl
# Decisions of a plan that choose the kernels
COMPILED_FOR = ("bearings", "channels", "theory", "cavitation", "coupling", "film", "integrator")
CELLS, OTHERS = "cells", "others"  # kernels of finite-volume films; all others, which are compiled apart from them


@dataclass(frozen=True)
class ShortAnalysis:
    """An analysis of a case, as short as can be. kind: what determines its kernels; family: CELLS or OTHERS."""

    case: Case
    analysis: str
    kind: tuple[object, ...]
    family: str

    def compute(self) -> None:
        """Run the analysis. Raises FrbError as the analysis does."""
        ANALYSES[self.analysis](self.case)


def short_analyses(case: Case) -> Iterator[ShortAnalysis]:
    """Short forms of all analyses that a case can be asked for, of runs, stability, sheets and kinematic tests. Raises
    InputError if the machine cannot be modelled."""
    if not case.given_bearings or (case.given_rotor is None and case.motion is None):
        return  # thrust and ball bearings alone need no kernels
    if case.motion is None or (case.given_rotor is not None and case.given_speed is not None):
        make_plan(case)  # raises the faults of a machine
    applicable = [analysis for analysis in ANALYSES if _applies(case, analysis)]
    for analysis in applicable:
        machine = analysis not in KINEMATIC
        plan = make_plan(case) if machine else kinematic_plan(case, test=analysis)
        kind = analysis, *(machine_kernels(case, plan.decisions) if machine else _film_kernels(case, plan.decisions))
        on_cells = analysis in (BEARING, *KINEMATIC) or form_of(case).by_cells
        yield ShortAnalysis(case, analysis, kind, CELLS if on_cells else OTHERS)


def machine_kernels(case: Case, decisions: Sequence[Decision]) -> tuple[object, ...]:
    """What determines the kernels of a machine in an analysis, with the decisions of its plan: two machines that agree
    in it have the same."""
    inputs = machine_inputs(case)
    return (
        *_film_kernels(case, decisions),
        bool(element_parts(case).loads) or shaft_of(case).bow > 0.0,
        inputs is not None,
        films_change(case),
        case.contact.rough,
        case.start.position,
        case.drive is not None,
    )


def _film_kernels(case: Case, decisions: Sequence[Decision]) -> tuple[object, ...]:
    """What determines the kernels of the films of a machine and of their heat."""
    chosen = tuple(made.value for made in decisions if made.choice in COMPILED_FOR)
    heat = None if case.heat is None else case.heat.side_flow
    return *chosen, form_of(case), heat, case.output.signals


def moment_of_run(case: Case) -> Case:
    """A case whose run takes a moment, at its last speed; with a drive from its first one on."""
    duration = max(MOMENT_s, 2 * case.output.step)
    if case.drive is not None:
        return case.with_settings(f"drive.duration={duration!r}", f"drive.down_duration={duration!r}")
    end = case.speed.end
    return case.with_settings({"speed": {"from": end, "to": end, "duration": duration}})


def _applies(case: Case, analysis: str) -> bool:
    if analysis in KINEMATIC:
        wanted = case.motion is not None and (case.motion.frequency is None) == (analysis == ROTATION)
        return wanted and not faults(case, analysis)
    return case.given_rotor is not None and case.given_speed is not None and not faults(case, analysis)


def _run(case: Case) -> None:
    with TemporaryDirectory(prefix="frb-warm-up-") as folder:
        runup(moment_of_run(case), Path(folder) / "moment.h5")


def _top_Hz(case: Case) -> float:
    return max(abs(case.speed.start), abs(case.speed.end))


def _kinematic(test: Callable[..., object]) -> Callable[[Case], object]:
    return lambda case: test(case.with_settings(f"motion.periods={PERIODS!r}"))


ANALYSES: dict[str, Callable[[Case], object]] = {
    RUN: _run,
    STABILITY: lambda case: stability_points(case, [_top_Hz(case)]),
    BEARING: lambda case: bearing_sheet(case, [_top_Hz(case)]),
    "rotation": kinematic.rotation,
    "squeeze": _kinematic(kinematic.squeeze),
    "whirl": _kinematic(kinematic.whirl),
}
