"""The command line: thin commands, grouped by kind. click and rich live here and nowhere else."""
