"""The axis of a run: the motion along it, and how near its collar comes to its pads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.elements.collar_motion import AxialMotion, axial_motion
from frbcli.results.columns import AXIAL_SIGNALS
from frbcli.rotor.loads import SpeedProfile
from frbcli.scene.machine.rotor import collar_tilt
from frbcli.scene.shafts.table import shaft_of

POSITION, THICKNESS, LOSS = (column.name for column in AXIAL_SIGNALS)


@dataclass(frozen=True)
class RunAxis:
    """The axis of a run under an axial load. tilt: (2, n) of the collar against its pads, None where it does not tilt;
    step: of the output in s; course: (3, k) AxialMotion.at all output times, taken at once: the round-off of some of
    them would depend on how many are asked for, and a resumed run would differ."""

    motion: AxialMotion
    tilt: Array | None
    step: float
    course: Array

    @classmethod
    def of(cls, case: Case, profile: SpeedProfile, step: float) -> RunAxis | None:
        """The axial motion in a run of a case with an output step in s, None without an axial load. Raises as
        axial_motion."""
        motion = axial_motion(case, profile, shaft_of(case).mass)
        if motion is None:
            return None
        times: Array = step * np.arange(int(profile.end / step) + 2, dtype=np.float64)
        return cls(motion, collar_tilt(case), step, np.array(motion.at(times)))

    def signals(self, times: Array, q: Array) -> dict[str, Array]:
        """The signals at k output times in s, with the displacements q (k, n) of the machine."""
        position, gap, loss = self.course[:, np.rint(times / self.step).astype(np.int64)]
        if self.tilt is not None:
            gap = gap - self.motion.collar.bearing.outer_radius * np.linalg.norm(q @ self.tilt.T, axis=1)
        return {POSITION: position, THICKNESS: gap, LOSS: loss}

    def touch(self, signals: Mapping[str, Array]) -> int | None:
        """The first sample at which the collar touches its pads, None where it does not."""
        touching = np.flatnonzero(signals[THICKNESS] <= self.motion.collar.thin)
        return int(touching[0]) if len(touching) else None
