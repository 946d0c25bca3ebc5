"""Journals that tilt: their motion, flows and forces as kernels see them; lands, steady forces with derivatives."""
