"""The axis of a run: the motion along it, and how near its collar comes to its pads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.elements.collar import Collar, axial_motion, collar_of, rests_over_speed
from frbcli.results.columns import AXIAL_SIGNALS
from frbcli.rotor.loads import SpeedProfile
from frbcli.scene.machine.rotor import collar_tilt
from frbcli.scene.machine.turbocharger import shaft_of

SLOWER = 1e-3  # share of a speed by which the slowest one that is known may be missed
POSITION, THICKNESS, LOSS = (column.name for column in AXIAL_SIGNALS)


@dataclass(frozen=True)
class RunAxis:
    """The axis of a run under an axial load. tilt: (2, n) of the collar against its pads, None where it does not tilt;
    step: of the output in s; course: (3, k) AxialMotion.at all output times, taken at once: the round-off of some of
    them would depend on how many are asked for, and a resumed run would differ. speeds: (k,) rad/s, None but where the
    speed is free: course is that of a collar which rests at each of them."""

    collar: Collar
    tilt: Array | None
    step: float
    course: Array
    speeds: Array | None = None

    @classmethod
    def of(cls, case: Case, profile: SpeedProfile, step: float) -> RunAxis | None:
        """The axis of a run of a case with an output step in s, None without an axial load. Raises as axial_motion."""
        collar = collar_of(case)
        if collar is None:
            return None
        if case.drive is not None:
            speeds, *course = _resting(collar)
            return cls(collar, collar_tilt(case), step, np.array(course), speeds)
        motion = axial_motion(case, profile, shaft_of(case).mass)
        assert motion is not None
        times: Array = step * np.arange(int(profile.end / step) + 2, dtype=np.float64)
        return cls(collar, collar_tilt(case), step, np.array(motion.at(times)))

    def signals(self, times: Array, speeds: Array, q: Array) -> dict[str, Array]:
        """The signals at k output times in s, with speeds in rad/s and displacements q (k, n) of the machine."""
        if self.speeds is None:
            position, gap, loss = self.course[:, np.rint(times / self.step).astype(np.int64)]
        else:
            position, gap, loss = (np.interp(speeds, self.speeds, each) for each in self.course)
            gap = np.where(speeds < self.speeds[0] * (1.0 - SLOWER), self.collar.thin, gap)
        if self.tilt is not None:
            gap = gap - self.collar.bearing.outer_radius * np.linalg.norm(q @ self.tilt.T, axis=1)
        return {POSITION: position, THICKNESS: gap, LOSS: loss}

    def touch(self, signals: Mapping[str, Array]) -> int | None:
        """The first sample at which the collar touches its pads, None where it does not."""
        touching = np.flatnonzero(signals[THICKNESS] <= self.collar.thin)
        return int(touching[0]) if len(touching) else None


def _resting(collar: Collar) -> Array:
    """(4, k) speeds, positions, gaps and losses of a collar at rest: down to standstill where the load ends there."""
    rests = rests_over_speed(collar)
    rows = [(rest.omega, collar.position(rest), rest.gap, rest.torque * rest.omega) for rest in rests]
    if not collar.load_at(0.0):
        rows.insert(0, (0.0, *rows[0][1:3], 0.0))
    return np.array(rows).T
