"""Signs of pivots, weakest modes, snap-through."""
