"""Films on quadratic elements, two-dimensional and with bores anywhere, fast enough for a time loop."""
