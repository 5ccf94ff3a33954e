"""Small matrices and vectors put into large ones, against sums of dense ones."""

import numpy as np
from petsc4py import PETSc

from coilset.model.core.equilibrium.system.coo import SumOfMatrices
from coilset.model.core.equilibrium.system.sums import add_matrices, add_vectors

SIZE, RANGE = 40, slice(9, 33)  # unknowns, and those whose rows are here
NUMBERS = np.arange(SIZE, dtype=np.int32)  # the small matrices call them by their numbers


def tables():
    """Unknowns of chains of three neighbouring ones, as those of a station, and of single ones, in any order."""
    rng = np.random.default_rng(4)
    stations = rng.permuted(np.tile(np.arange(13), (7, 1)), axis=1)[:, :4]
    singles = rng.permuted(np.tile(np.arange(SIZE), (5, 1)), axis=1)[:, :6]
    return [(3 * stations[:, :, None] + np.arange(3)).reshape(7, 12).astype(np.int32), singles.astype(np.int32)]


def matrix():
    """PETSc's, without entries."""
    mat = PETSc.Mat().create(PETSc.COMM_SELF)
    mat.setSizes((SIZE, SIZE))
    mat.setType(PETSc.Mat.Type.AIJ)
    return mat


def assert_sum(mat, rows):
    """The matrix is the sum of the small ones, and has entries for them alone, also once they are set again; `rows`
    gives the rows that the unknowns of a small matrix have."""
    rng, total, pattern = np.random.default_rng(5), np.zeros((SIZE, SIZE)), np.zeros((SIZE, SIZE), dtype=bool)
    found = SumOfMatrices(mat, [(rows(table), table) for table in tables()])
    for _ in range(2):
        total[:] = 0.0
        for table, part in zip(tables(), found.parts, strict=True):
            part[:] = rng.normal(size=part.shape)
            for unknowns, small in zip(table, part, strict=True):
                here = rows(unknowns) >= 0
                total[np.ix_(unknowns[here], unknowns)] += small[here]
                pattern[np.ix_(unknowns[here], unknowns)] = True
        found.assemble()
        np.testing.assert_allclose(mat.getValues(NUMBERS, NUMBERS), total, rtol=0, atol=1e-13)
    assert mat.getInfo()["nz_used"] == np.count_nonzero(pattern)


def test_small_matrices_add_up_where_they_meet():
    assert_sum(matrix(), lambda unknowns: unknowns)


def test_rows_without_a_number_are_left_out_also_when_entries_are_allocated_anew():
    mat = matrix()
    assert_sum(mat, lambda unknowns: unknowns)
    assert_sum(mat, lambda unknowns: np.where((unknowns >= RANGE.start) & (unknowns < RANGE.stop), unknowns, -1))


def test_matrices_are_added_where_each_begins():
    """Those of two sizes in a row, several of them at the same place."""
    rng, out = np.random.default_rng(6), np.zeros(3 * 4 + 2 * 9)
    small, large = rng.normal(size=(4, 2, 2)), rng.normal(size=(2, 3, 3))
    add_matrices(small, np.array([4, 0, 4, 8]), out)
    add_matrices(large, np.array([21, 12]), out)
    right = [small[1], small[0] + small[2], small[3], large[1], large[0]]
    np.testing.assert_array_equal(out, np.concatenate([each.ravel() for each in right]))


def test_vectors_are_added_to_the_rows_of_a_range():
    rng, forces, added = np.random.default_rng(7), np.zeros(SIZE), np.zeros(RANGE.stop - RANGE.start)
    for table in tables():
        loads = rng.normal(size=table.shape)
        np.add.at(forces, table, loads)
        add_vectors(NUMBERS, table, loads, RANGE.start, added)
    np.testing.assert_allclose(added, forces[RANGE], rtol=0, atol=1e-13)
