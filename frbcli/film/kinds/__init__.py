"""The kinds of films that a machine can have: one file each, all behind the contract of contract.py."""
