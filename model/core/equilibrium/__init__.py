"""Finding equilibrium: unknowns, residual and tangent, Newton's method, and continuation along a load path."""
