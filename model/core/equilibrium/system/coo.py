"""A PETSc matrix as the sum of small matrices, by PETSc's assembly in coordinate format (COO)."""

import ctypes
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from petsc4py import PETSc

# petsc4py has these two functions in later versions; until then PETSc's own are called.
_PETSC = ctypes.PyDLL(PETSc.__file__)  # finds what this module is linked with, so that it is the same PETSc
_PETSC.MatSetPreallocationCOO.argtypes = [ctypes.c_void_p, ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_void_p]
_PETSC.MatSetValuesCOO.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int]


class SumOfMatrices:
    """Small matrices and the large one that is their sum, whose entries are allocated for them; collective.

    Args:
        mat: of PETSc's type `aij`; its entries are allocated anew.
        tables: for each kind of small matrices the numbers of their rows and of their columns, shapes (m, k). Rows of
            other ranks are added there, negative ones are left out.

    Attributes:
        values: entries of all small matrices, one after the other, zero at first; to be written.
        parts: the same as the matrices of each kind, shape (m, k, k).
    """

    def __init__(self, mat: PETSc.Mat, tables: Sequence[tuple[np.ndarray, np.ndarray]]) -> None:
        self._mat, shapes = mat, [(*columns.shape, columns.shape[1]) for _, columns in tables]
        i, j = np.empty((2, sum(map(math.prod, shapes))), PETSc.IntType)
        for (rows, columns), row, column in zip(tables, _parts(i, shapes), _parts(j, shapes), strict=True):
            row[:], column[:] = rows[:, :, None], columns[:, None, :]
        if hasattr(mat, "setPreallocationCOO"):
            mat.setPreallocationCOO(i, j)
        else:
            _check(_PETSC.MatSetPreallocationCOO(mat.handle, len(i), i.ctypes.data, j.ctypes.data))
        mat.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        self.values = np.zeros(len(i))
        self.parts = _parts(self.values, shapes)

    def assemble(self) -> None:
        """Set the large matrix to the sum; collective."""
        if hasattr(self._mat, "setValuesCOO"):
            self._mat.setValuesCOO(self.values)
        else:
            insert = int(PETSc.InsertMode.INSERT_VALUES)
            _check(_PETSC.MatSetValuesCOO(self._mat.handle, self.values.ctypes.data, insert))


def _parts(values: np.ndarray, shapes: Sequence[tuple[int, ...]]) -> list[np.ndarray]:
    ends = np.cumsum([math.prod(shape) for shape in shapes])
    return [part.reshape(shape) for part, shape in zip(np.split(values, ends[:-1]), shapes, strict=True)]


def _check(error: Any) -> None:
    if error:
        raise PETSc.Error(error)
