"""The entries of PETSc's AIJ matrices as arrays.

On several ranks PETSc keeps a rank's rows in two matrices: one of the columns that belong to the rank, one of the
others. In both, entries lie row by row with ascending columns, as they do on one rank.
"""

import ctypes

import numpy as np
from petsc4py import PETSc

_PETSC = ctypes.PyDLL(PETSc.__file__)  # finds what this module is linked with, so that it is the same PETSc
for _function in (_PETSC.MatSeqAIJGetArray, _PETSC.MatSeqAIJRestoreArray):
    _function.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
_INT = np.ctypeslib.as_ctypes_type(PETSc.IntType)
for _function in (_PETSC.MatGetRowIJ, _PETSC.MatRestoreRowIJ):
    _function.argtypes = [ctypes.c_void_p, _INT, ctypes.c_int, ctypes.c_int, *4 * [ctypes.c_void_p]]
NONE = np.empty(0)


class AijEntries:
    """This rank's entries of an assembled matrix whose pattern stays.

    Args:
        mat: of PETSc's type `seqaij` or `mpiaij`.
        pattern: indptr and indices, if they are known.

    Attributes:
        pattern: of this rank's rows, CSR with global, ascending columns: indptr and indices; on one rank PETSc's own.
    """

    def __init__(self, mat: PETSc.Mat, pattern: tuple[np.ndarray, np.ndarray] | None = None) -> None:
        self._mat, self._one = mat, mat.getComm().size == 1
        self.pattern: tuple[np.ndarray, np.ndarray] = _pattern(mat) if self._one else pattern or mat.getValuesCSR()[:2]
        self._size = self._own_size = len(self.pattern[1])
        self._address, self._values = 0, np.empty(0)  # of the last time, on one rank
        self._handle, self._found = ctypes.c_void_p(mat.handle), ctypes.c_void_p()
        if not self._one:
            start, stop = mat.getOwnershipRange()
            own = (self.pattern[1] >= start) & (self.pattern[1] < stop)
            self._own, self._others = np.flatnonzero(own), np.flatnonzero(~own)
            self._own_size = len(self._own)

    def places(self) -> np.ndarray:
        """Where `read` writes each entry of the pattern."""
        places = np.arange(self._size, dtype=np.int32)
        if not self._one:
            places[np.concatenate([self._own, self._others])] = np.arange(self._size)
        return places

    def read(self, out: np.ndarray) -> None:
        """Write the entries as PETSc keeps them: those of the rank's own columns, then the others, shape (entries,)."""
        out[: self._own_size], out[self._own_size :] = self._arrays()

    def room(self) -> np.ndarray:
        """Where values in the order of the pattern can be added up: PETSc's own array, or zeros for `add`."""
        return self._arrays()[0] if self._one else np.zeros(self._size)

    def add(self, room: np.ndarray) -> None:
        """Add what is in the `room`."""
        if not self._one:
            own, others = self._arrays()
            own += room[self._own]
            others += room[self._others]

    def _arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Where PETSc keeps the entries now."""
        if self._one:
            if self._address != (address := _address(self._handle, self._found)):
                self._address, self._values = address, _at(address, self._size)
            return self._values, NONE
        own, others, columns = ctypes.c_void_p(), ctypes.c_void_p(), ctypes.c_void_p()
        parts = (ctypes.byref(part) for part in (own, others, columns))
        _check(_PETSC.MatMPIAIJGetSeqAIJ(ctypes.c_void_p(self._mat.handle), *parts))
        places = (_address(part, self._found) for part in (own, others))
        return _at(next(places), self._own_size), _at(next(places), self._size - self._own_size)


def _pattern(mat: PETSc.Mat) -> tuple[np.ndarray, np.ndarray]:
    """Where PETSc keeps indptr and indices of a matrix of its type `seqaij`."""
    rows, done, indptr, indices = _INT(), ctypes.c_int(), ctypes.POINTER(_INT)(), ctypes.POINTER(_INT)()
    parts = [ctypes.byref(part) for part in (rows, indptr, indices, done)]
    _check(_PETSC.MatGetRowIJ(mat.handle, 0, 0, 0, *parts))
    starts = np.ctypeslib.as_array(indptr, (rows.value + 1,))
    pattern = starts, np.ctypeslib.as_array(indices, (int(starts[-1]),))
    _check(_PETSC.MatRestoreRowIJ(mat.handle, 0, 0, 0, *parts))
    return pattern


def _address(part: ctypes.c_void_p, found: ctypes.c_void_p) -> int:
    """Where a matrix of PETSc's type `seqaij` keeps its entries; PETSc takes them for changed from now on."""
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
