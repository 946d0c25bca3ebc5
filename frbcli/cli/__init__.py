"""The command line: one thin command per file. click and rich live here and nowhere else."""
