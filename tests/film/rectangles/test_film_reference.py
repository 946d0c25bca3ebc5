"""Largest pressures of half-Sommerfeld films against an independent, grid-refined program.

Their forces are those of it to 0.3 %, see tests/docs/test_validation.py."""

from dataclasses import replace

import numpy as np
import pytest
from films import GROOVED, PLAIN
from paths import rows_of
from volume_films import motion_of

from frbcli.film.gap import Section
from frbcli.film.rectangles.film import largest_pressure
from frbcli.scene.planning.film_choice import DEFAULT_MESH

PRESSURE_ERROR = 1e-2


def name_of(row: dict[str, str]) -> str:
    keys = ("supply", "supply_pressure_bar", "speed_Hz", "eccentricity_rate_1_s", "whirl_speed_rad_s", "eccentricity")
    return "-".join(row[key] for key in keys)


def bearing_of(row: dict[str, str]) -> Section:
    if row["supply"] == "none":
        return PLAIN
    return replace(GROOVED, far_pressure=1e5 * float(row["supply_pressure_bar"]) - GROOVED.ambient_pressure)


@pytest.mark.parametrize("row", rows_of("film-forces.csv"), ids=name_of)
def test_largest_pressure(row: dict[str, str]) -> None:
    bearing, motion = bearing_of(row), motion_of(row)
    at, rate = (bearing.clearance * np.array(vector) for vector in (motion.d, motion.v))
    found = largest_pressure(bearing, DEFAULT_MESH, at, rate, motion.omega)
    assert found == pytest.approx(float(row["p_max_Pa"]), rel=PRESSURE_ERROR)
