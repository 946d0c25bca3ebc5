"""Files on disk: where they may lie, how they are written, what is in them."""
