"""How equilibrium is found: unknowns, their residual and tangent, Newton's method, and the walk along loads."""
