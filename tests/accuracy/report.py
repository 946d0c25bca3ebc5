"""Measures true against stated error and real against predicted cost, and writes docs/accuracy-measured.md.

`cd tests && python -m accuracy.report FOLDER [CASE ...]`: ladders and full runs are kept in FOLDER and taken from it
the next time. With cases named, these alone are measured, and the page is left as it is. Half an hour in all.
"""

import math
import statistics
import sys
from collections.abc import Iterator
from pathlib import Path

from accuracy.kinematic import KINEMATIC, Stated, stated
from accuracy.measured import CASES, Cost, Ladder, Rung, cost, ladder

HERE = Path(__file__).parent
PAGE = HERE.parent.parent / "docs" / "accuracy-measured.md"
BOUNDED, OVERSTATED, ABOVE_FRONT, COST_FACTOR = 0.95, 20.0, 1.5, 2.0  # the requirements
NEGLIGIBLE = 1e-9  # an error that is no error: a signal that stays zero


def main(arguments: list[str]) -> None:
    """See the module."""
    folder, names = Path(arguments[0]), arguments[1:]
    folder.mkdir(parents=True, exist_ok=True)
    for name in names or CASES:
        ladder(name, folder)
        cost(name, folder)
    if not names:
        PAGE.write_text(page(folder), encoding="utf-8")


def page(folder: Path) -> str:
    """The page, of all cases that are kept in the folder; the others are named as not measured."""
    ladders = {name: ladder(name, folder) for name in CASES if (folder / f"{name}-ladder.json").exists()}
    costs = {name: cost(name, folder) for name in CASES if (folder / f"{name}-cost.json").exists()}
    text = (HERE / "page.md").read_text(encoding="utf-8")
    tests = [row for name in KINEMATIC for row in stated(name, folder)]
    parts = {"ERRORS": "\n".join(_error_table(ladders, costs)), "SUMMARY": _summary(ladders, costs, tests)}
    for key, part in parts.items():
        text = text.replace(f"@{key}@", part)
    return text


def shares(rungs: list[Rung]) -> tuple[int, int, float]:
    """(signals whose error is bounded, signals, median of the overstatement)."""
    pairs = [(value, rung.bound(name)) for rung in rungs for name, value in rung.signals.items() if value > NEGLIGIBLE]
    bounded = sum(true <= stated for true, stated in pairs)
    return bounded, len(pairs), statistics.median(stated / true for true, stated in pairs)


def _finite(found: Ladder) -> list[Rung]:
    return [rung for rung in found.rungs if rung.theory == "finite"]


def _error_table(ladders: dict[str, Ladder], costs: dict[str, Cost]) -> Iterator[str]:
    yield (
        "| case | until, s | uncertainty | true | stated | plan: bounded, over | all: bounded, over "
        "| predicted, real CPU s |"
    )
    yield "|---" * 8 + "|"
    for name, found in ladders.items():
        plan, every = shares([found.planned]), shares(_finite(found))
        cost = costs.get(name)
        seconds = f"{cost.predicted_s:.2g}, {cost.real_s:.2g}" if cost else "not measured"
        yield (
            f"| {name} | {found.until_s:g} | {found.certain:.1e} | {found.planned.error:.1e} | "
            f"{found.planned.stated['eccentricity']:.1e} | {plan[0]}/{plan[1]}, {plan[2]:.1f} | "
            f"{every[0]}/{every[1]}, {every[2]:.1f} | {seconds} |"
        )


def _summary(ladders: dict[str, Ladder], costs: dict[str, Cost], tests: list[Stated]) -> str:
    plans = shares([found.planned for found in ladders.values()])
    every = shares([rung for found in ladders.values() for rung in _finite(found)])
    fronts = [found.above_quiet for found in ladders.values()]
    factors = [max(found.predicted_s / found.real_s, found.real_s / found.predicted_s) for found in costs.values()]
    on_front = sum(factor <= ABOVE_FRONT for factor in fronts)
    known = [row for row in tests if not math.isnan(row.true)]
    in_cost = sum(factor <= COST_FACTOR for factor in factors)

    def share(found: tuple[int, int, float]) -> str:
        return f"{found[0]} of {found[1]}, {found[0] / found[1]:.1%}"

    rows = [
        ("signals bounded, the plans' runs", f">= {BOUNDED:.0%}", share(plans)),
        ("overstated in the median, the plans' runs", f"< {OVERSTATED:g} x", f"{plans[2]:.1f} x"),
        ("signals bounded, all meshes and tolerances", "", share(every)),
        ("overstated in the median, all", "", f"{every[2]:.1f} x"),
        ("plan over the front", f"<= {ABOVE_FRONT:g}", f"{on_front} of {len(fronts)} cases, worst {max(fronts):.2f}"),
        ("forces of `frb rotation` bounded", "all", f"{sum(row.true <= row.stated for row in known)} of {len(known)}"),
        ("predicted cost", f"factor {COST_FACTOR:g}", f"{in_cost} of {len(factors)} cases, worst {max(factors):.1f}"),
    ]
    table = ["| | required | measured |", "|---|---|---|", *(f"| {a} | {b} | {c} |" for a, b, c in rows)]
    return "\n".join(table)


if __name__ == "__main__":
    main(sys.argv[1:])
