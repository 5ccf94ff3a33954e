"""How equilibrium is found: unknowns, residual and tangent, Newton's method, and the way along a path of loads."""
