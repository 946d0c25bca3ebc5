"""Films whose gap changes along the axis, since their journal tilts: balances, lands, forces with derivatives."""
