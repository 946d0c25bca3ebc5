"""The same machine on films of other meshes, for the errors of limit cycles, or why there are none."""

from __future__ import annotations

from dataclasses import dataclass, replace

from frbcli.case.schema import Case
from frbcli.equilibrium.static_films import other_plans, share_of_cells
from frbcli.film.grid import Mesh
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.planned import Plan

UNKNOWN = "Hopf points, folds and cycles have no errors by the mesh:"
# Of tables made from solutions on cells: how many more of these each way; and the share of the difference to half as
# many nodes that is the error of splines, at least of second order where the edge of the cavity crosses them.
MORE, SPLINES = 4.0 / 3.0, 1.0 / 3.0


@dataclass(frozen=True)
class OtherFilms:
    """Films on another mesh. plan: of the machine with them; share: of the difference that is the error; halved:
    whether their tables have every other node alone."""

    plan: Plan
    share: float
    halved: bool = False

    def system(self, case: Case) -> System:
        """The machine of a case with these films."""
        made = make_system(case, self.plan)
        return replace(made, films=made.films.with_half_the_nodes()) if self.halved else made


def other_films(plan: Plan) -> tuple[OtherFilms, ...]:
    """Other films of a plan; none of openings that turn, whose tables would cost more than the diagram, and of bearing
    models."""
    if plan.form.table_of_solutions:
        mesh = plan.mesh
        finer = Mesh(round(MORE * mesh.axial), round(MORE * mesh.circumferential))
        share = abs(share_of_cells((finer.circumferential, finer.axial), (mesh.circumferential, mesh.axial)))
        return OtherFilms(replace(plan, mesh=finer), share), OtherFilms(plan, SPLINES, halved=True)
    if plan.form.fine_when_static:
        return ()
    return tuple(OtherFilms(*other) for other in other_plans(plan))


def why_no_error(plan: Plan) -> str:
    """Why cycles of a plan have no errors, a sentence; empty if they have some."""
    if other_films(plan):
        return ""
    if plan.form.solved:
        return f"{UNKNOWN} means over the angle of openings that turn are tabulated, and others would cost as much."
    return f"{UNKNOWN} that of a bearing model added from Python is not known."
