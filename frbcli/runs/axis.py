"""The axis of a run: the motion along it, and how near its collar comes to its pads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frbcli.case.schema import Case
from frbcli.elements.collar.motion import AxialMotion, axial_motion
from frbcli.results.columns import AXIAL_SIGNALS
from frbcli.rotor.speed_profile import SpeedProfile
from frbcli.scene.machine.rotor import collar_tilt
from frbcli.scene.shafts.table import shaft_of
from frbcli.solve.state import Array

POSITION, THICKNESS, LOSS = (column.name for column in AXIAL_SIGNALS)


@dataclass(frozen=True)
class RunAxis:
    """The axis of a run under an axial load. tilt: (2, n) of the collar against its pads, None where it does not
    tilt."""

    motion: AxialMotion
    tilt: Array | None

    @classmethod
    def of(cls, case: Case, profile: SpeedProfile) -> RunAxis | None:
        """Of a run of a case, None without an axial load. Raises as axial_motion."""
        motion = axial_motion(case, profile, shaft_of(case).mass)
        return None if motion is None else cls(motion, collar_tilt(case))

    def signals(self, times: Array, q: Array) -> dict[str, Array]:
        """The signals at k times in s, with the displacements q (k, n) of the machine."""
        position, gap, loss = self.motion.at(times)
        if self.tilt is not None:
            gap = gap - self.motion.collar.bearing.outer_radius * np.linalg.norm(q @ self.tilt.T, axis=1)
        return {POSITION: position, THICKNESS: gap, LOSS: loss}

    def touch(self, signals: Mapping[str, Array]) -> int | None:
        """The first sample at which the collar touches its pads, None where it does not."""
        touching = np.flatnonzero(signals[THICKNESS] <= self.motion.collar.thin)
        return int(touching[0]) if len(touching) else None
