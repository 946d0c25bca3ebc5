"""What acts on a machine beside its films: given coefficients (a row of `table.py`), supports of bearings, forces."""
