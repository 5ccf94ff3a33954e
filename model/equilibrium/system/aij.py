"""The entries of PETSc's AIJ matrices as arrays.

On several ranks PETSc keeps a rank's rows in two matrices: one of the columns that belong to the rank, one of the
others. In both, entries lie row by row with ascending columns, as they do on one rank.
"""

import ctypes
from typing import Any

import numpy as np
from petsc4py import PETSc

_PETSC = ctypes.PyDLL(PETSc.__file__)  # finds what this module is linked with, so that it is the same PETSc
for _function in (_PETSC.MatSeqAIJGetArray, _PETSC.MatSeqAIJRestoreArray):
    _function.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
_INT = np.ctypeslib.as_ctypes_type(PETSc.IntType)
for _function in (_PETSC.MatGetRowIJ, _PETSC.MatRestoreRowIJ):
    _function.argtypes = [ctypes.c_void_p, _INT, ctypes.c_int, ctypes.c_int, *4 * [ctypes.c_void_p]]
_PETSC.MatMPIAIJGetSeqAIJ.argtypes = 4 * [ctypes.c_void_p]
NONE = np.empty(0)


class AijEntries:
    """This rank's entries of an assembled matrix whose pattern stays.

    Args:
        mat: of PETSc's type `seqaij` or `mpiaij`.

    Attributes:
        own, others: PETSc's patterns of the rank's own columns, numbered from the first of these, and of the others.
        columns: numbers of the others, ascending.
    """

    def __init__(self, mat: PETSc.Mat) -> None:
        self._mat, self._one, self._range = mat, mat.getComm().size == 1, mat.getOwnershipRange()
        own, others, columns = self._parts()
        self._address, self._values = 0, NONE  # of the last time, on one rank
        self._handle, self._found = own, ctypes.c_void_p()
        self.own = _pattern(own)
        self.others, self.columns = (np.zeros_like(self.own[0]), self.own[1][:0]), np.empty(0, PETSc.IntType)
        if not self._one:
            self.others = _pattern(others)
            self.columns = _numbers(columns, int(self.others[1].max(initial=-1)) + 1)

    def local(self, unknowns: np.ndarray) -> np.ndarray:
        """Numbers of unknowns by this rank's columns: its own from 0 on, behind them the others, and then the rest."""
        if self._one:
            return unknowns
        (start, stop), at = self._range, np.searchsorted(self.columns, unknowns)
        known = np.append(self.columns, -1)[at] == unknowns
        mine = (unknowns >= start) & (unknowns < stop)
        return np.where(mine, unknowns - start, stop - start + np.where(known, at, len(self.columns)))

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Where PETSc keeps the entries now: those of the rank's own columns, and the others.

        PETSc regards them as changed.
        """
        if self._one:
            if self._address != (address := _address(self._handle, self._found)):
                self._address, self._values = address, _at(address, len(self.own[1]))
            return self._values, NONE
        own, others, _ = self._parts()
        values = _at(_address(own, self._found), len(self.own[1]))
        return values, _at(_address(others, self._found), len(self.others[1]))

    def _parts(self) -> tuple[ctypes.c_void_p, ctypes.c_void_p, Any]:
        """PETSc's matrices of the own columns and of the others, and where it keeps the numbers of these."""
        own, others, columns = ctypes.c_void_p(self._mat.handle), ctypes.c_void_p(), ctypes.POINTER(_INT)()
        if not self._one:
            found = [ctypes.byref(part) for part in (own, others, columns)]
            _check(_PETSC.MatMPIAIJGetSeqAIJ(self._mat.handle, *found))
        return own, others, columns


def _numbers(columns: Any, size: int) -> np.ndarray:
    return np.ctypeslib.as_array(columns, (size,)) if size else np.empty(0, PETSc.IntType)


def _pattern(part: ctypes.c_void_p) -> tuple[np.ndarray, np.ndarray]:
    """Where PETSc keeps indptr and indices of a matrix of its type `seqaij`."""
    rows, done, indptr, indices = _INT(), ctypes.c_int(), ctypes.POINTER(_INT)(), ctypes.POINTER(_INT)()
    parts = [ctypes.byref(part) for part in (rows, indptr, indices, done)]
    _check(_PETSC.MatGetRowIJ(part, 0, 0, 0, *parts))
    starts = np.ctypeslib.as_array(indptr, (rows.value + 1,))
    pattern = starts, np.ctypeslib.as_array(indices, (int(starts[-1]),))
    _check(_PETSC.MatRestoreRowIJ(part, 0, 0, 0, *parts))
    return pattern


def _address(part: ctypes.c_void_p, found: ctypes.c_void_p) -> int:
    """Where a matrix of PETSc's type `seqaij` keeps its entries, by its functions that give and take them back."""
    place = ctypes.byref(found)
    _check(_PETSC.MatSeqAIJGetArray(part, place))
    address = found.value or 0
    _check(_PETSC.MatSeqAIJRestoreArray(part, place))
    return address


def _at(address: int, size: int) -> np.ndarray:
    return np.ctypeslib.as_array((ctypes.c_double * size).from_address(address)) if size else NONE


def _check(error: int) -> None:
    if error:
        raise PETSc.Error(error)
