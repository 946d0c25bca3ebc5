"""Limit cycles by shooting on the time loop: of films on cells, and with springs, stops and ball bearings."""
