"""The PETSc options that a case file may give, `solver.options`, and the plain values of each.

Others of PETSc run code, load libraries, write files or wait for connections. A case file is data: of a word only what
is listed here goes to PETSc, and no other option at all.
"""

from difflib import get_close_matches

from coilset.model.core.base.entry import shown

FLAG, WHOLE, NUMBER = "true or false", "a whole number", "a number"
PREFIXES = ("npc_", "sub_")  # of the solver that preconditions, and of those within blocks

Kind = str | tuple[str, ...]
"""FLAG, WHOLE or NUMBER, or the words to choose from."""

_SNES: dict[str, Kind] = {
    "type": ("newtonls", "newtontr", "newtontrdc", "newtonal", "qn", "anderson", "ngmres"),
    "convergence_test": ("default", "skip"),
    "norm_schedule": ("none", "always", "initialonly", "finalonly", "initialfinalonly"),
    "function_type": ("unpreconditioned", "preconditioned"),
    "npc_side": ("left", "right"),
    **dict.fromkeys(("rtol", "atol", "stol", "divergence_tolerance"), NUMBER),
    **dict.fromkeys(("max_it", "max_funcs", "max_fail", "max_linear_solve_fail"), WHOLE),
    **dict.fromkeys(("lag_jacobian", "lag_preconditioner"), WHOLE),
    **dict.fromkeys(("lag_jacobian_persists", "lag_preconditioner_persists", "force_iteration"), FLAG),
    "ksp_ew": FLAG,
    "ksp_ew_version": WHOLE,
    **{f"ksp_ew_{name}": NUMBER for name in ("rtol0", "rtolmax", "gamma", "alpha", "alpha2", "threshold")},
}
_SEARCH: dict[str, Kind] = {
    "type": ("basic", "bt", "cp", "l2", "secant", "nleqerr"),
    **dict.fromkeys(("order", "max_it"), WHOLE),
    **dict.fromkeys(("maxstep", "maxlambda", "minlambda", "damping", "alpha", "rtol", "atol", "ltol"), NUMBER),
    **dict.fromkeys(("keeplambda", "norms"), FLAG),
}
_QUASI_NEWTON: dict[str, Kind] = {
    "type": ("lbfgs", "broyden", "badbroyden"),
    "scale_type": ("default", "none", "scalar", "diagonal", "jacobian"),
    "restart_type": ("default", "none", "powell", "periodic"),
    "m": WHOLE,
    "powell_gamma": NUMBER,
}
_MIXING: dict[str, Kind] = {  # of the last states
    "restart_type": ("none", "periodic", "difference"),
    **dict.fromkeys(("m", "restart", "restart_it"), WHOLE),
}
_ARC: dict[str, Kind] = {
    "correction_type": ("exact", "normal"),
    "max_continuation_steps": WHOLE,
    **dict.fromkeys(("step_size", "psisq", "lambda_min", "lambda_max"), NUMBER),
    "scale_rhs": FLAG,
}
_REGION: dict[str, Kind] = {
    "fallback_type": ("newton", "cauchy", "dogleg"),
    **dict.fromkeys(("delta0", "deltamin", "deltamax", "eta1", "eta2", "eta3", "t1", "t2", "kmdc"), NUMBER),
}
_KSP: dict[str, Kind] = {
    "type": (
        *("preonly", "richardson", "cg", "cr", "minres", "gmres", "fgmres", "lgmres", "gcr"),
        *("bcgs", "ibcgs", "cgs", "tfqmr"),
    ),
    "norm_type": ("none", "preconditioned", "unpreconditioned", "natural"),
    "pc_side": ("left", "right", "symmetric"),
    **dict.fromkeys(("rtol", "atol", "divtol", "richardson_scale"), NUMBER),
    **dict.fromkeys(("max_it", "min_it", "gmres_restart", "gcr_restart"), WHOLE),
    **dict.fromkeys(("gmres_modifiedgramschmidt", "initial_guess_nonzero", "reuse_preconditioner"), FLAG),
}
_PC: dict[str, Kind] = {
    "type": ("lu", "cholesky", "ilu", "bjacobi", "asm", "gamg", "svd", "redundant", "none"),
    "factor_mat_solver_type": ("petsc", "mumps", "superlu", "superlu_dist", "umfpack", "klu"),
    "factor_mat_ordering_type": ("natural", "nd", "1wd", "rcm", "qmd", "amd", "rowlength"),
    "factor_shift_type": ("none", "nonzero", "positive_definite", "inblocks"),
    "asm_type": ("none", "restrict", "interpolate", "basic"),
    **dict.fromkeys(("factor_levels", "asm_overlap"), WHOLE),
    **dict.fromkeys(("factor_fill", "factor_shift_amount", "factor_zeropivot", "factor_column_pivot"), NUMBER),
    **dict.fromkeys(("factor_reuse_ordering", "factor_reuse_fill"), FLAG),
}
_GROUPS = {
    "snes": _SNES,
    "snes_linesearch": _SEARCH,
    "snes_qn": _QUASI_NEWTON,
    "snes_anderson": _MIXING | {"beta": NUMBER},
    "snes_ngmres": _MIXING | {"select_type": ("none", "difference", "linesearch")},
    "snes_newtonal": _ARC,
    "snes_tr": _REGION,
    "ksp": _KSP,
    "pc": _PC,
}
OPTIONS: dict[str, Kind] = {f"{group}_{name}": kind for group, part in _GROUPS.items() for name, kind in part.items()}


def bare(name: str) -> str:
    """The name of an option without PREFIXES."""
    while rest := next((name.removeprefix(prefix) for prefix in PREFIXES if name.startswith(prefix)), ""):
        name = rest
    return name


def plain(name: str, value: bool | int | float | str | None) -> bool | int | float | str:
    """The value of an option as PETSc gets it.

    Raises:
        ValueError: if a case file may not give this option, or not this value; its text is the rest of a line that
            begins with the option's name.
    """
    kind = OPTIONS.get(bare(name))
    if kind is None:
        near = get_close_matches(name, OPTIONS, 1, 0.8)
        hint = f"is {near[0]} meant?" if near else "docs/methods.md lists the options of a case file"
        raise ValueError(f"unknown entry; {hint}")
    if kind == FLAG and (isinstance(value, bool) or value is None):
        return value is not False
    if kind in (WHOLE, NUMBER) and isinstance(value, int | float) and not isinstance(value, bool):
        if kind == NUMBER:
            return value
        if value == int(value):
            return int(value)
    if not isinstance(kind, str) and isinstance(value, str) and value.lower() in kind:
        return value.lower()
    right = kind if isinstance(kind, str) else f"one of {', '.join(kind)}"
    raise ValueError(f"{shown(value)}: must be {right}")
