"""PETSc's LU factors of a tangent, on one and several ranks, and the signs of their pivots."""

import numpy as np
from petsc4py import PETSc

NATURAL = "natural"  # PETSc's names of orders of elimination
FILL_REDUCING = "amd" if PETSc.Sys.hasExternalPackage("amd") else "qmd"


class GatheredLU:
    """A preconditioner of PETSc's type `python`: every rank gathers the whole matrix and factorises it with PETSc's LU.

    PETSc's `redundant` does the same, but gives no access to its factors, whose signs `stability` needs. All ranks have
    the same factors, and the same solution to the bit.

    Attributes:
        ordering: PETSc's name of the order of elimination, the same on all ranks; to be set before the first `setUp`.
        factors: PETSc's LU; None before the first `setUp`.
    """

    def __init__(self) -> None:
        self.ordering = FILL_REDUCING
        self.factors: PETSc.PC | None = None
        self._matrix: PETSc.Mat | None = None

    def setUp(self, pc: PETSc.PC) -> None:
        """Gather and factorise; collective."""
        distributed = pc.getOperators()[1]
        self._matrix = distributed.getRedundantMatrix(distributed.getComm().size, PETSc.COMM_SELF, out=self._matrix)
        if self.factors is None:
            self.factors = lu(self._matrix, self.ordering)
            self._sizes = np.diff(distributed.getOwnershipRanges())
            self._right, self._solution = self._matrix.createVecs()
        self.factors.setUp()
        pc.setFailedReason(self.factors.getFailedReason())

    def apply(self, pc: PETSc.PC, right: PETSc.Vec, out: PETSc.Vec) -> None:
        """Solve; collective."""
        assert self.factors is not None  # PETSc sets up before
        gathered = self._right.getArray(), self._sizes
        right.getComm().tompi4py().Allgatherv(right.getArray(readonly=True), gathered)
        self.factors.apply(self._right, self._solution)
        out.getArray()[:] = self._solution.getArray(readonly=True)[slice(*out.getOwnershipRange())]

    def reset(self, pc: PETSc.PC) -> None:
        """Discard the factors and their pattern."""
        self.factors = self._matrix = None


def lu(matrix: PETSc.Mat, ordering: str) -> PETSc.PC:
    """PETSc's LU of a matrix, which `setUp` factorises: on one rank its own, on several GatheredLU.

    Args:
        matrix: of any communicator.
        ordering: PETSc's name of the order of elimination.
    """
    pc = PETSc.PC().create(matrix.getComm())
    if matrix.getComm().size > 1:
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(GatheredLU())
    else:
        pc.setType(PETSc.PC.Type.LU)
    order(pc, ordering)
    pc.setOperators(matrix)
    return pc


def order(pc: PETSc.PC, ordering: str) -> None:
    """Set the order of elimination of an LU; other preconditioners are left alone."""
    if pc.getType() == PETSc.PC.Type.LU:
        pc.setFactorOrdering(ordering)
    elif pc.getType() == PETSc.PC.Type.PYTHON and isinstance(pc.getPythonContext(), GatheredLU):
        pc.getPythonContext().ordering = ordering


def negative_pivots(pc: PETSc.PC) -> int | None:
    """Number of negative pivots of the factors of PETSc's own LU, of any rank; None of other factors.

    Without pivoting, those of a symmetric matrix are as many as its negative eigenvalues (Sylvester).
    """
    if pc.getType() == PETSc.PC.Type.PYTHON and isinstance(pc.getPythonContext(), GatheredLU):
        pc = pc.getPythonContext().factors
    if pc.getType() != PETSc.PC.Type.LU or pc.getFactorSolverType() != PETSc.Mat.SolverType.PETSC:
        return None
    return int(np.count_nonzero(pc.getFactorMatrix().getDiagonal().getArray(readonly=True) < 0.0))
