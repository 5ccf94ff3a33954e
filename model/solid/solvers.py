"""PETSc options of the solid's solvers, by name."""

from coilset.model.errors import InputError

_NEWTON = {"snes_type": "newtonls", "snes_linesearch_type": "bt", "snes_max_it": 25, "snes_max_linear_solve_fail": 1}

# `direct` factorises and takes the full tangent. `multigrid` is conjugate gradients, for which the moduli are made symmetric
# (their skew part is of the order of stress over stiffness), with smoothed aggregation about the rigid modes.
OPTIONS = {
    "direct": {**_NEWTON, "ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"},
    "multigrid": {
        **_NEWTON,
        "ksp_type": "cg",
        "ksp_rtol": 1e-6,
        "ksp_max_it": 1000,
        "pc_type": "gamg",
        "pc_gamg_type": "agg",
        "pc_gamg_agg_nsmooths": 1,
        "pc_gamg_threshold": 0.02,
        "pc_gamg_aggressive_coarsening": 0,
        "pc_gamg_coarse_eq_limit": 1000,
        "mg_levels_ksp_type": "chebyshev",
        "mg_levels_ksp_max_it": 2,
        "mg_levels_pc_type": "jacobi",
        "mg_levels_esteig_ksp_type": "cg",
        "mg_levels_esteig_ksp_max_it": 20,
        "mg_coarse_pc_type": "redundant",
    },
}

# Above this number of unknowns a factorisation of a compact body costs more than conjugate gradients with multigrid.
DIRECT_LIMIT = 60_000


def choose(name, unknowns):
    """Options of a solver.

    Args:
        name: ``direct``, ``multigrid``, or ``auto`` to choose by size.
        unknowns: their number.

    Returns:
        The solver's name and its PETSc options, a dict.

    Raises:
        InputError: if there is no such solver.
    """
    if name == "auto":
        name = "direct" if unknowns <= DIRECT_LIMIT else "multigrid"
    if name not in OPTIONS:
        raise InputError(f"'{name}' is no solver of the solid; give auto, {' or '.join(OPTIONS)}", "solver")
    return name, dict(OPTIONS[name])
