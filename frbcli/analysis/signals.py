"""How the signals of a run are called, for all that read them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from frbcli.results.store import CLEARANCE_STEP

Values = NDArray[np.float64]
Motion = NDArray[np.complex128]

END = "_x_m"


class RunLike(Protocol):
    """What is read of a run: its signals by name, lengths in m to compare them with, how it ended."""

    @property
    def signals(self) -> Iterable[str]: ...
    @property
    def references(self) -> dict[str, float]: ...
    @property
    def status(self) -> str: ...
    def __getitem__(self, name: str) -> Values: ...


def joined(*words: str) -> str:
    """Words that are not empty, as names of signals and films join them."""
    return "_".join(word for word in words if word)


def points(names: Iterable[str], kind: str) -> Iterator[str]:
    """Of each "journal", "disk" or "ring" what follows this word: "" alone, or the name of a bearing or a wheel."""
    for name in names:
        if name.endswith(END) and (name == kind + END or name.startswith(kind + "_")):
            yield name[len(kind) + 1 : -len(END)]


def films(names: Iterable[str]) -> Iterator[str]:
    """The films whose eccentricities are among the signals: "" alone, or their names."""
    return (name[len("eccentricity_") :] for name in names if f"{name}_".startswith("eccentricity_"))


def motion_of(run: RunLike, kind: str, name: str) -> Motion:
    """x + iy (n,) in m of a point."""
    node = joined(kind, name)
    return np.asarray(run[node + END] + 1j * run[f"{node}_y_m"])


def ring_speed(run: RunLike, name: str) -> Values:
    """Speed (n,) in Hz of the ring of a bearing, 0 of a ring that does not turn."""
    signal = joined("ring_speed", name, "Hz")
    return run[signal] if signal in set(run.signals) else np.zeros(len(run["time_s"]))


def film_clearance(run: RunLike, film: str = "") -> float | None:
    """The clearance in m of a film by its name, or else that of all; None if the run does not say it."""
    lengths = run.references
    return lengths.get(joined("clearance_m", film), lengths.get("clearance_m"))


def clearance_steps(run: RunLike) -> list[float]:
    """Times in s at which clearances change, ascending; whether the run has reached them or not."""
    return sorted(time for name, time in run.references.items() if name.startswith(CLEARANCE_STEP))


def bearing_clearance(run: RunLike, name: str = "") -> float | None:
    """How far in m the journal of a bearing can move: the clearance, of a floating ring the sum of both."""
    if name in points(run.signals, "ring"):
        both = [run.references.get(joined("clearance_m", name, side)) for side in ("inner", "outer")]
        known = [length for length in both if length is not None]
        if len(known) == 2:
            return sum(known)
    return film_clearance(run, name)
