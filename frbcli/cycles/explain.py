"""What causes the onset and the end of a whirl in a run: the Hopf point or the fold that lies there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from frbcli.cycles.method.cycle import FOLD, HOPF
from frbcli.cycles.result import LimitCycles, SpecialPoint
from frbcli.units import SpeedUnit

FREQUENCY_WEIGHT = 3.0  # of the frequency against the speed, where it is asked which point an event belongs to
AHEAD = 1.02  # an onset may be seen so much below its cause, by the resolution of events


def explanations(found: LimitCycles, events: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """A sentence for each onset and offset of a run's events that a point of the diagram explains."""
    told, unit = [], found.case.speed_unit
    for event in events:
        if event["kind"] not in ("onset", "offset"):
            continue
        seen = f"{event['kind'].capitalize()} at {unit.words(event['speed_Hz'], 1)}"
        starts = event["kind"] == "onset"
        causes = [point for point in found.special if point.kind in (HOPF, FOLD) and not point.synchronous]
        if starts:
            causes = [point for point in causes if point.speed_Hz <= AHEAD * event["speed_Hz"]]
        if not causes:
            told.append(f"{seen}: no Hopf point and no fold of the diagram without unbalance causes it.")
            continue
        cause = min(causes, key=lambda point: _distance(point, event))
        told.append(f"{seen}: {_sentence(cause, starts, event['speed_Hz'], unit)}")
    return tuple(told)


def _distance(point: SpecialPoint, event: Mapping[str, Any]) -> float:
    """How little a point fits to an event: logarithms of the ratios of their speeds and frequencies."""
    frequency = event["frequency_Hz"]
    off = abs(math.log(point.frequency_Hz / frequency)) if frequency else 0.0
    return FREQUENCY_WEIGHT * off + abs(math.log(point.speed_Hz / event["speed_Hz"]))


def _sentence(cause: SpecialPoint, starts: bool, speed_Hz: float, unit: SpeedUnit) -> str:
    where = f"{unit.words(cause.speed_Hz, 1)} ({cause.frequency_Hz:.1f} Hz)"
    off = unit.words(abs(speed_Hz - cause.speed_Hz), 1)
    if starts and cause.kind == HOPF:
        soft = {"supercritical": "soft ", "subcritical": "hard "}.get(cause.criticality or "", "")
        return f"a whirl grows at rest from the {soft}Hopf point at {where} on; it is seen {off} later."
    if starts:
        return f"stable cycles begin in the fold at {where}; a disturbance led there {off} above it."
    if cause.kind == HOPF:
        return f"the cycles shrink to rest in the Hopf point at {where}, {off} away."
    return f"the cycles end in the fold at {where}, {off} away."
