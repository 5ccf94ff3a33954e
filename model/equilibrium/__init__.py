"""How equilibrium is found: one vector of unknowns, its residual and tangent, Newton's method, and the walk along loads."""
