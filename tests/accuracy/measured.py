"""The ladder and the full run of a case, measured and kept as JSON."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from frbcli.case.reading.load import load_case
from frbcli.plot.studies import accuracy_figure
from frbcli.plot.style import save_figure
from frbcli.runs.run import runup
from frbcli.scene.cost import expected_cost
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.plan import make_plan
from frbcli.studies.accuracy import RungResult, accuracy

# How long the ladder of a case is followed, in s; None: the whole run. Finer meshes and tolerances of expensive cases
# cost up to a hundred times as much as the run itself.
CASES: dict[str, float | None] = {
    "jeffcott": None,
    "jeffcott-table-4-1": None,
    "rigid": None,
    "jeffcott-supply-2bar": 5.0,
    "soft-shaft": 3.0,
    "axial-groove": 3.0,
    "rigid-axial-groove": 1.0,
    "jeffcott-two-phase": 0.5,
    "axial-groove-two-phase": 0.5,
    "rigid-two-phase": 1.0,
    "floating-ring": 0.2,
    "floating-ring-table-7-1": 0.2,
    "turbocharger-heavy": 0.15,
    "turbocharger-car": 0.05,
}
STATED = ("eccentricity", "displacement", "ring_speed", "oil_fraction")
PICTURES = ("jeffcott", "axial-groove", "jeffcott-two-phase")
IMAGES = Path(__file__).parent.parent.parent / "docs" / "images"


@dataclass(frozen=True)
class Rung:
    """One run of a ladder. error: largest of the eccentricities; signals: largest error of each signal; stated: what
    the run says of its own error, see STATED."""

    name: str
    theory: str
    planned: bool
    cpu_s: float
    error: float
    signals: dict[str, float]
    stated: dict[str, float]

    def bound(self, signal: str) -> float:
        """What the run says of the error of a signal."""
        single = not any(name.startswith("ring") for name in self.signals)
        of_film = not signal.endswith("_m") or (single and signal.startswith("journal"))
        key = "ring_speed" if signal.endswith("_Hz") else "oil_fraction" if signal.startswith("oil_fraction") else ""
        return self.stated.get(key, self.stated["eccentricity" if of_film else "displacement"])


@dataclass(frozen=True)
class Ladder:
    """until_s: its length; certain: how far the reference is from a coarser one; above_front, above_quiet: of
    AccuracyLadder, by CPU time and by counted work."""

    until_s: float
    certain: float
    above_front: float
    above_quiet: float
    rungs: tuple[Rung, ...]

    @property
    def planned(self) -> Rung:
        """The choice of the plan."""
        return next(rung for rung in self.rungs if rung.planned)


@dataclass(frozen=True)
class Cost:
    """CPU time and film solves of a full run, and what its plan said of both; status: how the run ended, at t_end_s."""

    predicted_s: float
    predicted_solves: int
    real_s: float
    film_solves: int
    status: str
    t_end_s: float


def ladder(name: str, folder: Path) -> Ladder:
    """The ladder of a case, measured or taken from the folder."""
    kept = folder / f"{name}-ladder.json"
    if not kept.exists():
        found = accuracy(load_case(name), CASES[name])
        if name in PICTURES:
            save_figure(accuracy_figure(found), IMAGES / f"accuracy-{name}.png")
        rungs = tuple(_rung(item) for item in found.ladder)
        certain = found.reference.error.eccentricity_largest
        made = Ladder(found.until_s, certain, found.above_front(), found.above_front(quiet=True), rungs)
        kept.write_text(json.dumps(asdict(made), indent=1), encoding="utf-8")
    data: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
    return Ladder(**{**data, "rungs": tuple(Rung(**rung) for rung in data["rungs"])})


def cost(name: str, folder: Path) -> Cost:
    """The cost of the full run of a case, measured or taken from the folder."""
    kept, case = folder / f"{name}-cost.json", load_case(name)
    if not kept.exists():
        run = runup(case, folder / f"{name}.h5")
        made: dict[str, Any] = {"real_s": float(run.cost["cpu_s"]), "film_solves": int(run.cost["film_solves"])}
        made |= {"status": run.status, "t_end_s": run.t_end_s}
        kept.write_text(json.dumps(made), encoding="utf-8")
    predicted = expected_cost(case, make_plan(case), run_up_profile(case))
    return Cost(predicted.cpu_s, predicted.film_solves, **json.loads(kept.read_text(encoding="utf-8")))


def _rung(item: RungResult) -> Rung:
    stated = {name: float(value) for name in STATED if (value := item.stated[name]) is not None}
    return Rung(
        item.rung.name, item.rung.theory, item.planned, item.cpu_s, item.error.eccentricity_largest,
        dict(item.signals), stated,
    )  # fmt: skip
