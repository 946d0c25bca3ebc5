"""Free gas that the oil of a film on cells carries: its balance, compiled and in array notation, and linearised."""
