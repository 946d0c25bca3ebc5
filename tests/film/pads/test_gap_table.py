"""The table of films over the gap against the films themselves."""

from __future__ import annotations

import math

import numpy as np
import pytest

from frbcli.film.pad_geometry import MESH, Pad, Profile
from frbcli.film.pads import PadOil, gap_table, pad_film, pad_mesh, ring_of_pads

# Of a step a hundred times as deep as the thinnest gap, round-off is 1.5e-8 of the stiffness across a tilt there, by
# mobilities in the ratio of 1e6; polynomials spread it over all gaps. At 1e-7 m it would be 3e-7.
THIN, WIDE, PADS = 2e-7, 2e-3, 4


@pytest.mark.parametrize("profile", ["taper", "step"])
def test_table_is_the_film_at_any_speed_and_viscosity(profile: Profile) -> None:
    pad = Pad(5e-3, 11e-3, math.radians(75.0), math.radians(50.0), 20e-6, profile)
    table, mesh, eta, omega = gap_table(pad, PADS, THIN, WIDE), pad_mesh(pad, *MESH), 8e-3, 2.0 * math.pi * 2000.0
    for gap in (2.7e-7, 6.1e-6, 3.3e-5, 9e-4):
        film = ring_of_pads(pad_film(mesh, gap + pad.depth(mesh.theta), PadOil(eta), omega), PADS)
        scaled = table.at(gap)
        assert eta * omega * scaled.load == pytest.approx(film.forces[0], rel=1e-7)
        assert eta * omega * scaled.torque == pytest.approx(film.torque, rel=1e-7)
        assert omega * scaled.side_flow == pytest.approx(film.inner_flow + film.outer_flow, rel=1e-7)
        assert eta * omega * scaled.stiffness == pytest.approx(film.stiffness[0, 0], rel=1e-7)
        assert eta * scaled.damping == pytest.approx(film.damping[0, 0], rel=1e-7)
        tilt = film.stiffness[1:, 1:]
        assert eta * omega * scaled.tilt_stiffness == pytest.approx(tilt, abs=1e-7 * np.abs(tilt).max())
        assert eta * scaled.tilt_damping == pytest.approx(film.damping[1:, 1:], abs=1e-7 * film.damping[1, 1])
        assert film.pressure.min() >= 0.0  # else films would not scale with speed and viscosity
