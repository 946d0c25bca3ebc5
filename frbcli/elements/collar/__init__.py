"""A collar between the pads of its thrust bearing: its rest along the axis, its motion, and what holds it in tilt."""
