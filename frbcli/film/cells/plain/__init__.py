"""Films on finite-volume cells in array notation: the readable reference of the kernels, and the kinematic tests."""
