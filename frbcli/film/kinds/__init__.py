"""The kinds of films that a machine can have, all behind the contract of contract.py."""
