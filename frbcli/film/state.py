"""Layers of the arrays in which the time loop keeps the state of films."""

from __future__ import annotations

# Layers of the films' state: unknown w now and at the start of the step before, oil H theta, its rate; where the oil of
# any film carries free gas, also that, H theta c, and its rate.
W, W_BEFORE, OIL, RATE, WET = range(5)
GAS, GAS_RATE, WET_WITH_GAS = range(WET, WET + 3)
PASSED, NOW = range(2)  # layers of their oil: what has passed so far, and passes now
