"""Free gas that the oil of a finite-volume film carries: its balance, compiled, and linearised."""
