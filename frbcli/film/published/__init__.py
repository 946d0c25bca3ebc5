"""The two-phase model as published (4.31): quadratic elements, artificial diffusion; it does not conserve oil."""
