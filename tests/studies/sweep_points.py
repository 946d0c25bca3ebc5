"""The points of short sweeps."""

from frbcli.studies.sweep import Workers

SHORT = ["film.theory=short", "speed.duration=0.3 s", "speed.to=250 Hz"]
VISCOSITIES = ["8 mPa*s", "12 mPa*s"]
CLEARANCES = ["30 um", "35 um"]
TWO = Workers(jobs=2)
