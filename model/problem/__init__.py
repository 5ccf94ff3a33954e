"""The nonlinear system that PETSc sees: one vector, its residual, its tangent, and the state behind it."""
