"""One step: PETSc's SNES in all iteration variants, line search, the convergence test and the outcome."""
