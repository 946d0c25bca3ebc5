"""Smooth surfaces on an elastic shell, with a journal pressed into it: what its film feels, and what pushes it back.

The time loop has the same in solve/stage/contact.py.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.film.contact_gap import closes_freely_until, contact_gap
from frbcli.film.rectangles.film import FilmForce


@dataclass(frozen=True)
class ElasticShell:
    """The shells of all films. begins: eccentricity at which the surfaces touch; stiffness: N/m of one bearing."""

    begins: float
    stiffness: float

    def felt(self, place: Array, clearance: float) -> Array:
        """(2,) m: the displacement that a film feels of a journal at `place` (2,) in m."""
        d_x, d_y = (place / clearance).tolist()
        begins = closes_freely_until(self.begins)
        if np.hypot(d_x, d_y) <= begins:
            return place
        return clearance * np.array(contact_gap(begins, d_x, d_y, 0.0, 0.0)[:2])

    def pressed(self, load: float, clearance: float) -> float:
        """Eccentricity in m of a journal that the shell alone carries under a load in N."""
        return self.begins * clearance + load / self.stiffness

    def force(
        self, film: Callable[[Array, Array], FilmForce], place: Array, rate: Array, clearance: float
    ) -> FilmForce:
        """Force and derivatives of a film, by displacement and velocity, and of its shell together, with the journal at
        `place` (2,) in m with a velocity (2,) in m/s."""
        (d_x, d_y), (v_x, v_y) = (place / clearance).tolist(), (rate / clearance).tolist()
        eccentricity, begins = float(np.hypot(d_x, d_y)), closes_freely_until(self.begins)
        if eccentricity <= begins:
            return film(place, rate)
        x, y, u, w, g_xx, g_yy, g_xy, r_xx, r_yy, r_xy = contact_gap(begins, d_x, d_y, v_x, v_y)
        force = film(clearance * np.array([x, y]), clearance * np.array([u, w]))
        felt, rated = np.array([[g_xx, g_xy], [g_xy, g_yy]]), np.array([[r_xx, r_xy], [r_xy, r_yy]])
        outwards = place / np.hypot(*place)
        along = self.stiffness if eccentricity > self.begins else 0.0
        push = along * clearance * (eccentricity - self.begins)
        across = push / (eccentricity * clearance)
        spring = across * np.eye(2) + (along - across) * np.outer(outwards, outwards)
        return FilmForce(
            force.force - push * outwards,
            force.by_displacement @ felt + force.by_velocity @ rated - spring,
            force.by_velocity @ felt,
            force.field,
            force.fraction,
        )
