"""Bearing models as functions, and cases that have them."""

from __future__ import annotations

import math
from typing import Any

from numba import njit

import frbcli
from frbcli.film.bearing_model.model import BearingModel

R, L, C, MU = 0.05, 0.03, 1e-4, 0.01
DAMPER = f"""
bearing = {{ kind = "single-film", width = "{L} m", diameter = "{2 * R} m", clearance = "{C} m", ends = "oil-bath" }}
oil = {{ viscosity = "{MU} Pa*s", density = "850 kg/m^3" }}
"""


@njit(error_model="numpy")
def integrals(eps, s, w_r, w_t, full):  # type: ignore[no-untyped-def]
    """Of cos^2, sin cos, sin^2 over (1 + eps cos Theta)^3, where the pressure is positive or over the whole turn, by
    Sommerfeld's angle; times s^5."""
    start, turn = 0.0, 2.0 * math.pi
    reach = math.sqrt(w_r * w_r + (s * w_t) ** 2)
    if not full and reach > 0.0:
        limit = math.acos(w_r * eps / reach)
        start, turn = math.atan2(s * w_t, w_r) + limit, turn - 2.0 * limit
    end = start + turn
    sines, cosines = math.sin(end) - math.sin(start), math.cos(end) - math.cos(start)
    doubled = math.sin(end) * math.cos(end) - math.sin(start) * math.cos(start)
    squares = 0.5 * (math.sin(end) ** 2 - math.sin(start) ** 2)
    return (
        (0.5 + eps * eps) * turn + 0.5 * doubled - 2.0 * eps * sines,
        s * (squares + eps * cosines),
        0.5 * s * s * (turn - doubled),
    )


@njit(error_model="numpy")
def short_force(d_x, d_y, v_x, v_y, omega, bearing, full):  # type: ignore[no-untyped-def]
    c, e = bearing.clearance, math.sqrt(d_x * d_x + d_y * d_y)
    n_x, n_y = (d_x / e, d_y / e) if e > 0.0 else (1.0, 0.0)
    w_x, w_y = v_x + 0.5 * omega * d_y, v_y - 0.5 * omega * d_x  # seen from a frame that turns with half the speed
    w_r, w_t, eps = n_x * w_x + n_y * w_y, n_x * w_y - n_y * w_x, e / c
    s = math.sqrt(1.0 - eps * eps)
    rr, rt, tt = integrals(eps, s, w_r, w_t, full)
    k = -0.5 * bearing.viscosity * bearing.sections * bearing.diameter * bearing.section_width**3 / (c**3 * s**5)
    f_r, f_t = k * (rr * w_r + rt * w_t), k * (rt * w_r + tt * w_t)
    return n_x * f_r - n_y * f_t, n_y * f_r + n_x * f_t


@njit
def half(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]
    return short_force(d_x, d_y, v_x, v_y, omega, bearing, False)


@njit
def chosen(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """A damper: with a key for the film, and nothing of the speed."""
    f_x, f_y = short_force(d_x, d_y, v_x, v_y, 0.0, bearing, bearing.film == 1)
    return f_x - bearing.spring * d_x, f_y - bearing.spring * d_y


def spring(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, bearing: Any) -> Any:  # noqa: ARG001
    """A linear bearing, plain Python."""
    return -1e6 * d_x + 2e5 * d_y - 100.0 * v_x, -2e5 * d_x - 1e6 * d_y - 100.0 * v_y

HALF = BearingModel("short-pi", "short, pi film", half)
CHOSEN = BearingModel(
    "damper",
    "squeeze film damper",
    chosen,
    keys=(
        frbcli.BearingKey("film", "pi", choices=("pi", "full")),
        frbcli.BearingKey("spring", 0.0, "of the squirrel cage", "1e6 N/m", unit="N/m", least=0.0),
    ),
    meaning="A damper.",
)


def damper_case(*settings: str, text: str = "") -> frbcli.Case:
    return frbcli.load_case_text(DAMPER + text, ("film.theory=damper", *settings), name="damper")
