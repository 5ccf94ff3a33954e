"""Spring wires by name: one YAML file per standard beside this module, each number with its source and certainty."""

from coilset.model.tools.wires.library import names, wire
from coilset.model.tools.wires.wire import Wire

__all__ = ["Wire", "names", "wire"]
