"""The grid of a film in the time loop: its place, and the progress of its cells in a stage."""

from __future__ import annotations

from frbcli.film.cavitation.compiled import LAW_NUMBERS
from frbcli.film.cells.data import record

# A film in the loop: the angle at which its grid stands, and its speed; where the journal is in it (x, y); whether its
# cells balance (see OPEN); how far the journals were moved last, and that over the time before; the stage; of its
# openings, see fillings.py: their filling, and what the stages before make of it; the one before, and what it was off
# by; by how much less it is off per filling. Its law as follow_law has it.
GRID = record(
    ("turn", "f8"),
    ("speed", "f8"),
    ("x", "f8"),
    ("y", "f8"),
    ("moved", "f8"),
    ("ratio", "f8"),
    ("balance", "i8"),
    ("stage", "i8"),
    ("filling", "f8"),
    ("filling_past", "f8"),
    ("filling_before", "f8"),
    ("filling_off", "f8"),
    ("per_filling", "f8"),
    ("law", "f8", (LAW_NUMBERS,)),
)
