"""Switches of the savings at the start of a command; the results are the same without them.

`COILSET_WITHOUT` names the savings to leave out, separated by commas, or `all`. docs/scaling.md lists the time of each.
"""

import os

SAVINGS = {
    "compiler": "kernels are loaded without setting up numba's compiler",
    "bitcode": "the bitcode of a kernel is parsed only for a caller that is compiled",
    "imports": "the module of a kernel within another kernel is not imported",
    "modules": "modules that libraries import without using them are loaded when something of them is used",
    "linking": "MPI, PETSc and DOLFINx are linked by a second thread",
    "rich": "typer is loaded without rich",
}


def enabled(name: str) -> bool:
    """Whether a saving of SAVINGS is in use."""
    without = os.environ.get("COILSET_WITHOUT", "")
    return not without or not {name, "all"} & set(without.split(","))
