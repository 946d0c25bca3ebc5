"""The log of a sweep, one line of JSON for each point, from which an interrupted sweep is resumed.

A line is written as soon as its point is computed. The first line says which sweep it is; an incomplete
line is left out, and so are points that are to be computed again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from frbcli.case.reading.load import describes
from frbcli.case.schema import Case
from frbcli.results.files.kinds import SWEEP_LOG
from frbcli.results.files.named import Unreadable, text_of
from frbcli.results.files.write import write
from frbcli.studies.sweep.points import refused
from frbcli.studies.sweep.task import UNDECIDED, SweepPoint

Header = Mapping[str, Any]

LARGEST_LOG = 1024**3  # bytes


def open_log(path: Path, header: Header, case: Case) -> tuple[SweepPoint, ...]:
    """The points that are done already by the log at `path`, which is ready for more afterwards.

    header: of the sweep, with the text of its `case`, which the log may have in other words. Raises InputError if it
    is the log of another sweep, or cannot be read or written.
    """
    try:
        known = text_of(path, LARGEST_LOG).split("\n") if path.exists() else []
        if known and not _same_sweep(_parsed(known[0]), json.loads(json.dumps(header)), case):
            remedy = "Choose another directory with -o, or remove this one."
            raise refused("--output", str(path), "belongs to another sweep, case or version.", remedy)
        done = {point.number: point for point in map(_point, known[1:]) if point and point.status not in UNDECIDED}
    except (OSError, Unreadable) as error:
        problem = str(error) if isinstance(error, Unreadable) else f"cannot be used: {error.strerror}."
        raise refused("--output", str(path), problem, "Choose another directory with -o.") from error
    lines = [json.dumps(header), *map(_line, done.values())]
    write(path, SWEEP_LOG, "".join(f"{line}\n" for line in lines))
    return tuple(done.values())


def append(path: Path, points: Sequence[SweepPoint]) -> None:
    """Note that points are done. Raises InputError if the disk does not take it."""
    try:
        with path.open("a", encoding="utf-8") as file:
            file.writelines(f"{_line(point)}\n" for point in points)
    except OSError as error:
        remedy = "Free some space; the same command then resumes the sweep."
        raise refused("--output", str(path), f"cannot be written: {error.strerror}.", remedy) from error


def _same_sweep(known: object, header: Header, case: Case) -> bool:
    if not isinstance(known, dict) or {**known, "case": ""} != {**header, "case": ""}:
        return False
    text = known.get("case")
    return text == header["case"] or (isinstance(text, str) and describes(text, case))


def _line(point: SweepPoint) -> str:
    return json.dumps(asdict(point), default=str)


def _point(line: str) -> SweepPoint | None:
    """The point of a line, None for an incomplete one."""
    parsed = _parsed(line)
    if not isinstance(parsed, dict):
        return None
    try:
        run = None if parsed["run"] is None else Path(parsed["run"])
        return SweepPoint(**(parsed | {"events": tuple(parsed["events"]), "run": run}))
    except (KeyError, TypeError):
        return None


def _parsed(line: str) -> object:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None
