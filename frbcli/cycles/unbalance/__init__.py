"""Motions with the unbalance beside the branches of limit cycles: synchronous, locked in, of two frequencies."""
