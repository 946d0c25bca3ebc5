"""The analyses that a case can be asked for, as the gate knows them."""

from __future__ import annotations

FILMS = "films"  # whatever needs the films of a case and has no rules of its own
RUN = "run"  # run-up, run-down, sweep, fit and compare
STILL = "plan of films at rest"  # has the rules of a run but those of moving films
ROTATION, SQUEEZE, WHIRL = KINEMATIC = "rotation", "squeeze", "whirl"
COMPARISON, LADDER = "comparison", "accuracy"
HEAT = "heat"
SHEETS = BEARING, LOADED, CHART = "bearing sheet", "bearing sheet under a given load", "sheet over the eccentricity"
STABILITY, RANGE = "stability", "stability over the speed range"  # and response and damped modes
CYCLES, SPEED_CYCLES, WHIRLS = "limit cycles", "limit cycles over the speed", "whirls with unbalance"

ALL = (
    FILMS, RUN, *KINEMATIC, COMPARISON, LADDER, HEAT, *SHEETS, STABILITY, RANGE, CYCLES, SPEED_CYCLES, WHIRLS
)  # fmt: skip
EVERY_CYCLE = (CYCLES, SPEED_CYCLES, WHIRLS)
