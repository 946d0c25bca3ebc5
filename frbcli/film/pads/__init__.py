"""Films between a flat runner and the pads of a thrust bearing."""
