"""Wear of rough surfaces over a run, by Archard: an estimate. The gap of the run does not follow it.

A place of the shell loses the depth k p |u| dt, with the pressure p of the summits, their sliding speed u and the
specific wear rate k, volume over force and path. A shell that turns, a ring, and every journal lose it all around.

Source: Archard: Contact and rubbing of flat surfaces. J. Appl. Phys. 24 (1953), 981-988.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import Indices
from frbcli.film.roughness.asperities import wear_along
from frbcli.rotor.speed_profile import SpeedProfile
from frbcli.runs.record.film_numbers import FilmNumbers, unchanged
from frbcli.runs.record.film_signals import Samples, film_motions
from frbcli.runs.record.restored import WrongCheckpoint, array
from frbcli.scene.machine.system import System

ANGLES = 72  # places around a shell, evenly from the top on, counter-clockwise
NAME, DEEPEST = "wear", 1.0  # in a checkpoint; m, deeper than any shell


class RunWear:
    """Depths that the shells of a run have lost so far, as if none of them turned. rate: m^2/N, None for none; step: of
    the output in s; bodies: see System."""

    def __init__(self, rate: float | None, step: float, bodies: Indices) -> None:
        self._scale = 0.0 if rate is None else rate * step
        self._depths = np.zeros((0 if rate is None else len(bodies), ANGLES))
        self._turns = bodies[:, 1] >= 0

    def add(self, system: System, warm: FilmNumbers | None, profile: SpeedProfile, samples: Samples) -> None:
        """Let the surfaces wear as they slide at these samples."""
        if system.asperities is None or not len(self._depths):
            return
        for i, depths in enumerate(self._depths):
            clearances, motions = film_motions(system, warm or unchanged(system), profile, samples, i)
            wear_along(system.asperities, i, clearances, motions, self._scale, depths)

    def snapshot(self) -> dict[str, Array]:
        """What a checkpoint holds: (films, ANGLES) m."""
        return {NAME: self._depths.copy()} if len(self._depths) else {}

    def restore(self, checkpoint: Mapping[str, Array]) -> None:
        """Take up the depths of a checkpoint. Raises WrongCheckpoint."""
        if len(self._depths):
            depths = array(checkpoint, NAME, self._depths.shape)
            if not np.all((depths >= 0.0) & (depths <= DEEPEST)):
                raise WrongCheckpoint("wear holds depths that no shell has")
            self._depths = depths

    def told(self) -> dict[str, float]:
        """The largest depth in m and phi of its place in degrees, 0 all around a shell that turns."""
        if not len(self._depths):
            return {}
        depths = np.where(self._turns[:, None], self._depths.mean(axis=1, keepdims=True), self._depths)
        film, place = np.unravel_index(int(np.argmax(depths)), depths.shape)
        return {"wear_depth_m": float(depths[film, place]), "wear_angle_deg": 360.0 * float(place) / ANGLES}
