"""Elements between the shaft and the ground that are no films: one file and one row of `table.py` for each kind."""
