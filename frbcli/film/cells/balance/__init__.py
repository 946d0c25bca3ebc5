"""The oil balances of the cells of one film, compiled; `plain.py` has the same in array notation."""
