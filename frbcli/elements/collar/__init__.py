"""A collar between the pads of its thrust bearing: where it rests along the axis, and what holds it in tilt."""
