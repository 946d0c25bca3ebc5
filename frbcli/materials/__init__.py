"""Properties of oils and solids over temperature, by name, each figure with its source."""
