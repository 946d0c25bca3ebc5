"""What acts on a machine besides its films: a file and a row of `table.py` for each kind of element."""
