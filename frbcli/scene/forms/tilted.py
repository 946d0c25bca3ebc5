"""Films whose gap follows the tilt of their journals, on cells over the whole width."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from frbcli.case.schema import Case
from frbcli.elements.damper import DamperElement
from frbcli.errors import Fault
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.table import law_named
from frbcli.scene.channels import coupling_faults
from frbcli.scene.films import film_places
from frbcli.scene.forms.cells import CellForm, cells_of
from frbcli.scene.forms.form import SolveCounts
from frbcli.scene.gate.rule import (
    ALL,
    BEARING,
    COMPARISON,
    FILMS,
    HEAT,
    LADDER,
    RANGE,
    RUN,
    SPEED_CYCLES,
    STABILITY,
    WHIRLS,
    Faults,
    Rule,
)
from frbcli.scene.keys import bearing_key, cavitation_keys, film_keys
from frbcli.scene.planning.cell_choice import ALONG_TILTED, FAST_TILTED, cells_time
from frbcli.scene.shafts.table import shaft_of
from frbcli.scene.tilt import as_text

if TYPE_CHECKING:
    from frbcli.scene.planning.planned import Plan

HALVES = 2
KEY, ASKED = "film.tilt", "follows"
FOLLOWED, RUNS = (FILMS, HEAT, STABILITY, RANGE, BEARING, SPEED_CYCLES, WHIRLS), (RUN, COMPARISON, LADDER)
LOOPS = (RUN, SPEED_CYCLES, WHIRLS)
MOVED = (*RUNS, SPEED_CYCLES, WHIRLS)
OTHERS = tuple(each for each in ALL if each not in (*FOLLOWED, *RUNS))
WITHOUT = f'Write {KEY} = "none".'


def _analysis_faults(_: Case) -> Faults:
    problem = "is for runs, sheets under the load of a rotor, stability, modes, response, and cycles over the speed."
    yield Fault(KEY, ASKED, None, problem, 'Write film.tilt = "none" here, or call `frb runup`.')


def _machine_faults(case: Case) -> Iterator[Fault]:
    """Bodies that do not tilt, and channels whose oil does not pass between films that do."""
    if case.given_rotor is None:
        yield Fault(KEY, ASKED, None, "needs a shaft that tilts, and there is no [rotor].", WITHOUT)
    elif not shaft_of(case).tilts:
        problem = "moves in its plane: its journals do not tilt."
        yield Fault("rotor.kind", case.rotor.kind, None, problem, f'Take kind = "turbocharger". {WITHOUT}')
    problem = "passes oil between the films of a ring, which those that tilt do not follow."
    yield from coupling_faults(case, problem, f'Write channels = "pressure". {WITHOUT}')
    for damper in DamperElement.of(case):
        yield Fault(damper.key, "", None, "lets a shell move, whose own tilt is not modelled.", WITHOUT)


def film_faults(case: Case, without: str = WITHOUT) -> Iterator[Fault]:
    """Films that do not follow a tilt. without: the remedy that leaves the tilt out."""
    if case.film.theory not in ("auto", "finite"):
        problem = "has a gap that is the same along the axis."
        yield Fault("film.theory", case.film.theory, None, problem, f'Write theory = "finite". {without}')
    if case.contact.rough:
        problem = "is not modelled with films that tilt: its gap is the same along the axis."
        yield Fault("contact.model", "asperities", None, problem, f'Write contact.model = "spring". {without}')


def heat_faults(case: Case, without: str = WITHOUT) -> Iterator[Fault]:
    """Runs have the heat of films without a tilt. without: see film_faults."""
    if case.heat is not None:
        problem = "is followed by sheets, stability and response of films that tilt, and by runs of those that do not."
        yield Fault("thermal.model", "lumped", None, problem, f'Write thermal.model = "none". {without}')


def law_faults(case: Case, without: str = WITHOUT) -> Iterator[Fault]:
    """Laws that go by the eccentricity of the journal. without: see film_faults."""
    for key, name in dict(cavitation_keys(case)).items():
        if not law_named(name).keeps_oil and law_named(name).follow is not Law.follow:
            problem = "changes with the eccentricity, which in a film that tilts differs along the axis."
            yield Fault(key, name, None, problem, f"Take half-sommerfeld or reynolds. {without}")


def run_faults(case: Case, without: str = WITHOUT) -> Iterator[Fault]:
    """What a run does not follow in films that tilt. without: see film_faults."""
    recorded = [kind for kind in case.output.signals if kind != "film-thickness"]
    if recorded:
        problem = "are not recorded of films that tilt, but for film-thickness."
        yield Fault("output.signals", ", ".join(recorded), None, problem, f"Leave them out. {without}")
    if case.film.coupling == "co-simulation":
        problem = "exchanges forces, and a film that tilts has moments, too."
        yield Fault("film.coupling", "co-simulation", None, problem, 'Write coupling = "auto".')
    if case.contact.policy == "elastic":
        problem = "is made for a journal in the middle of its shell, and one that tilts touches at an end."
        yield Fault("contact.policy", "elastic", None, problem, f'Write policy = "stop". {without}')
    for place, key in zip(film_places(case), film_keys(case), strict=True):
        if getattr(place.geometry, "clearance_steps", ()) and law_named(case.cavitation(place.geometry)).keeps_oil:
            problem = "moves the oil of a film into another gap, which one that tilts does not follow."
            yield Fault(f"{key}.clearance_steps", "", None, problem, f"Take a law that keeps no oil. {without}")


def misalignment_faults(case: Case) -> Iterator[Fault]:
    """Shells so far out of line that a journal in the middle touches their ends."""
    for index, bearing in enumerate(case.bearings):
        if bearing.misalignment is not None:
            most = bearing.films[-1].clearance / (0.5 * bearing.films[-1].width)
            if math.hypot(*bearing.misalignment) >= most:
                key = f"{bearing_key(case, index)}.misalignment"
                problem = "closes the gap at the ends of the bearing around a centred journal."
                remedy = f"Write less than {1e3 * most:.3g} mrad."
                yield Fault(key, as_text(bearing.misalignment), None, problem, remedy)


@dataclass(frozen=True)
class TiltedForm(CellForm):
    """Finite volumes over the whole width, finer at the ends.

    For these ten cells of the whole width are about as exact as six of each half of a film without tilt, eight as five
    and sixteen as ten (film/cells/mesh/tilted.py).
    """

    inclines: ClassVar[bool] = True
    fine_when_static: ClassVar[bool] = False
    follows_supply: ClassVar[bool] = False
    lengths: ClassVar[tuple[int, ...]] = ALONG_TILTED
    as_exact: ClassVar[float] = 0.625
    static_cells: ClassVar[tuple[tuple[int, int], ...]] = ((96, 24), (48, 12), (64, 16))
    rules: ClassVar[tuple[Rule, ...]] = (
        Rule(_analysis_faults, OTHERS),
        Rule(_machine_faults, (*FOLLOWED, *RUNS)),
        Rule(film_faults, (*FOLLOWED, *RUNS)),
        Rule(heat_faults, MOVED, moving=True),
        Rule(law_faults, FOLLOWED),
        Rule(run_faults, LOOPS),
        Rule(misalignment_faults, (*FOLLOWED, *RUNS)),
    )

    def cells_solved(self, case: Case, plan: Plan) -> float:
        """See CellForm: of one land over the whole width, or of two next to a groove. All lands have equal numbers of
        cells, so that a groove doubles the cells of its film, even if other films have none."""
        around, along = cells_of(plan)
        lands = [HALVES if place.geometry.supply.splits else 1 for place in film_places(case)]
        return sum(lands) / len(lands) * cells_time(around, along // min(lands), FAST_TILTED)

    def mesh_of(self, plan: Plan) -> tuple[int, int]:
        """See FilmForm: as accuracy.mesh counts them."""
        around, along = self.of_half(cells_of(plan))
        return along, around

    def of_half(self, cells: tuple[int, int]) -> tuple[int, int]:
        """See CellForm: cells are counted over the whole width."""
        return cells[0], cells[1] // HALVES

    def of_whole(self, cells: tuple[int, int]) -> tuple[int, int]:
        return cells[0], HALVES * cells[1]


TILTED = TiltedForm("cells that follow the tilt", SolveCounts(1.2, 1.5, 2.3, (2.0, 1.0)), 20.0)
