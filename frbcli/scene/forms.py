"""The contract of a form of films: what gate, plans, costs, errors and static results ask of it. A form is one class:
what it is, what it costs, and in `rules` what it is not made for, with the reason.

Times are CPU seconds of the reference machine of scene/cost.py, measured on the shipped cases.

Films of gaps that are made of rectangles: closed forms, tables, fields, and chains between axial grooves. Films that
are not mass-conserving, tabulated from solutions on cells before a run, and why others are solved on cells during it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.grid import CHAIN_MODES, FINER, SAMPLES, Mesh
from frbcli.scene.films import film_places, is_plain, is_published
from frbcli.scene.gate.rule import RUN, Rule, oil_flow_signal, refusal

if TYPE_CHECKING:
    from frbcli.scene.planning.film_choice import FilmChoice, Plan


PUBLISHED = "two-phase in its published form (4.31): creates oil where it cavitates, and states how much"
DIFFUSIONS = {
    "consistent": "artificial, around and along as published (4.42): transports oil in from the edges",
    "streamline": "artificial (4.42), around only: what it transports along is none",
    "none": "no artificial diffusion: a steep step may prevent convergence",
}
MATRICES = 6  # of the axial elements of the finer mesh, held at a time
BLOCKS, CELL_B = 25, 6000  # of a film with cells: full rows of cells along held at a time, bytes of a cell


@dataclass(frozen=True)
class SolveCounts:
    """Counts of films of a form. crowded: steps over the least number of steps; quiet, whirling: film solves of a
    stage; pressed: steps and solves of a stage over the numbers in another whirl, where it presses the journal into the
    shell."""

    crowded: float
    quiet: float
    whirling: float
    pressed: tuple[float, float]


@dataclass(frozen=True)
class FilmForm:
    """A form of films. name: in words; work: see SolveCounts; us: time of a solve in us, of the usual mesh."""

    name: str
    work: SolveCounts
    us: float

    # Whether it has cells: a plan chooses their number by the target, they may turn with the oil, and the error is of
    # eccentricities.
    by_cells: ClassVar[bool] = False
    lengths: ClassVar[tuple[int, ...]] = ()  # numbers of cells along that it may choose from
    fine_when_static: ClassVar[bool] = False  # whether static results are computed on finer cells than a run
    # Cells (around, along) of its own of static results, and coarser ones for their error; empty of films of runs.
    static_cells: ClassVar[tuple[tuple[int, int], ...]] = ()
    solved: ClassVar[bool] = True  # whether there is a pressure, on a mesh whose error is known
    table_of_solutions: ClassVar[bool] = False  # whether it is tabulated from solutions on cells before a run
    inclines: ClassVar[bool] = False  # whether its gaps may have a tilt, in machines at rest
    as_exact: ClassVar[float] = 1.0  # share of its cells along that are as exact in a film whose errors are tabulated
    why: ClassVar[str] = "rectangular gap: the force turns with the line of centres"
    elements: ClassVar[str] = "quadratic elements"
    follows_supply: ClassVar[bool] = True  # whether its pressures may follow the supply's over time
    compiling: ClassVar[tuple[float, float]] = 16.0, 3.6e8  # at the first start: CPU time in s, memory in bytes
    rules: ClassVar[tuple[Rule, ...]] = ()  # what it is not made for, and why

    def __str__(self) -> str:
        """Its name."""
        return self.name

    def solve_us(self, case: Case, plan: Plan) -> float:
        """CPU time of one film solve in us, mean of all films."""
        return self.us

    def pressed(self, plan: Plan) -> tuple[float, float]:
        """Steps and solves of a stage in a whirl that presses the journal into the shell, see SolveCounts."""
        return self.work.pressed

    def table_s(self, plan: Plan) -> float:
        """CPU time in s to tabulate one film before a run."""
        return 0.0

    def first_state_s(self, plan: Plan, films: int, resting: bool) -> float:
        """CPU time in s of the first state of a run. resting: whether a static equilibrium is sought."""
        return 0.0

    def again_share(self) -> float:
        """Share of the time loop that the run on fewer cells takes."""
        return 0.0

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        """CPU time in s of the error of the forces at sampled states. machines: segments of the run with tables of
        their own."""
        return 0.0

    def memory_B(self, plan: Plan, films: int) -> float:
        """Bytes that the films take, of tables the finer ones for the error, too."""
        needed = 8.0 * MATRICES * (2.0 * FINER * plan.mesh.axial) ** 2
        rows = -math.log(1.0 - LARGEST_ECCENTRICITY) / 0.1
        return needed + 8.0 * films * rows * 32.0 * plan.mesh.circumferential

    def solves_of_a_stage(self, plan: Plan, per_turn: Array, turning: bool) -> Array | None:
        """(n,) film solves, where they do not follow from `work`. per_turn (n,): steps per revolution; turning: whether
        cells turn with the oil that a film keeps."""
        return None

    def steps_at_fronts(self, plan: Plan, fronts: float) -> float:
        """Least steps per revolution for fronts of oil that cross cells. fronts: of the laws and the rotor."""
        return 0.0

    def fewer_cells(self, case: Case, plan: Plan) -> tuple[int, int] | None:
        """Cells (around, along) that a run is repeated on for its error, None where it is not."""
        return None

    def of_half(self, cells: tuple[int, int]) -> tuple[int, int]:
        """Cells (around, along) of a section, up to a plane of symmetry, from the cells of a plan."""
        return cells

    def decisions(self, case: Case, films: FilmChoice) -> tuple[tuple[str, str, str], ...]:
        """What a plan says of the films: choice, value, reason."""
        rows = [("film", self.name, self.why)]
        if films.theory == "finite":
            meshes = [mesh for _, mesh in films.films] or [films.mesh]
            meshes = meshes[:1] if len(set(meshes)) == 1 else meshes
            sizes = ", ".join(f"{mesh.axial} x {mesh.circumferential}" for mesh in meshes)
            rows.append(("mesh", sizes, f"{self.elements}, axial x around; {films.mesh_why}"))
        return tuple(rows)

    def remedies(self, case: Case) -> tuple[str, ...]:
        """Settings that the case does not have yet with which its films are easier to solve, best first."""
        return ()

    def mesh_of(self, plan: Plan) -> tuple[int, int]:
        """Elements or cells (along, around) of a plan, as accuracy.mesh has them."""
        return (plan.mesh.axial, plan.mesh.circumferential) if plan.cells is None else (plan.cells[1], plan.cells[0])


def transport_of(case: Case) -> tuple[str, str, str] | None:
    """The decision about the transport of oil: choice, value, reason."""
    if is_published(case):
        return "diffusion", case.film.two_phase.diffusion, DIFFUSIONS[case.film.two_phase.diffusion]
    reason = "upwind flow through the faces of the cells: conserves oil, instead of an artificial diffusion"
    return ("diffusion", "upwind", reason) if law_named(case.film.cavitation).published_form else None


def cells_B(cells: tuple[int, int], films: int) -> float:
    """Bytes of films of cells or elements (around, along)."""
    around, along = cells
    return films * (8.0 * BLOCKS * around * along**2 + CELL_B * around * along)


def mean_us(forms: tuple[tuple[FilmForm, Mesh], ...], own: FilmForm, by_mesh: float) -> float:
    """Mean time of a solve of films of several forms; by_mesh: of the form `own`, per element around."""
    return float(np.mean([by_mesh * mesh.circumferential if form == own else form.us for form, mesh in forms]))


@dataclass(frozen=True)
class NoForm(FilmForm):
    """No film: nothing is tabulated, and nothing has an error."""

    solved: ClassVar[bool] = False


NO_FILM: FilmForm = NoForm("no film", SolveCounts(1.0, 1.0, 1.0, (1.0, 1.0)), 0.35)


TABLE_s, TABLE_MODES = 3.2e-5, 14  # per element around and mode along; modes that cost as much as the lines
MODES_s = 3e-9  # of the axial modes, per cube of the elements along
DIRECT_s, STATE_s = 4.5e-7, 2e-3  # of a film solved at one state, per element around and mode along, and of any
FIELD_ELEMENTS = 64  # around
# Solves of a stage over the number in another whirl, where a full film is pressed, whose journal comes to 2e-4 of the
# gap.
FULL_PRESSED = 6.0
CHAIN_ELEMENTS, CHAIN_SHARE = 144, 0.55  # 3 x 48; share of a solve that grows with the elements


@dataclass(frozen=True)
class TableForm(FilmForm):
    """lines: modes that cost as much as the evaluation of the table at its lines."""

    lines: int = 0

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

    def solve_us(self, case: Case, plan: Plan) -> float:
        """See FilmForm: 0 next to films that are cheap."""
        return mean_us(plan.films, self, self.us / FIELD_ELEMENTS)


@dataclass(frozen=True)
class ChainForm(FilmForm):
    """Films between axial grooves, solved at every call."""

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
SOLVED_EACH_CALL = (CHAINS, FIELDS)  # each call is expensive, so that fewer steps are worth it
MOST_EXPENSIVE_FIRST = (CHAINS, FIELDS, CLIPPED, TABLE, CLOSED_FORM)


SOLUTION_MESH = Mesh(axial=6, circumferential=48)  # cells
# 90 % of the forces up to an eccentricity of 0.95 have a smaller error, from interpolation and cells together.
SOLUTION_ERROR = 6e-3
TABLE_TARGET = 5e-4  # the smallest target for which splines through some thousand solutions are sufficient
TABULATING_s = 0.65  # of a table, on SOLUTION_MESH
ONE_STATE = 1e-3  # one state instead of a table of thousands
TURNING = "openings or lobes do not turn with the line of centres"


@dataclass(frozen=True)
class SolutionForm(FilmForm):
    """Tables of solutions on cells."""

    fine_when_static: ClassVar[bool] = True
    table_of_solutions: ClassVar[bool] = True
    why: ClassVar[str] = "rectangular gap, no state: the force depends on the motion alone; solved on cells before"
    elements: ClassVar[str] = "cells"
    compiling: ClassVar[tuple[float, float]] = 29.0, 4.2e8
    rules: ClassVar[tuple[Rule, ...]] = (
        refusal(
            (RUN,), "output.signals", oil_flow_signal,
            "is not known from the tables of the penalty model", 'Write film.solution = "cells".',
        ),
    )  # fmt: skip

    def table_s(self, plan: Plan) -> float:
        size = plan.mesh.circumferential / SOLUTION_MESH.circumferential
        return TABULATING_s * size * _along_factor(plan.mesh) / _along_factor(SOLUTION_MESH)

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        return SAMPLES * films * ONE_STATE * self.table_s(plan)

    def memory_B(self, plan: Plan, films: int) -> float:
        return 8.0 * BLOCKS * plan.mesh.circumferential * plan.mesh.axial**2


def _along_factor(mesh: Mesh) -> float:
    """Factor of the time of a solve by the cells along half of the axis, which are eliminated as full blocks."""
    along = max(2, (mesh.axial + 1) // 2)
    return 0.37 + 0.03 * along + 0.01065 * along**2 + 3.09e-4 * float(along) ** 3


SOLUTIONS = SolutionForm("table over eccentricity, direction and speed", SolveCounts(1.0, 1.0, 1.5, (1.0, 1.0)), 0.6)


def table_obstacle(case: Case) -> str:
    """Why films that are not all clipped cannot be tabulated; empty if they can."""
    film, oil = case.film, case.oil
    if case.contact.flow_factors:
        return "flow factors change with the gap"
    for cavitation in case.cavitations:
        if law_named(cavitation).keeps_oil:
            return f"{cavitation} is mass-conserving: the force does not depend on the motion alone"
        if not law_named(cavitation).tabulated:
            return f"{cavitation} has no such table"
    if case.heat is not None:
        return "heat needs the flow out of the films, which is not in the table"
    if film.grid == "half-speed":
        return "a half-speed grid needs cells"
    for place in film_places(case):
        if place.feed_holes is not None or not is_plain(place.geometry):
            return TURNING
        if place.geometry.ends == "free-to-air":
            return "the flow out of free ends is not in the table"
        if place.geometry.supply.over_time is not None:
            return "the pressure of the supply changes over time, and a table has one"
        gauge = place.geometry.supply.gauge(oil.ambient_pressure)
        equal = gauge == 0.0 and oil.ambient_pressure == oil.cavitation_pressure
        if film.penalty.pressure == "dimensionless" and not equal:
            return "with the dimensionless pressure, a supply or cavitation pressure would be a fourth axis"
    if film.solution == "auto" and case.accuracy.target < TABLE_TARGET:
        return f"a table is too coarse for a target below {TABLE_TARGET:g}"
    return ""


def solution_fault(case: Case, clipped: bool, tabulated: bool) -> Fault | None:
    """The fault of film.solution. clipped: whether all films are clipped; tabulated: whether clipped films can be
    tabulated."""
    if case.film.solution != "table":
        return None
    obstacle = table_obstacle(case)
    if clipped and not case.contact.flow_factors:
        obstacle = "" if tabulated else TURNING
    if not obstacle:
        return None
    return Fault("film.solution", "table", None, f"is not possible: {obstacle}.", "Choose auto or cells.")
