"""Limit cycles by shooting on the time loop: of finite-volume films, and with springs, stops and ball bearings."""
