"""Limit cycles of mass-conserving films, by shooting on the time loop."""
