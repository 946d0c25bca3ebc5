"""The summits of one film beside what it does: force with derivatives, and loads."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cells.loads import FilmLoads
from frbcli.film.cells.motion import Motion
from frbcli.film.rectangles.film import FilmForce, none_of
from frbcli.film.roughness.asperities import Asperities, rub, standing_eccentricity, touch
from frbcli.film.roughness.rub_slopes import COLUMNS, FOUND, rub_slopes


@dataclass(frozen=True)
class Rubbing:
    """surfaces: None between smooth ones; film: its number of these; clearance: m."""

    surfaces: Asperities | None
    film: int
    clearance: float

    def force(self, place: Array, rate: Array, slip: float, shell: float = 0.0) -> FilmForce:
        """What the summits do to a journal at `place` (2,) in m with a velocity (2,) in m/s; slip: omega_J - omega_S,
        shell: omega_S, rad/s."""
        if self.surfaces is None:
            return none_of(2)
        (e_x, e_y), (v_x, v_y) = place[:2].tolist(), rate[:2].tolist()
        found = rub(self.surfaces, self.film, self.clearance, e_x, e_y, v_x, v_y, slip, shell)
        by_place, by_rate = (np.array(found[first : first + 4]).reshape(2, 2) for first in (2, 6))
        return FilmForce(np.array(found[:2]), by_place, by_rate)

    def beside(self, film: FilmForce, place: Array, rate: Array, slip: float, shell: float = 0.0) -> FilmForce:
        """A film and its summits, see force."""
        if self.surfaces is None:
            return film
        return film.plus(self.force(place, rate, slip, shell))

    def pulled(self, place: Array, slip: float, shell: float) -> tuple[float, float, float]:
        """Torques in N m on the journal and on the shell, and the moment of the force on the journal about the middle
        of the shell, with the journal at rest at `place` (2,) in m; see force."""
        if self.surfaces is None:
            return 0.0, 0.0, 0.0
        e_x, e_y = place[:2].tolist()
        found = rub(self.surfaces, self.film, self.clearance, e_x, e_y, 0.0, 0.0, slip, shell)
        return found.torque, found.shell_torque, e_x * found.f_y - e_y * found.f_x

    def power(self, place: Array, total: float, slip: float) -> float:
        """Heat in W that friction makes while the journal rests at `place` (2,) in m; total, slip: omega_J + omega_S
        and omega_J - omega_S in rad/s."""
        if self.surfaces is None:
            return 0.0
        e_x, e_y = place[:2].tolist()
        shell = 0.5 * (total - slip)
        return rub(self.surfaces, self.film, self.clearance, e_x, e_y, 0.0, 0.0, slip, shell).power

    def slopes(self, motions: Array) -> Array:
        """(k, FOUND, COLUMNS) force and torques with all derivatives in motions (k, 6), see rub_slopes."""
        if self.surfaces is None:
            return np.zeros((len(motions), FOUND, COLUMNS))
        return rub_slopes(self.surfaces, self.film, self.clearance, motions)

    def standing(self, load: float) -> float:
        """Eccentricity in m of a journal that stands still on its summits under a load in N; 0 between smooth
        surfaces, and if they do not carry it up to two clearances."""
        far = 2.0 * self.clearance
        if self.surfaces is None or touch(self.surfaces, self.film, self.clearance, far).radial < load:
            return 0.0
        return standing_eccentricity(self.surfaces, self.film, self.clearance, load)

    def loads(self, film: FilmLoads, motion: Motion, turning: float = 0.0) -> FilmLoads:
        """The loads of a film with those of its summits. motion: in a shell at rest, seen from a frame that turns with
        `turning` rad/s, as the force is."""
        if self.surfaces is None:
            return film
        c, (d_x, d_y), (v_x, v_y) = self.clearance, motion.d, motion.v
        slip = motion.omega + 2.0 * turning
        found = rub(self.surfaces, self.film, c, c * d_x, c * d_y, c * v_x, c * v_y, slip, -turning)
        x, y = film.force
        torque = replace(film.torque, summits=(found.torque, -found.shell_torque))
        return replace(film, force=(x + found.f_x, y + found.f_y), torque=torque)

    def share_of_error(self, film: FilmLoads, whole: FilmLoads) -> float:
        """Relative error of the force with the summits over that of the film alone."""
        size = math.hypot(*whole.force)
        return math.hypot(*film.force) / size if self.surfaces is not None and size > 0.0 else 1.0
