"""Is an equilibrium stable? From the tangent of a system: negative pivots and the lowest eigenvalue."""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh, splu

from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.matrix import TangentMatrix
from coilset.model.core.equilibrium.system.system import System


def tangent(system: System, load: Load) -> sparse.csc_array:
    """Symmetric part of the tangent at the last equilibrium, rows and columns of the unknowns that `load` leaves free.

    It is symmetric by itself where the charts of the rotations start, but for rounding. One rank only.
    """
    matrix = TangentMatrix(system.body, system.layout)
    system.tangent(system.layout.vector(), load, matrix, at_step_start=True)
    indptr, indices, values = matrix.mat.getValuesCSR()
    full = sparse.csr_array((values, indices, indptr))
    free = np.setdiff1d(np.arange(full.shape[0]), load.held)
    free = full[free][:, free]
    return sparse.csc_array(0.5 * (free + free.T))


def negative_pivots(matrix: sparse.csc_array) -> int:
    """Number of negative eigenvalues of a symmetric matrix, by Sylvester's law from L D Lᵀ without row exchange."""
    order = sparse.csgraph.reverse_cuthill_mckee(sparse.csr_matrix(matrix), symmetric_mode=True)
    banded = sparse.csc_matrix(matrix[order][:, order])
    options = {"permc_spec": "NATURAL", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    return int((splu(banded, **options).U.diagonal() < 0.0).sum())


def lowest_eigenvalue(matrix: sparse.csc_array) -> float:
    """The lowest eigenvalue of a symmetric matrix with at most three negative ones."""
    start = np.random.default_rng(0).standard_normal(matrix.shape[0])
    return float(eigsh(matrix, k=4, sigma=0.0, v0=start, return_eigenvectors=False).min())
