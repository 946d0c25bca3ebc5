"""Films on volumes for the tests, with the motions and laws of film-forces-all.csv, of an independent program."""

import math

import numpy as np

from frbcli.film.cavitation.conditions import Elrod, HalfSommerfeld, Reynolds
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.penalty import PREFACTOR, Penalty, steepness_exponent
from frbcli.film.cavitation.two_phase import Peeken, TwoPhase
from frbcli.film.cells.film import Motion
from frbcli.film.gap import AxialGroove, Section

Row = dict[str, str]

RADIUS, WIDTH, CLEARANCE, VISCOSITY, AMBIENT = 12.5e-3, 20e-3, 40e-6, 10e-3, 1e5
GROOVE_OPENING = math.radians(15.0)


def section_of(supply: str, pressure: float = AMBIENT, ends: str = "oil-bath") -> Section:
    """Half of the bearing of table 4.1, cut in the middle; pressure: absolute, of the supply."""
    return Section(
        RADIUS,
        WIDTH / 2,
        WIDTH,
        CLEARANCE,
        VISCOSITY,
        AMBIENT,
        AMBIENT,
        copies=2,
        near=ends,
        far="groove" if supply == "circumferential-groove" else "symmetry",
        far_pressure=pressure - AMBIENT if supply == "circumferential-groove" else 0.0,
        grooves=(AxialGroove(0.0, GROOVE_OPENING, pressure - AMBIENT),) if supply == "axial-groove" else (),
    )


def motion_of(row: Row) -> Motion:
    eccentricity, attitude = float(row["eccentricity"]), math.radians(float(row["attitude_deg"]))
    rate, whirl = float(row["eccentricity_rate_1_s"]), float(row["whirl_speed_rad_s"])
    return polar_motion(eccentricity, attitude, rate, whirl, 2.0 * math.pi * float(row["speed_Hz"]))


def polar_motion(eccentricity: float, attitude: float, rate: float, whirl: float, omega: float) -> Motion:
    """d = eps (cos, sin)(attitude) with the rate of eps in 1/s and of the attitude in rad/s."""
    c, s = math.cos(attitude), math.sin(attitude)
    v = (rate * c - eccentricity * whirl * s, rate * s + eccentricity * whirl * c)
    return Motion((eccentricity * c, eccentricity * s), v, omega)


def law_of(row: Row, section: Section, motion: Motion) -> Law:
    cavitation, parameter = row["cavitation"], row["parameter"]
    if cavitation == "two-phase":
        return TwoPhase(float(parameter.removeprefix("x1=")))
    if cavitation == "penalty":
        b = steepness_exponent(float(np.hypot(*motion.d)))
        if parameter.startswith("pressure=p/p0"):
            return Penalty(PREFACTOR, b * section.pressure_scale / section.ambient_pressure)
        return Penalty(PREFACTOR * 0.5 * motion.omega, b * 2.0 / motion.omega)
    return {
        "half-sommerfeld": HalfSommerfeld(),
        "reynolds": Reynolds(),
        "elrod": Elrod(),
        "peeken": Peeken(0.1),
    }[cavitation]


# A steady one that the tests share: eps 0.6, 100 Hz
ROTATION = polar_motion(0.6, -math.pi / 3, 0.0, 0.0, 2.0 * math.pi * 100.0)
