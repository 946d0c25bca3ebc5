"""Plain bearings between axial grooves, and the printed tables of their sheets."""

import math

from paths import rows_of

Row = dict[str, float]
CASE = """
title = "plain bearing"
[oil]
viscosity = "{viscosity} mPa*s"
[bearing]
kind = "single-film"
width = "{width} mm"
diameter = "{diameter} mm"
clearance = "{clearance} um"
supply = {supply}
[film]
cavitation = "reynolds"
[motion]
load = "{load} N"
speed = "50 Hz"
"""
OMEGA = 2.0 * math.pi * 50.0


def printed(name: str) -> list[Row]:
    return [{key: float(value) for key, value in row.items() if value} for row in rows_of(name)]


def grooves(count: int, position: float, opening: float) -> str:
    return (
        f'{{ kind = "axial-grooves", count = {count}, position = "{position} deg", opening_angle = "{opening} deg", '
        'pressure = "1 bar" }'
    )
