"""The iteration methods as named sets of PETSc options: those of chapter 4.4 for the rod, Newton's for the solid.

Only the step length of `newton` is our own code, see coilset.model.core.equilibrium.newton.line_search.

A method's matrix is the tangent; the methods differ in how often it is assembled, and how it is modified in between.
Those that keep it renew it after RENEWAL iterations within a step: when contacts close or a plastic spring is released,
a single matrix for the whole step does not converge, as the thesis found (6.3). `snes_lag_jacobian: 1000000` keeps it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from coilset.model.core.base.compat import LONGEST_STEP
from coilset.model.core.base.errors import InputError

DIRECT = {"ksp_type": "preonly", "pc_type": "lu"}
ON_RANKS = "coilset.model.core.equilibrium.system.factors.GatheredLU"
RENEWAL = 10
FEW = 3  # of Broyden's method: with five, it does not pass the closing of coils that are as stiff as E/4 or E/10
# The zero of the out-of-balance work may lie beyond a whole correction: PETSc's searches may lengthen it at will.
UNLIMITED = {LONGEST_STEP: 1e8}
# one Newton step: PETSc's Broyden and Anderson methods use no matrix, but such a step as a preconditioner
ONE_STEP = {
    "snes_type": "newtonls",
    "snes_max_it": 1,
    "snes_convergence_test": "skip",
    "snes_norm_schedule": "none",
    **DIRECT,
}
KEPT = {"snes_linesearch_type": "cp", **UNLIMITED, "snes_lag_jacobian": RENEWAL, "snes_lag_jacobian_persists": True}
PRECONDITIONED = {f"npc_{key}": value for key, value in (ONE_STEP | KEPT).items()}

FIRST = {**ONE_STEP, "snes_linesearch_type": "basic"}  # only meets the prescribed increments

METHODS: dict[str, dict[str, Any]] = {  # each MethodName
    # Newton-Raphson (4.4.4)
    # its corrections are scaled by coilset.model.core.equilibrium.newton.line_search
    "newton": {"snes_type": "newtonls", "snes_linesearch_type": "basic", **UNLIMITED, "snes_max_it": 30, **DIRECT},
    # (4.4.5), with a line search for the zero of the out-of-balance work along the direction
    "modified-newton": {
        "snes_type": "newtonls",
        "snes_linesearch_type": "cp",
        **UNLIMITED,
        "snes_lag_jacobian": RENEWAL,
        "snes_max_it": 100,
        **DIRECT,
    },
    # the same, accelerated by mixing the last states; with one of them it is Aitken's method for vectors
    "modified-newton-anderson": {
        "snes_type": "anderson",
        "snes_anderson_m": 10,
        **UNLIMITED,
        "snes_max_it": 100,
        **PRECONDITIONED,
    },
    # Matthies and Strang (4.4.6-4.4.13), with the line search on the out-of-balance work
    "bfgs": {
        "snes_type": "qn",
        "snes_qn_type": "lbfgs",
        "snes_qn_scale_type": "jacobian",
        "snes_qn_m": RENEWAL,
        "snes_qn_restart_type": "periodic",
        "snes_linesearch_type": "cp",
        **UNLIMITED,
        "snes_max_it": 100,
        **DIRECT,
    },
    "broyden": {
        "snes_type": "qn",
        "snes_qn_type": "broyden",
        "snes_qn_m": FEW,
        "snes_qn_restart_type": "periodic",
        "snes_linesearch_type": "cp",
        **UNLIMITED,
        "snes_max_it": 100,
        "snes_npc_side": "left",
        "snes_function_type": "unpreconditioned",
        **PRECONDITIONED,
        "npc_snes_lag_jacobian": FEW,
    },
    # the load factor as one more unknown: passes limit points within a step; the arc is measured in displacements
    "arc-length": {"snes_type": "newtonal", "snes_newtonal_psisq": 0.0, "snes_max_it": 30, **DIRECT},
}


ARC_LENGTH = "newtonal"  # SNES type
FORGETFUL = ("newtonls", "newtontr")  # SNES types without memory between steps

_SOLID = {"snes_type": "newtonls", "snes_linesearch_type": "bt", "snes_max_it": 25, "snes_max_linear_solve_fail": 1}
_MULTIGRID = {
    **_SOLID,
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

# `multigrid` is that of `solid/multigrid.py` with the full tangent. The one with conjugate gradients needs symmetric
# moduli and less memory; without hardening Newton's method then stalls, because the skew part, of the order of the
# stress, is no longer small beside the shear moduli that are left.
SOLID_METHODS = {
    "direct": {**_SOLID, "ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"},
    "multigrid": {**_MULTIGRID, "ksp_type": "gmres", "ksp_gmres_restart": 80, "ksp_pc_side": "right"},
    "multigrid-cg": {**_MULTIGRID, "ksp_type": "cg", "ksp_norm_type": "unpreconditioned"},
}
MULTIGRID = "multigrid"  # how the names of those begin that correct at the vertices first
SYMMETRIC = ("multigrid-cg",)
DIRECT_LIMIT = 60_000  # unknowns above which a factorisation of a compact body costs more than multigrid


@dataclass(frozen=True)
class Method:
    """A method with all its options.

    Attributes:
        name: of the method.
        options: PETSc's, without a leading hyphen.
        of_the_user: names of those that the user gave.
    """

    name: str
    options: Mapping[str, Any]
    of_the_user: frozenset[str] = frozenset()

    @property
    def searches(self) -> bool:
        """Whether corrections are scaled by our own search; not if the user selects one of PETSc's line searches."""
        return self.name == "newton" and "snes_linesearch_type" not in self.of_the_user

    @property
    def own_test(self) -> bool:
        """Whether PETSc's own test, if the user selects it, replaces (6.3.1)."""
        return "snes_convergence_test" in self.of_the_user

    @property
    def is_arc_length(self) -> bool:
        """Whether the load factor is one more unknown."""
        return self.options.get("snes_type") == ARC_LENGTH

    @property
    def remembers(self) -> bool:
        """Whether it keeps vectors from one step to the next, which must be discarded."""
        return self.options.get("snes_type") not in FORGETFUL

    @property
    def factorisation(self) -> dict[str, Any]:
        """Options of its linear solver, or of that of its preconditioning step."""
        bare = {key.removeprefix("npc_"): value for key, value in self.options.items()}
        return {key: value for key, value in bare.items() if key.startswith(("ksp_", "pc_"))}


