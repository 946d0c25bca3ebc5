"""Films whose gap follows the tilt of their journals, on cells over the whole width.

Films in shells that are not in line, around journals that keep their direction: the tilt of the gap is given.

Films on finite volumes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.elements.supports import DamperElement
from frbcli.errors import Fault
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.table import law_named
from frbcli.film.grid import FINER
from frbcli.scene.films import (
    as_text,
    bearing_key,
    cavitation_keys,
    coupling_faults,
    film_keys,
    film_places,
    is_published,
    misaligned,
)
from frbcli.scene.forms import PUBLISHED, FilmForm, SolveCounts, cells_B, transport_of
from frbcli.scene.gate.rule import (
    ALL,
    BEARING,
    COMPARISON,
    FILMS,
    HEAT,
    LADDER,
    RANGE,
    RUN,
    SHEETS,
    SPEED_CYCLES,
    STABILITY,
    WHIRLS,
    Faults,
    Rule,
)
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.cell_choice import (
    ALONG,
    ALONG_TILTED,
    FAST_TILTED,
    USUAL,
    cells_time,
    coarser_cells,
    compared_states,
    worst_film,
)

if TYPE_CHECKING:
    from frbcli.scene.planning.film_choice import FilmChoice, Plan


STEADY_s, STEADY_CELLS, STEADY_POWER = 0.012, 1152, 1.1  # of a steady film, a state of its own; its cells
RESTING = 3.0  # factor for a static equilibrium, found by Newton's method
COMPILING = 36.0, 5e8  # at the first start: CPU time in s, memory in bytes
AGAIN = 0.5  # of the loop: the run on fewer cells
FIXED = 0.1  # share of a solve on USUAL cells that does not depend on the cells
# Solves of a stage of a mass-conserving film, whose cells turn with it: at least, and for every cell that passes a
# front in a step.
KEEPING_SOLVES, FRONT_SOLVES = 2.2, 0.55
# Fronts that cross cells make the local error of second order; the steps fall with the size of the cells.
FRONT_ORDER, FRONT_CELLS = 2.0, 1.0 / 3.0
GENTLE = 0.9  # x_1 of a step of theta(p) that is not steep
EXPECTED = "largest one expected, of weight and unbalance in short bearings without openings; the cells are for it"


@dataclass(frozen=True)
class CellForm(FilmForm):
    """Finite volumes, their number chosen by the target."""

    by_cells: ClassVar[bool] = True
    fine_when_static: ClassVar[bool] = True
    lengths: ClassVar[tuple[int, ...]] = ALONG  # cells along to choose from
    compiling: ClassVar[tuple[float, float]] = COMPILING

    def solve_us(self, case: Case, plan: Plan) -> float:
        size = self.cells_solved(case, plan) / cells_time(*USUAL)
        law = float(np.mean([law_named(name).cost for name in case.cavitations]))
        return self.us * (law * (FIXED + (1.0 - FIXED) * size))

    def cells_solved(self, case: Case, plan: Plan) -> float:
        """The cells of a solve as cells_time counts them, mean of all films."""
        return cells_time(*cells_of(plan))

    def first_state_s(self, plan: Plan, films: int, resting: bool) -> float:
        return films * (RESTING if resting else 1.0) * _steady_s(cells_of(plan))

    def again_share(self) -> float:
        return AGAIN

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        cells = cells_of(plan)
        fine = cells[0] * FINER, cells[1] * FINER
        return compared_states(cells) * films * (_steady_s(cells) + _steady_s(fine))

    def memory_B(self, plan: Plan, films: int) -> float:
        return cells_B(cells_of(plan), films)

    def solves_of_a_stage(self, plan: Plan, per_turn: Array, turning: bool) -> Array | None:
        if not turning:
            return None
        passed = 0.5 * cells_of(plan)[0] / np.maximum(per_turn, 1.0)
        return np.asarray(KEEPING_SOLVES + FRONT_SOLVES * passed)

    def steps_at_fronts(self, plan: Plan, fronts: float) -> float:
        coarse = USUAL[0] / cells_of(plan)[0]
        return float(fronts * plan.tolerance ** (-1.0 / FRONT_ORDER) * coarse**FRONT_CELLS)

    def fewer_cells(self, case: Case, plan: Plan) -> tuple[int, int] | None:
        cells = coarser_cells(worst_film(case, plan.eccentricity), self.of_half(cells_of(plan)))
        return None if cells is None else self.of_whole(cells)

    def of_whole(self, cells: tuple[int, int]) -> tuple[int, int]:
        """Cells (around, along) of a plan, from the cells of a section."""
        return cells

    def decisions(self, case: Case, films: FilmChoice) -> tuple[tuple[str, str, str], ...]:
        assert films.cells is not None
        around, along = films.cells
        rows = [("film", f"{around} x {along} cells", f"finite volumes, around x along; {films.mesh_why}")]
        if films.eccentricity is not None:
            rows.append(("eccentricity", f"{films.eccentricity:.2f}", EXPECTED))
        if is_published(case) and (transport := transport_of(case)) is not None:
            rows += [("form", "published", PUBLISHED), transport]
        return tuple(rows)

    def remedies(self, case: Case) -> tuple[str, ...]:
        if not is_published(case):
            return ()
        two_phase, changes = case.film.two_phase, ['film.two-phase.form = "conservative"']
        if two_phase.diffusion != "consistent":
            changes.append('film.two-phase.diffusion = "consistent"')
        if two_phase.steepness > GENTLE:
            changes.append(f"film.two-phase.steepness = {GENTLE:g} instead of {two_phase.steepness:g}")
        return tuple(changes)


def cells_of(plan: Plan) -> tuple[int, int]:
    """(around, along) of a plan that has them."""
    assert plan.cells is not None
    return plan.cells


def _steady_s(cells: tuple[int, int]) -> float:
    return STEADY_s * math.pow(cells[0] * cells[1] / STEADY_CELLS, STEADY_POWER)


CELLS = CellForm("cells", SolveCounts(1.2, 1.5, 2.3, (2.0, 1.0)), 20.0)


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
    and sixteen as ten (film/cells/mesh/grid.py).
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


AT_REST = (FILMS, HEAT, STABILITY, RANGE, *SHEETS, SPEED_CYCLES, WHIRLS)
ALIGNED = "Leave bearing.misalignment out."


def _shaft_faults(case: Case) -> Iterator[Fault]:
    """Rotors whose journals tilt as well."""
    if case.given_rotor is not None and shaft_of(case).tilts:
        for key, value in misaligned(case):
            problem = "tilts the shell, and the journal of this rotor tilts as well."
            remedy = f'Write film.tilt = "follows". {ALIGNED}'
            yield Fault(key, value, None, problem, remedy)


def _ring_faults(case: Case) -> Iterator[Fault]:
    """Shells around rings, which would tilt, too."""
    for index, bearing in enumerate(case.bearings):
        if bearing.kind == "floating-ring" and bearing.misalignment is not None:
            problem = "tilts the shell around a ring, whose own tilt is modelled in films that follow it alone."
            key = f"{bearing_key(case, index)}.misalignment"
            yield Fault(key, as_text(bearing.misalignment), None, problem, ALIGNED)


@dataclass(frozen=True)
class InclinedForm(TiltedForm):
    """The cells of films that follow a tilt, with one that is given."""

    rules: ClassVar[tuple[Rule, ...]] = (
        Rule(_shaft_faults, (*AT_REST, *RUNS)),
        Rule(_ring_faults, (*AT_REST, *RUNS)),
        Rule(lambda case: film_faults(case, ALIGNED), (*AT_REST, *RUNS)),
        Rule(lambda case: heat_faults(case, ALIGNED), MOVED, moving=True),
        Rule(lambda case: law_faults(case, ALIGNED), AT_REST),
        Rule(lambda case: run_faults(case, ALIGNED), LOOPS),
        Rule(misalignment_faults, (*AT_REST, *RUNS)),
    )


INCLINED = InclinedForm("cells with the tilt of their shells", SolveCounts(1.2, 1.5, 2.3, (2.0, 1.0)), 30.0)
