"""The stated error of kinematic tests against finer cells and shorter steps, kept as JSON."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from frbcli.case.load import load_case, load_case_text
from frbcli.errors import InputError, NotConverged
from frbcli.scene.kinematic import kinematic_plan
from frbcli.solve.film_history import film_course
from frbcli.solve.journal_path import squeeze_path, whirl_path
from frbcli.solve.kinematic import rotation

Array = NDArray[np.float64]

TESTS = {"bearing": "rotation", "bearing-axial-groove": "rotation", "squeeze": "squeeze", "whirl": "whirl"}
MODELS = ("half-sommerfeld", "reynolds", "penalty", "peeken", "elrod", "two-phase")
COARSER, FINER = 1.5, 2.0  # of the plan's cells in each direction, and steps
PERIODS = 1  # of a squeeze or a whirl: finer ones take minutes for each


@dataclass(frozen=True)
class Stated:
    """Of one model in one case. true: largest relative error of the force, of a period where there are any; certain:
    how far the reference is from one on coarser cells; stated: by the test itself; NaN of one that ends early."""

    case: str
    model: str
    true: float
    certain: float
    stated: float


def stated(name: str, folder: Path) -> list[Stated]:
    """All models of a case, measured or taken from the folder."""
    kept = folder / f"{name}-kinematic.json"
    if not kept.exists():
        measure = _rotation if TESTS[name] == "rotation" else _course
        rows = []
        for model in MODELS:
            try:
                rows.append(Stated(name, model, *measure(name, model)))
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


def _course(name: str, model: str) -> tuple[float, float, float]:
    """Largest forces of the periods."""
    case = load_case(name)
    plan = kinematic_plan(case, model, TESTS[name])
    assert case.motion is not None
    motion, make = case.motion, squeeze_path if TESTS[name] == "squeeze" else whirl_path
    assert motion.eccentricity is not None
    assert motion.frequency is not None
    path = make(motion.eccentricity, motion.frequency, 2.0 * math.pi * (motion.speed or 0.0))
    periods, peaks, error = PERIODS, [], math.nan
    for factor in (1.0, COARSER, FINER):
        around, along = (round(factor * count) for count in plan.cells)
        steps = round(factor * plan.steps)
        times = np.linspace(0.0, periods / motion.frequency, periods * steps + 1)
        course = film_course(case, replace(plan, cells=(around, along), steps=steps), path, times)
        if course.problem:
            raise NotConverged(course.problem)
        error = course.force_error if factor == 1.0 else error
        sizes = np.hypot(*course.history.force.T).reshape(periods, steps)
        peaks.append(sizes.max(axis=1))
    own, coarser, exact = peaks
    if not plan.remembers:  # the same in each period; stated is that of the largest
        own, coarser, exact = (peak[[int(np.argmax(exact))]] for peak in peaks)
    return float(np.max(np.abs(own / exact - 1.0))), float(np.max(np.abs(coarser / exact - 1.0))), error
