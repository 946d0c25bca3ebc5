"""Motions with unbalance near the branches of limit cycles: synchronous ones, and whirls that lock in."""
