"""Small matrices put into a large one, against a sum of dense matrices."""

import numpy as np
import pytest

from coilset.model.equilibrium.system.joined import add_matrices, add_vectors, join_patterns

SIZE, RANGE = 40, slice(9, 33)  # unknowns, and those whose rows are here
NUMBERS = np.arange(SIZE, dtype=np.int32)  # the small matrices call them by their numbers


def tables():
    """Unknowns of chains of three neighbouring ones, as those of a station, and of single ones, in any order."""
    rng = np.random.default_rng(4)
    stations = rng.permuted(np.tile(np.arange(13), (7, 1)), axis=1)[:, :4]
    singles = rng.permuted(np.tile(np.arange(SIZE), (5, 1)), axis=1)[:, :6]
    return [(3 * stations[:, :, None] + np.arange(3)).reshape(7, 12).astype(np.int32), singles.astype(np.int32)]


def bare():
    """Pattern of the rows without the small matrices: neighbours."""
    rows, columns = np.indices((SIZE, SIZE))
    return np.abs(rows - columns) <= 1


def csr(pattern):
    """Of the rows that are here."""
    rows = pattern[RANGE]
    return np.append(0, np.cumsum(rows.sum(axis=1))).astype(np.int32), np.nonzero(rows)[1].astype(np.int32)


def parts(pattern):
    """CSR of the rows in their own columns, and in the others, which follow behind these; where unknowns are then."""
    here = np.isin(NUMBERS, NUMBERS[RANGE])
    numbers = np.append(NUMBERS[RANGE], NUMBERS[~here])
    own, others = pattern[RANGE, RANGE], pattern[RANGE, ~here]
    both = [(np.append(0, np.cumsum(part.sum(axis=1))), np.nonzero(part)[1]) for part in (own, others)]
    return *[tuple(array.astype(np.int32) for array in part) for part in both], np.argsort(numbers).astype(np.int32)


def test_pattern_and_sum_are_those_of_dense_matrices():
    rng, pattern, total, forces = np.random.default_rng(5), bare(), np.zeros((SIZE, SIZE)), np.zeros(SIZE)
    matrices = [rng.normal(size=(*table.shape, table.shape[1])) for table in tables()]
    vectors = [rng.normal(size=table.shape) for table in tables()]
    for table, of_table, loads in zip(tables(), matrices, vectors, strict=True):
        for unknowns, matrix, load in zip(table, of_table, loads, strict=True):
            pattern[np.ix_(unknowns, unknowns)] = True
            total[np.ix_(unknowns, unknowns)] += matrix
            forces[unknowns] += load
    found = join_patterns(csr(bare()), tables(), RANGE.start, SIZE)
    assert all(np.array_equal(*pair) for pair in zip(found, csr(pattern), strict=True))
    own, others, unknowns = parts(pattern)
    values, added = (np.zeros(len(own[1])), np.zeros(len(others[1]))), np.zeros(RANGE.stop - RANGE.start)
    for table, of_table, loads in zip(tables(), matrices, vectors, strict=True):
        add_matrices(own, others, unknowns, table, of_table, SIZE, values)
        add_vectors(NUMBERS, table, loads, RANGE.start, added)
    here = np.isin(NUMBERS, NUMBERS[RANGE])
    for columns, of_part in zip((here, ~here), values, strict=True):
        expected = total[RANGE][:, columns][pattern[RANGE][:, columns]]
        np.testing.assert_allclose(of_part, expected, rtol=0, atol=1e-13)
    np.testing.assert_allclose(added, forces[RANGE], rtol=0, atol=1e-13)


@pytest.mark.parametrize("lacking", [(10, 20), (10, 3), (32, 39)], ids=["own", "before", "behind"])
def test_matrix_without_room_is_refused(lacking):
    """The pattern has no entry for one of what is added, in the rows' own columns or in others."""
    pattern, table = bare(), np.array([lacking], dtype=np.int32)
    pattern[np.ix_(lacking, lacking)] = True
    for expected in (True, False):
        own, others, unknowns = parts(pattern)
        values = np.zeros(len(own[1])), np.zeros(len(others[1]))
        if expected:
            add_matrices(own, others, unknowns, table, np.ones((1, 2, 2)), SIZE, values)
        else:
            with pytest.raises(ValueError, match="no entries"):
                add_matrices(own, others, unknowns, table, np.ones((1, 2, 2)), SIZE, values)
        pattern[lacking] = False
