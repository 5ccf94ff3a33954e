"""PETSc options of the solid's solvers, by name."""

from coilset.model.errors import InputError

_NEWTON = {"snes_type": "newtonls", "snes_linesearch_type": "bt", "snes_max_it": 25, "snes_max_linear_solve_fail": 1}

_MULTIGRID = {
    **_NEWTON,
    "ksp_rtol": 1e-5,
    "ksp_max_it": 1000,
    "pc_mg_galerkin": "none",
    "mg_levels_ksp_type": "richardson",
    "mg_levels_ksp_max_it": 1,
    "mg_levels_pc_type": "sor",
    "mg_coarse_ksp_type": "preonly",
    "mg_coarse_pc_type": "gamg",
    "mg_coarse_pc_gamg_threshold": 0.02,
    "mg_coarse_pc_gamg_aggressive_coarsening": 0,
    "mg_coarse_pc_gamg_coarse_eq_limit": 200,
    "mg_coarse_pc_gamg_reuse_interpolation": False,
    # a lone node in an aggregate has no six modes: Jacobi and a pseudo-inverse pass over the zero rows that leaves
    "mg_coarse_mg_levels_pc_type": "jacobi",
    "mg_coarse_mg_levels_ksp_max_it": 4,
    "mg_coarse_mg_coarse_pc_type": "redundant",
    "mg_coarse_mg_coarse_redundant_pc_type": "svd",
}

# `multigrid` is `multigrid.VertexMultigrid` with the full tangent. The one with conjugate gradients needs symmetric
# moduli and less memory; without hardening Newton's method then stalls, because the skew part, of the order of the
# stress, is no longer small beside the shear moduli that are left.
OPTIONS = {
    "direct": {**_NEWTON, "ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"},
    "multigrid": {**_MULTIGRID, "ksp_type": "gmres", "ksp_gmres_restart": 80, "ksp_pc_side": "right"},
    "multigrid-cg": {**_MULTIGRID, "ksp_type": "cg", "ksp_norm_type": "unpreconditioned"},
}
SYMMETRIC = ("multigrid-cg",)

# Above this number of unknowns a factorisation of a compact body costs more than multigrid.
DIRECT_LIMIT = 60_000


def choose(name, unknowns):
    """Options of a solver.

    Args:
        name: ``direct``, ``multigrid``, ``multigrid-cg``, or ``auto`` to choose by size.
        unknowns: their number.

    Returns:
        The solver's name and its PETSc options, a dict.

    Raises:
        InputError: if there is no such solver.
    """
    if name == "auto":
        name = "direct" if unknowns <= DIRECT_LIMIT else "multigrid"
    if name not in OPTIONS:
        raise InputError(f"'{name}' is no solver of the solid; give auto or {', '.join(OPTIONS)}", "solver")
    return name, dict(OPTIONS[name])
