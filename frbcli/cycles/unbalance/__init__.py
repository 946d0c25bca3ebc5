"""Motions with the unbalance beside the branches of limit cycles: synchronous, and whirls that lock in."""
