"""The bearings of tests/data/ball-bearing.csv."""

from math import radians

from frbcli.elements.ball import BallBearing
from frbcli.materials import ROLLING

STEEL, NITRIDE = ROLLING["steel"], ROLLING["silicon nitride"]
A = BallBearing(8, 3.175e-3, 14e-3, radians(15.0), 0.53, 0.53, STEEL, STEEL, preload=60.0)
B = BallBearing(9, 4e-3, 18e-3, radians(25.0), 0.52, 0.53, NITRIDE, STEEL, preload=60.0)
