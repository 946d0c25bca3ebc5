"""Limit cycles: where a whirl begins, how far it goes, where it ends."""
