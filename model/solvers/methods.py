"""The iteration methods of chapter 4.4 as named sets of PETSc options; nothing of them is written by hand."""

DIRECT = {"ksp_type": "preonly", "pc_type": "lu"}

METHODS = {
    # Newton-Raphson (4.4.4)
    "newton": {"snes_type": "newtonls", "snes_linesearch_type": "bt", **DIRECT},
}


def options(method, ranks, extra=None):
    """PETSc options of a method; MUMPS factorises where there is more than one rank.

    Args:
        method: a key of METHODS.
        ranks: size of the communicator.
        extra: the user's own options, which win.
    """
    chosen = dict(METHODS[method])
    if ranks > 1:
        chosen["pc_factor_mat_solver_type"] = "mumps"
    else:
        chosen["pc_factor_mat_ordering_type"] = "natural"  # DOLFINx numbers a line along itself: the matrix is banded
    return chosen | (extra or {})
