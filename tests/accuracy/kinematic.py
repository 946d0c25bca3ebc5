"""The stated error of journals that turn at rest against finer cells, kept as JSON."""

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.kinematic import rotation
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.errors import InputError, NotConverged

KINEMATIC = ("bearing", "bearing-axial-groove")
MODELS = ("half-sommerfeld", "reynolds", "penalty", "peeken", "elrod", "two-phase")
COARSER, FINER = 1.5, 2.0  # of the plan's cells in each direction


@dataclass(frozen=True)
class Stated:
    """Of one model in one case. true: relative error of the force; certain: reference uncertainty, the distance to one
    on coarser cells; stated: by the test itself. NaN of one that does not converge, or is no film on cells."""

    case: str
    model: str
    true: float
    certain: float
    stated: float


def stated(name: str, folder: Path) -> list[Stated]:
    """All models of a case, measured or taken from the folder."""
    kept = folder / f"{name}-kinematic.json"
    if not kept.exists():
        rows = []
        for model in MODELS:
            try:
                rows.append(Stated(name, model, *_rotation(name, model)))
            except (NotConverged, InputError):
                rows.append(Stated(name, model, math.nan, math.nan, math.nan))
        kept.write_text(json.dumps([asdict(row) for row in rows], indent=1), encoding="utf-8")
    return [Stated(**row) for row in json.loads(kept.read_text(encoding="utf-8"))]


def _rotation(name: str, model: str) -> tuple[float, float, float]:
    """Forces where the journal rests, so that finer cells are asked at the same place."""
    case = load_case(name)
    (own,) = rotation(case, [model]).results
    if own.loads is None:
        raise NotConverged(own.problem)
    if own.plan.modal:
        raise NotConverged("a series in place of cells")
    x, y = own.displacement
    text = "\n".join(line for line in case.source_text.split("\n") if not line.startswith("load"))
    settings = [f"motion.eccentricity={math.hypot(x, y)!r}", f"motion.angle={math.atan2(y, x)!r} rad"]
    forces = []
    for factor in (COARSER, FINER):
        around, along = (round(factor * count) for count in own.plan.cells)
        (fine,) = rotation(load_case_text(text, [*settings, f"accuracy.mesh=[{along}, {around}]"]), [model]).results
        assert fine.loads is not None
        forces.append(np.array(fine.loads.force))
    coarser, exact = forces
    true, certain = (_apart(force, exact) for force in (np.array(own.loads.force), coarser))
    return true, certain, own.force_error


def _apart(force: Array, exact: Array) -> float:
    return float(np.hypot(*(force - exact)) / np.hypot(*exact))
