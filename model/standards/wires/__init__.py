"""Spring wires by name: a YAML file a standard beside this module, each number with its source and how sure it is."""

from coilset.model.standards.wires.library import names, wire
from coilset.model.standards.wires.wire import Wire

__all__ = ["Wire", "names", "wire"]
