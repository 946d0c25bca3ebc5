"""Layers of the arrays in which the time loop keeps the state of films."""

from __future__ import annotations

# Layers of the films' state: unknown w now and at the start of the step before, oil H theta, its rate.
W, W_BEFORE, OIL, RATE, WET = range(5)
PASSED, NOW = range(2)  # layers of their oil: what has passed so far, and passes now
