"""Largest pressures of half-Sommerfeld films against an independent, grid-refined program.

Their forces are those of it to 0.3 %, see tests/docs/test_validation.py."""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from films import GROOVED, PLAIN, polar
from paths import DATA

from frbcli.film.gap import Section
from frbcli.film.rectangles.film import largest_pressure
from frbcli.scene.planning.film_choice import DEFAULT_MESH

FORCES = DATA / "film-forces.csv"
Motion = tuple[np.ndarray, np.ndarray, float]

PRESSURE_ERROR = 1e-2


def reference() -> list[dict[str, str]]:
    lines = [line for line in FORCES.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def name_of(row: dict[str, str]) -> str:
    keys = ("supply", "supply_pressure_bar", "speed_Hz", "eccentricity_rate_1_s", "whirl_speed_rad_s", "eccentricity")
    return "-".join(row[key] for key in keys)


def bearing_of(row: dict[str, str]) -> Section:
    if row["supply"] == "none":
        return PLAIN
    return replace(GROOVED, far_pressure=1e5 * float(row["supply_pressure_bar"]) - GROOVED.ambient_pressure)


def motion_of(row: dict[str, str], clearance: float) -> Motion:
    """Displacement in m, velocity in m/s, omega in rad/s."""
    eccentricity, attitude = float(row["eccentricity"]), math.radians(float(row["attitude_deg"]))
    along, across = polar(1.0, attitude), polar(1.0, attitude + math.pi / 2)
    rate = float(row["eccentricity_rate_1_s"]) * along + eccentricity * float(row["whirl_speed_rad_s"]) * across
    return clearance * eccentricity * along, clearance * rate, 2 * math.pi * float(row["speed_Hz"])


@pytest.mark.parametrize("row", reference(), ids=name_of)
def test_largest_pressure(row: dict[str, str]) -> None:
    bearing = bearing_of(row)
    found = largest_pressure(bearing, DEFAULT_MESH, *motion_of(row, bearing.clearance))
    assert found == pytest.approx(float(row["p_max_Pa"]), rel=PRESSURE_ERROR)
