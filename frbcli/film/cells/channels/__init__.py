"""Channels that couple the two films of a ring hydraulically."""
