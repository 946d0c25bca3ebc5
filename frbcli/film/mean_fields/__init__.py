"""Films whose openings turn, as the mean over their angle: the same from all sides, so that they can be tabulated."""
