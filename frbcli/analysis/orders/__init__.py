"""Revolutions, orders and resonances."""
