"""The mechanics of coilset, from the case to results and pages; docs/architecture.md describes its rooms."""

from coilset.model.core.runtime.apart import load_apart
from coilset.model.core.runtime.libraries import load_in_order, load_lazily

load_apart()
load_lazily()
load_in_order()
