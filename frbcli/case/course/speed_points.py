"""The rotor speed through given points, or as it was measured: the case gets times and speeds instead of the keys
`points` or `file`, and from, to and duration that follow from them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from frbcli.case.course.time_tables import MOST_NUMBERS, TableKind, read_table, read_tacho
from frbcli.case.files.number_table import Refused
from frbcli.case.reading.tables import Breach
from frbcli.units import SPEED, ValueFault, quantity

if TYPE_CHECKING:
    from collections.abc import Sequence

MEASURED = TableKind("Hz", ("speed", "n", "rotor_speed"), ())
TIMES, SPEEDS = "times", "speeds"
RAMP = {"from": SPEED, "to": SPEED, "duration": "s"}  # keys that follow
REMEDY = 'Write e.g. [["0 s", "0 Hz"], ["1 s", "900 Hz"]].'


def with_speed_points(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with times and speeds instead of speed.points and speed.file, and the faults.

    folder: that a relative path counts from.
    """
    speed = data.get("speed")
    if not isinstance(speed, dict) or not {"points", "file", TIMES, SPEEDS} & speed.keys():
        return data, []
    given = [key for key in ("points", "file", TIMES) if key in speed]
    if len(given) > 1:
        return data, [Breach(("speed", given[0]), f"is given with {given[1]}.", "Keep one of them.")]
    try:
        written = _written(speed, folder)
        times, speeds = (_column(each, unit) for each, unit in zip(written, ("s", SPEED), strict=True))
        _check(times, speeds)
    except Refused as fault:
        return data, [Breach(("speed", *given), *fault.args)]
    follows = {"from": speeds[0], "to": max(speeds, key=abs), "duration": times[-1]}
    clashes = [_differs(key, speed[key], value) for key, value in follows.items() if key in speed]
    kept = {key: value for key, value in speed.items() if key not in ("points", "file", "tacho", "pulses")}
    ramp = {key: f"{value!r} {RAMP[key]}" for key, value in follows.items() if key not in kept}
    columns = dict(zip((TIMES, SPEEDS), written, strict=True))
    return data | {"speed": {**kept, **ramp, **columns}}, [breach for breach in clashes if breach]


def _differs(key: str, given: object, follows: float) -> Breach | None:
    try:
        if quantity(given, RAMP[key]) == follows:
            return None
    except ValueFault:
        pass
    problem = "is given with points or a file, which it follows from."
    return Breach(("speed", key), problem, "Leave it out, or set the whole table: speed = { from, to, duration }.")


def _written(speed: dict[str, Any], folder: Path) -> tuple[Any, Any]:
    """Times and speeds as they were written, perhaps with units; of a file as numbers in s and Hz."""
    if isinstance(speed.get("file"), str):
        tacho = speed.get("tacho")
        path = folder / str(speed["file"])
        columns = read_tacho(path, str(tacho), speed.get("pulses", 1)) if tacho else read_table(path, MEASURED)
        return columns["time"], columns["x"]
    if TIMES in speed or SPEEDS in speed:
        return speed.get(TIMES), speed.get(SPEEDS)
    points = speed.get("points")
    if not isinstance(points, list) or any(not isinstance(each, list) or len(each) != 2 for each in points):
        raise Refused("is no list of times with speeds, nor the name of a file.", REMEDY)
    return [time for time, _ in points], [value for _, value in points]


def _column(given: object, unit: str) -> list[float]:
    if not isinstance(given, list):
        raise Refused("needs as many times as speeds.", REMEDY)
    try:
        return [quantity(each, unit) for each in given]
    except ValueFault as fault:
        raise Refused(f"has a value that {fault.problem}", REMEDY) from None


def _check(times: Sequence[float], speeds: Sequence[float]) -> None:
    if len(times) != len(speeds) or not 2 <= len(times) <= MOST_NUMBERS // 2:
        raise Refused(f"has {len(times)} times and {len(speeds)} speeds.", f"Give 2 to {MOST_NUMBERS // 2} of both.")
    if times[0] != 0.0:
        raise Refused(f"begins at {times[0]:.9g} s, and a run at 0 s.", "Let the times count from the first.")
    falling = next((row for row in range(1, len(times)) if not times[row] > times[row - 1]), 0)
    if falling:
        raise Refused(f"has the time {times[falling]:.9g} s in row {falling + 1}, not later than the row before.",
                    "Order the rows by rising times.")  # fmt: skip
    below = next((row for row, speed in enumerate(speeds) if speed < 0.0), -1)
    if below >= 0:
        raise Refused(f"has the speed {speeds[below]:.6g} Hz in row {below + 1}.", "Give speeds of 0 and above.")
    if max(speeds) == 0.0:
        raise Refused("has no speed above 0.", REMEDY)
