"""The mechanics of coilset: material, section, rod, contact, solid, problem, solvers, loading and results."""
