"""The mechanics of coilset: material, section, rod, contact, solid, problem, solvers, loading and results."""

from coilset.model.runtime.apart import load_apart
from coilset.model.runtime.libraries import load_in_order, load_lazily

load_apart()
load_lazily()
load_in_order()
