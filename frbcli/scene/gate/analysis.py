"""The analyses that a case can be asked for, as the gate knows them."""

from __future__ import annotations

FILMS = "films"  # whatever needs the films of a case and has no rules of its own
RUN = "run"  # run-up, run-down, sweep, fit and compare
ROTATION, SQUEEZE, WHIRL = KINEMATIC = "rotation", "squeeze", "whirl"
BEARING = "bearing sheet"
STABILITY = "stability"  # and response and damped modes
CYCLES, SPEED_CYCLES = "limit cycles", "limit cycles over the speed"

ALL = (FILMS, RUN, *KINEMATIC, BEARING, STABILITY, CYCLES, SPEED_CYCLES)
EVERY_CYCLE = (CYCLES, SPEED_CYCLES)
