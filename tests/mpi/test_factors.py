"""LU on one and several ranks against dense solves of NumPy's, for chains, windings in contact, and a seat."""

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from coilset.model.core.equilibrium.system.factors import FILL_REDUCING, NATURAL, GatheredLU, lu, negative_pivots

pytestmark = pytest.mark.mpi
COMM = MPI.COMM_WORLD
STATIONS, UNKNOWNS, WINDING = 60, 3, 9
SIZE = STATIONS * UNKNOWNS + 1  # the last one is a seat's


def made(touching: bool, symmetric: bool, shift: float = 0.0) -> np.ndarray:
    """A chain whose neighbours are coupled, windings in contact, and the seat with the first winding."""
    rng, matrix = np.random.default_rng(3), np.zeros((SIZE, SIZE))

    def couple(unknowns: np.ndarray) -> None:
        block = rng.normal(size=(len(unknowns), len(unknowns)))
        block = block @ block.T if symmetric else block + 3.0 * len(unknowns) * np.eye(len(unknowns))
        matrix[np.ix_(unknowns, unknowns)] += block

    def of(*stations: int) -> np.ndarray:
        return np.concatenate([UNKNOWNS * station + np.arange(UNKNOWNS) for station in stations])

    for station in range(STATIONS - 1):
        couple(of(station, station + 1))
        if touching and station + WINDING < STATIONS:
            couple(of(station, station + WINDING))
    for station in range(WINDING):
        couple(np.append(of(station), SIZE - 1))
    return matrix - shift * np.diag(np.arange(SIZE) % 7 == 0)


def distributed(matrix: np.ndarray) -> PETSc.Mat:
    """The matrix with a piece of the chain on each rank, and the seat on the last."""
    cuts = UNKNOWNS * (STATIONS * np.arange(COMM.size + 1) // COMM.size)
    cuts[-1] = SIZE
    rows = matrix[cuts[COMM.rank] : cuts[COMM.rank + 1]]
    pattern = rows != 0.0
    indptr = np.append(0, np.cumsum(pattern.sum(axis=1))).astype(PETSc.IntType)
    csr = indptr, np.nonzero(pattern)[1].astype(PETSc.IntType), rows[pattern]
    return PETSc.Mat().createAIJ(((len(rows), SIZE), (len(rows), SIZE)), csr=csr, comm=COMM)


def solved(factors: PETSc.PC, mat: PETSc.Mat, right: np.ndarray) -> np.ndarray:
    """The whole solution on every rank."""
    x, b = mat.createVecs()
    b.getArray()[:] = right[slice(*b.getOwnershipRange())]
    factors.apply(b, x)
    return np.concatenate(COMM.allgather(x.getArray().copy()))


@pytest.mark.parametrize("ordering", [NATURAL, FILL_REDUCING])
@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("touching", [True, False])
def test_solution_is_that_of_a_dense_solve(touching, symmetric, ordering):
    """Also after the entries change; found 2e-14 of the largest entry."""
    matrix, right = made(touching, symmetric), np.random.default_rng(5).normal(size=SIZE)
    mat = distributed(matrix)
    factors = lu(mat, ordering)
    for factor in (1.0, 2.5):
        factors.setUp()
        expected = np.linalg.solve(factor * matrix, right)
        np.testing.assert_allclose(solved(factors, mat, right), expected, rtol=0, atol=1e-10 * np.abs(expected).max())
        mat.scale(2.5)
        factors.setOperators(mat)


@pytest.mark.parametrize("ordering", [NATURAL, FILL_REDUCING])
@pytest.mark.parametrize("shift", [0.0, 8.0, 30.0])
def test_negative_pivots_are_negative_eigenvalues(shift, ordering):
    matrix = made(touching=True, symmetric=True, shift=shift)
    expected = int((np.linalg.eigvalsh(matrix) < 0.0).sum())
    assert (expected > 0) == (shift > 0.0)
    factors = lu(distributed(matrix), ordering)
    factors.setUp()
    assert negative_pivots(factors) == expected


def test_other_factors_show_no_pivots():
    factors = PETSc.PC().create(COMM)
    factors.setType(PETSc.PC.Type.JACOBI)
    factors.setOperators(distributed(made(touching=False, symmetric=True)))
    factors.setUp()
    assert negative_pivots(factors) is None


def test_two_solves_have_the_same_bits():
    matrix, right = made(touching=True, symmetric=False), np.random.default_rng(5).normal(size=SIZE)
    solutions = []
    for _solve in range(2):
        mat = distributed(matrix)
        factors = lu(mat, FILL_REDUCING)
        factors.setUp()
        solutions.append(solved(factors, mat, right))
    np.testing.assert_array_equal(*solutions)
    assert len({part.tobytes() for part in COMM.allgather(solutions[0])}) == 1


def test_a_singular_matrix_fails_the_solve_on_every_rank():
    """PETSc reports it as the linear solver's reason, and continues with another matrix."""
    matrix = made(touching=False, symmetric=True)
    matrix[0], matrix[:, 0] = 0.0 * matrix[0], 0.0 * matrix[:, 0]
    matrix[0, 0] = 1.0
    mat = distributed(matrix)
    ksp = PETSc.KSP().create(COMM)
    ksp.setType(PETSc.KSP.Type.PREONLY)
    ksp.getPC().setType(PETSc.PC.Type.PYTHON)
    ksp.getPC().setPythonContext(GatheredLU())
    ksp.setOperators(mat)
    x, b = mat.createVecs()
    b.set(1.0)
    reasons = []
    for value in (1.0, 0.0, 1.0):
        if COMM.rank == 0:
            mat.setValue(0, 0, value)
        mat.assemble()
        ksp.solve(b, x)
        reasons.append(ksp.getConvergedReason())
    assert reasons[1] == PETSc.KSP.ConvergedReason.DIVERGED_PCSETUP_FAILED
    assert reasons[0] > 0
    assert reasons[2] > 0
