"""Limit cycles of films that keep their oil, by shooting on the time loop."""
