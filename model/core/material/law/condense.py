"""Any three-dimensional law as that of a fibre: the other three stresses are brought to zero at each point (de Borst).

With the strains of the fibre e = (ε11, γ12, γ13) given, those across it, f = (ε22, ε33, γ23), follow from
σ_f(e, f) = 0 by Newton's method, f ← f − C_ff⁻¹ σ_f. At the solution the stresses σ_e change with e by

    C = C_ee − C_ef C_ff⁻¹ C_fe,

the consistent tangent if that of the three-dimensional law is. Nothing of f is kept: σ_f is zero at the start of the
next increment too. R. de Borst, The zero-normal-stress condition in plane-stress and shell elastoplasticity, Commun.
Appl. Numer. Methods 7 (1991) 29.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from coilset.model.core.runtime.kernels import njit

ITERATIONS, TOLERANCE = 30, 1e-12  # of the other stresses, over the greatest stress or modulus times strain
ALONG, ACROSS = np.array([0, 3, 4]), np.array([1, 2, 5])  # of 11, 22, 33, 12, 13, 23


def condense(law3d: Callable[..., bool]) -> Callable[..., bool]:
    """The law of a fibre, for `coilset.api.Law`, from one of the six stresses.

    Args:
        law3d: as `update` of `coilset.api.Law` with six components in the order 11, 22, 33, 12, 13, 23, engineering
            shear strains, and a tangent of shape (6, 6); plain Python that numba can compile, or compiled.
    """
    inner: Any = law3d if hasattr(law3d, "py_func") else njit(error_model="numpy")(law3d)

    @njit(error_model="numpy")
    def update(
        stress: np.ndarray,
        state: np.ndarray,
        strain: np.ndarray,
        parameters: np.ndarray,
        new_stress: np.ndarray,
        new_state: np.ndarray,
        tangent: np.ndarray,
    ) -> bool:
        old, increment, new, C = np.zeros(6), np.zeros(6), np.empty(6), np.empty((6, 6))
        for i in range(3):
            old[ALONG[i]], increment[ALONG[i]] = stress[i], strain[i]
        inverse, solved = np.empty((3, 3)), False
        for _iteration in range(ITERATIONS):
            if not inner(old, state, increment, parameters, new, new_state, C):
                return False
            largest = stiffest = left = moved = 0.0
            for i in range(6):
                largest, moved = max(largest, abs(new[i])), max(moved, abs(increment[i]))
                stiffest = max(stiffest, abs(C[i, i]))
            for i in range(3):
                left = max(left, abs(new[ACROSS[i]]))
                for j in range(3):  # of C_ff by its cofactors
                    a, b, c, d = ACROSS[(j + 1) % 3], ACROSS[(j + 2) % 3], ACROSS[(i + 1) % 3], ACROSS[(i + 2) % 3]
                    inverse[i, j] = C[a, c] * C[b, d] - C[a, d] * C[b, c]
            determinant = 0.0
            for i in range(3):
                determinant += C[ACROSS[0], ACROSS[i]] * inverse[i, 0]
            if determinant == 0.0:
                return False
            if left <= TOLERANCE * max(largest, stiffest * moved):
                solved = True
                break
            for i in range(3):
                for j in range(3):
                    increment[ACROSS[i]] -= inverse[i, j] * new[ACROSS[j]] / determinant
        for i in range(3):
            new_stress[i] = new[ALONG[i]]
            for j in range(3):
                tangent[i, j] = C[ALONG[i], ALONG[j]]
                for k in range(3):
                    for m in range(3):
                        part = inverse[k, m] * C[ACROSS[m], ALONG[j]] / determinant
                        tangent[i, j] -= C[ALONG[i], ACROSS[k]] * part
        return solved

    return update
