"""The exact solve on ranks against dense solves of NumPy's, for chains, windings that touch, and a seat."""

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from coilset.model.equilibrium import chain_lu
from coilset.model.equilibrium.chain_lu import ChainLU, ChainPC
from coilset.model.equilibrium.elimination import plan_elimination
from coilset.model.equilibrium.multifrontal import PartialLU

pytestmark = pytest.mark.mpi
COMM = MPI.COMM_WORLD
STATIONS, UNKNOWNS, WINDING = 60, 3, 9
SIZE = STATIONS * UNKNOWNS + 1  # the last one is a seat's


def made(touching: bool, symmetric: bool, shift: float = 0.0) -> np.ndarray:
    """A chain whose neighbours are coupled, windings where they touch, and the seat with the first winding."""
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


def solved(factors: ChainLU, right: np.ndarray) -> np.ndarray:
    """The whole solution on every rank."""
    mine = np.zeros(factors.stop - factors.start)
    factors.solve(right[factors.start : factors.stop], mine)
    return np.concatenate(COMM.allgather(mine))


@pytest.mark.parametrize("few", [0, 10**6], ids=["cheaper", "divided"])
@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("touching", [True, False])
def test_solution_is_that_of_a_dense_solve(touching, symmetric, few, monkeypatch):
    """Also after the entries change; the two ways of dividing the work agree with NumPy."""
    monkeypatch.setattr(chain_lu, "FEW", few)
    monkeypatch.setattr(chain_lu, "SMALL_SHARE", 0.0)
    matrix, right = made(touching, symmetric), np.random.default_rng(5).normal(size=SIZE)
    mat = distributed(matrix)
    factors = ChainLU(mat)
    for factor in (1.0, 2.5):
        assert factors.factorise()
        expected = np.linalg.solve(factor * matrix, right)
        np.testing.assert_allclose(solved(factors, right), expected, rtol=0, atol=1e-10 * np.abs(expected).max())
        mat.scale(2.5)


@pytest.mark.parametrize("touching", [True, False])
def test_interface_is_small(touching):
    """A cut of the chain couples a station, a winding where coils touch, and the seat of the first winding."""
    factors = ChainLU(distributed(made(touching, symmetric=True)))
    stations = (WINDING if touching else 1) * UNKNOWNS * (COMM.size - 1)
    assert len(factors.interface) == (stations + 1 if COMM.size > 1 else 0)


@pytest.mark.parametrize("shift", [0.0, 8.0, 30.0])
def test_negative_pivots_are_negative_eigenvalues(shift):
    """The inertia of all parts adds up to that of the whole (Haynsworth)."""
    matrix = made(touching=True, symmetric=True, shift=shift)
    expected = int((np.linalg.eigvalsh(matrix) < 0.0).sum())
    assert (expected > 0) == (shift > 0.0)
    factors = ChainLU(distributed(matrix))
    assert factors.factorise()
    assert factors.negative_pivots == expected


def test_two_solves_have_the_same_bits():
    matrix, right = made(touching=True, symmetric=False), np.random.default_rng(5).normal(size=SIZE)
    found = []
    for _solve in range(2):
        factors = ChainLU(distributed(matrix))
        assert factors.factorise()
        found.append(solved(factors, right))
    np.testing.assert_array_equal(*found)
    assert len({part.tobytes() for part in COMM.allgather(found[0])}) == 1


def test_a_singular_matrix_fails_the_solve_on_every_rank():
    """PETSc says so of the linear solver, and goes on with another matrix."""
    matrix = made(touching=False, symmetric=True)
    matrix[0], matrix[:, 0] = 0.0 * matrix[0], 0.0 * matrix[:, 0]
    matrix[0, 0] = 1.0
    mat = distributed(matrix)
    ksp = PETSc.KSP().create(COMM)
    ksp.setType(PETSc.KSP.Type.PREONLY)
    ksp.getPC().setType(PETSc.PC.Type.PYTHON)
    ksp.getPC().setPythonContext(ChainPC())
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


@pytest.mark.skipif(COMM.size > 1, reason="has no part on ranks")
def test_what_is_left_of_kept_unknowns_is_the_schur_complement():
    matrix = made(touching=True, symmetric=False)
    keep = np.zeros(SIZE, dtype=bool)
    keep[[5, 70, 71, 140, SIZE - 1]] = True
    pattern = (matrix != 0.0) | (matrix != 0.0).T
    indptr = np.append(0, np.cumsum(pattern.sum(axis=1)))
    factors = PartialLU(plan_elimination(indptr, np.nonzero(pattern)[1], keep))
    assert factors.factorise(matrix[pattern])
    kept, inner = factors.plan.order[-5:], np.flatnonzero(~keep)
    assert set(kept) == set(np.flatnonzero(keep))
    left = np.linalg.solve(matrix[np.ix_(inner, inner)], matrix[np.ix_(inner, kept)])
    expected = matrix[np.ix_(kept, kept)] - matrix[np.ix_(kept, inner)] @ left
    np.testing.assert_allclose(factors.schur, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_a_pattern_that_is_not_symmetric_is_refused():
    with pytest.raises(ValueError, match="not symmetric"):
        plan_elimination(np.array([0, 2, 3]), np.array([0, 1, 1]), np.zeros(2, dtype=bool))
