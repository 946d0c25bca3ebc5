"""Artificial diffusion of the published two-phase form on finite volumes, compiled and plain."""
