"""How oil enters a film: one file for each kind of supply and one row of a table, which says what others ask of it."""
