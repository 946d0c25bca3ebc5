"""Columns of the sheet of ball bearings."""

from __future__ import annotations

from operator import attrgetter

from frbcli.columns import ENTRIES, Column, Shown, speed_shown

BALLS, STIFFNESSES, FREQUENCIES = "balls", "stiffness", "frequencies"
EVERY = (BALLS, STIFFNESSES, FREQUENCIES)


def _hours(life: float) -> str:
    return f"{life:.3g} h"


# Of a BallState
BALL_SHEET = (
    Column("bearing", "", "name of the ball bearing, empty of one alone"),
    Column("status", "", "`resting` or `not-converged`"),
    Column("problem", "", "why there is no state"),
    Column("speed", "Hz", "rotor speed", shown=tuple(speed_shown(table=table) for table in EVERY)),
    Column("load", "N", "load on the inner ring by one bearing", shape=(2,),
           shown=(Shown(("Fx", "Fy"), ".4g", table=BALLS), Shown(("Fx", "Fy"), ".4g", table=STIFFNESSES))),
    Column("axial_force", "N", "axial force on the balls of a row", shown=(Shown("Fa", ".4g", table=BALLS),),
           more="the preload of a spring, or what rings bear that are held"),
    Column("displacement", "m", "displacement of the inner ring", shape=(2,),
           shown=(Shown(("x", "y"), ".3g", "um", STIFFNESSES),)),
    Column("axial_displacement", "m", "axial displacement of the inner ring from its first contact",
           shown=(Shown("z", ".3g", "um", STIFFNESSES),)),
    Column("stiffness", "N/m", "stiffness `-dF/dD` of one bearing", shape=(2, 2), more="under a preload by a spring "
           "with the rings free along the axis", shown=(Shown(ENTRIES, ".4g", "N/um", STIFFNESSES),)),
    Column("damping", "N s/m", "damping `-dF/dD'` of one bearing, as given", shape=(2, 2)),
    Column("axial_stiffness", "N/m", "axial stiffness with the ring held in x and y",
           shown=(Shown("zz", ".4g", "N/um", STIFFNESSES),)),
    Column("inner_angle", "deg", "contact angle at the inner ring of the ball with the largest load",
           shown=(Shown("a_i", ".3g", table=BALLS),)),
    Column("outer_angle", "deg", "contact angle there at the outer ring", shown=(Shown("a_o", ".3g", table=BALLS),)),
    Column("inner_load", "N", "largest load of a ball at the inner ring", shown=(Shown("Q_i", ".4g", table=BALLS),)),
    Column("outer_load", "N", "largest load of a ball at the outer ring", shown=(Shown("Q_o", ".4g", table=BALLS),)),
    Column("inner_p_max", "Pa", "largest Hertz pressure at the inner ring",
           shown=(Shown("p_i", ".4g", "MPa", BALLS),)),
    Column("outer_p_max", "Pa", "largest Hertz pressure at the outer ring",
           shown=(Shown("p_o", ".4g", "MPa", BALLS),)),
    Column("balls_apart", "", "balls of a row without contact with the inner ring",
           shown=(Shown("apart", "d", table=BALLS),)),
    Column("cage_frequency", "Hz", "speed of the cage", shown=(Shown("cage", ".5g", table=FREQUENCIES),)),
    Column("ball_pass_outer", "Hz", "passing of balls at the outer ring",
           shown=(Shown("outer", ".5g", table=FREQUENCIES),)),
    Column("ball_pass_inner", "Hz", "passing of balls at the inner ring",
           shown=(Shown("inner", ".5g", table=FREQUENCIES),)),
    Column("ball_spin", "Hz", "spin of a ball", shown=(Shown("spin", ".5g", table=FREQUENCIES),)),
    Column("rating_life", "h", "basic rating life L10 by the loads of the balls, ISO/TS 16281", attrgetter("life_h"),
           more="with `dynamic_rating`", shown=(Shown("life", _hours, table=FREQUENCIES),)),
)  # fmt: skip
