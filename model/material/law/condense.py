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
from numba import njit

ITERATIONS, TOLERANCE = 30, 1e-11  # of the other stresses, over the greatest entry of C times the strain, or the stress
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
        right, block, solved = np.empty((3, 4)), np.empty((3, 3)), False
        for _iteration in range(ITERATIONS):
            if not inner(old, state, increment, parameters, new, new_state, C):
                return False
            size = max(np.abs(new).max(), np.abs(C).max() * np.abs(increment).max())
            left = 0.0
            for i in range(3):
                right[i, 3] = new[ACROSS[i]]
                left = max(left, abs(new[ACROSS[i]]))
                for j in range(3):
                    block[i, j], right[i, j] = C[ACROSS[i], ACROSS[j]], C[ACROSS[i], ALONG[j]]
            solution = np.linalg.solve(block, right)  # C_ff⁻¹ (C_fe, σ_f)
            if left <= TOLERANCE * size:
                solved = True
                break
            for i in range(3):
                increment[ACROSS[i]] -= solution[i, 3]
        for i in range(3):
            new_stress[i] = new[ALONG[i]]
            for j in range(3):
                tangent[i, j] = C[ALONG[i], ALONG[j]]
                for k in range(3):
                    tangent[i, j] -= C[ALONG[i], ACROSS[k]] * solution[k, j]
        return solved

    return update
