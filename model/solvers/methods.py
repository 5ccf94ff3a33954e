"""The iteration methods of chapter 4.4 as named sets of PETSc options; nothing of them is written by hand.

A method's matrix is the tangent; what differs is how often it is set up, and what is made of it in between. The methods
that keep it set it up anew after RENEWAL iterations in one step: where contacts close or a plastic spring is released,
one matrix for the whole step comes to no rest, as the thesis found (6.3). `snes_lag_jacobian: 1000000` keeps it.
"""

from difflib import get_close_matches

from coilset.model.errors import InputError

DIRECT = {"ksp_type": "preonly", "pc_type": "lu"}
RENEWAL = 10
# one Newton step; PETSc's Broyden and Anderson take no matrix of their own, but such a step as preconditioner
ONE_STEP = {
    "snes_type": "newtonls", "snes_max_it": 1, "snes_convergence_test": "skip", "snes_norm_schedule": "none", **DIRECT,
}  # fmt: skip
KEPT = {"snes_linesearch_type": "cp", "snes_lag_jacobian": RENEWAL, "snes_lag_jacobian_persists": True}
PRECONDITIONED = {f"npc_{key}": value for key, value in (ONE_STEP | KEPT).items()}

METHODS = {
    # Newton-Raphson (4.4.4)
    # its corrections are scaled by coilset.model.solvers.damping
    "newton": {"snes_type": "newtonls", "snes_linesearch_type": "basic", "snes_max_it": 30, **DIRECT},
    # (4.4.5), with a line search for the zero of the out-of-balance work along the direction
    "modified-newton": {
        "snes_type": "newtonls", "snes_linesearch_type": "cp", "snes_lag_jacobian": RENEWAL, "snes_max_it": 100,
        **DIRECT,
    },
    # the same made faster by mixing the last states; with one of them it is Aitken's acceleration for vectors
    "modified-newton-anderson": {"snes_type": "anderson", "snes_anderson_m": 10, "snes_max_it": 100, **PRECONDITIONED},
    # Matthies and Strang (4.4.6-4.4.13), with the line search on the out-of-balance work
    "bfgs": {
        "snes_type": "qn", "snes_qn_type": "lbfgs", "snes_qn_scale_type": "jacobian", "snes_qn_m": RENEWAL,
        "snes_qn_restart_type": "periodic", "snes_linesearch_type": "cp", "snes_max_it": 100, **DIRECT,
    },
    "broyden": {
        "snes_type": "qn", "snes_qn_type": "broyden", "snes_qn_m": 5, "snes_qn_restart_type": "periodic",
        "snes_linesearch_type": "cp", "snes_max_it": 100, "snes_npc_side": "left",
        "snes_function_type": "unpreconditioned", **PRECONDITIONED, "npc_snes_lag_jacobian": 5,
    },
    # the share of the load as one more unknown: goes past limit points within a step; the arc is one of displacements
    "arc-length": {"snes_type": "newtonal", "snes_newtonal_psisq": 0.0, "snes_max_it": 30, **DIRECT},
}  # fmt: skip


def check_method(method):
    """Raise InputError if there is no method of this name."""
    if method not in METHODS:
        near = get_close_matches(str(method), METHODS, 1)
        hint = f"; is {near[0]} meant?" if near else ""
        raise InputError(f"'{method}' is no iteration method; there are {', '.join(METHODS)}{hint}", "solver.method")


def options(method, ranks, extra=None):
    """PETSc options of a method; MUMPS factorises where there is more than one rank.

    Args:
        method: a key of METHODS.
        ranks: size of the communicator.
        extra: more options, which win.

    Raises:
        InputError: if there is no such method.
    """
    check_method(method)
    # a line search that finds nothing must not pass for a small step: stol = 0
    chosen = {"snes_stol": 0.0} | METHODS[method]
    prefix = "npc_" if "npc_pc_type" in chosen else ""
    if ranks > 1:
        chosen[f"{prefix}pc_factor_mat_solver_type"] = "mumps"
    else:  # DOLFINx numbers a line along itself: the matrix is banded, and its factors have 1.2 times its entries
        chosen |= {f"{prefix}pc_factor_mat_ordering_type": "natural", f"{prefix}pc_factor_fill": 1.3}
    return chosen | (extra or {})
