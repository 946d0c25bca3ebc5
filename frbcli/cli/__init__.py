"""The command line: thin commands, those of a kind in one module. click and rich live here and nowhere else."""
