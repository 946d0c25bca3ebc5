"""The oil balances of the cells of one film, compiled; in array notation: tests/helpers/plain_balances.py."""
