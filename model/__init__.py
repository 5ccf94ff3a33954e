"""The mechanics of coilset: material, section, rod, contact, solid, problem, solvers, loading and results."""

from coilset.model.caches import keep_by_content

keep_by_content()
