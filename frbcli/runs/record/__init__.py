"""Records of a run, and how it is resumed from them."""