def check_method(method: str) -> None:
    """Raise InputError if there is no method of this name."""
    if method not in METHODS:
        near = get_close_matches(str(method), METHODS, 1)
        hint = f"; is {near[0]} meant?" if near else ""
        raise InputError(
            f"'{method}' is not an iteration method; choose from {', '.join(METHODS)}{hint}", "solver.method"
        )


def rod_method(name: str, ranks: int, extra: Mapping[str, Any] | None = None, arc: float | None = None) -> Method:
    """A method for rods; GatheredLU factorises where there is more than one rank.

    Args:
        name: a key of METHODS.
        ranks: size of the communicator.
        extra: further options, which take precedence.
        arc: length of a step of the arc-length method, mm.

    Raises:
        InputError: if there is no such method.
    """
    check_method(name)
    chosen = {"snes_stol": 0.0} | METHODS[name]  # a failed line search must not count as a small step
    prefix = "npc_" if "npc_pc_type" in chosen else ""
    if ranks > 1:
        chosen |= {f"{prefix}pc_type": "python", f"{prefix}pc_python_type": ON_RANKS}
    else:  # DOLFINx numbers a line along itself: the matrix is banded, and its factors have 1.2 times its entries
        chosen |= {f"{prefix}pc_factor_mat_ordering_type": "natural", f"{prefix}pc_factor_fill": 1.3}
    if name == "arc-length" and arc is not None:
        chosen["snes_newtonal_step_size"] = arc
    return Method(name, chosen | dict(extra or {}), frozenset(extra or ()))


def solid_method(
    name: str, unknowns: int, extra: Mapping[str, Any] | None = None, *, free_vertices: bool = True
) -> Method:
    """A method for solids.

    Args:
        name: a key of SOLID_METHODS, or ``auto`` to choose by size.
        unknowns: their number.
        extra: further options, which take precedence.
        free_vertices: whether any vertex of the mesh may move; multigrid's coarse space holds these alone.

    Raises:
        InputError: if there is no such method, or if it finds nothing to coarsen to.
    """
    if name == "auto":
        name = "direct" if unknowns <= DIRECT_LIMIT or not free_vertices else "multigrid"
    if name not in SOLID_METHODS:
        raise InputError(f"'{name}' is not a solver of the solid; give auto or {', '.join(SOLID_METHODS)}", "solver")
    if name.startswith(MULTIGRID) and not free_vertices:
        raise InputError(
            f"'{name}' needs two layers of elements or more, since the heads hold all vertices of one; "
            "give direct or auto, or more layers",
            "solver",
        )
    return Method(name, SOLID_METHODS[name] | dict(extra or {}), frozenset(extra or ()))
