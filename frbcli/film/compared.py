"""How often, and with how much finer films, the forces of a run are compared for their error."""

from __future__ import annotations

FINER = 2  # times the elements or cells each way
SAMPLES = 48  # states of a run
