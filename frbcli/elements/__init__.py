"""What acts on a machine besides its films: a class and a row of `table.py` for each kind of element."""
