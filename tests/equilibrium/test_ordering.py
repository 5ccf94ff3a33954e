"""The order of elimination along chains, against an elimination of the dense pattern."""

import numpy as np
import pytest

from coilset.model.equilibrium import ordering
from coilset.model.equilibrium.ordering import eliminate_chains, fill_reducing_order


def chain_with_sides(touching):
    """Pattern of nodes along a wire, of vertices beside each element, and of windings that touch; nodes come first."""
    nodes = 12
    joined = np.eye(2 * nodes - 1, dtype=bool)
    pairs = [(i, i + 1) for i in range(nodes - 1)] + [(i, i + 4) for i in range(nodes - 4) if touching]
    pairs += [(nodes + e, e + k) for e in range(nodes - 1) for k in (0, 1)]
    for i, j in pairs:
        joined[i, j] = joined[j, i] = True
    return joined


def csr(pattern):
    """Of a dense pattern."""
    return np.append(0, np.cumsum(pattern.sum(axis=1))), np.nonzero(pattern)[1]


def eliminated(pattern, order):
    """The pattern after some vertices are eliminated, and how many neighbours each of them had then."""
    pattern, neighbours = pattern.copy(), []
    for i in order:
        near = np.setdiff1d(np.flatnonzero(pattern[i]), i)
        neighbours.append(len(near))
        pattern[np.ix_(near, near)] = True
        pattern[i] = pattern[:, i] = False
    return pattern, neighbours


@pytest.mark.parametrize("kept", [[], [11], [0], [0, 11]], ids=str)
@pytest.mark.parametrize("touching", [False, True])
def test_chains_are_eliminated_without_fill(touching, kept):
    """What is left has the pattern of the dense elimination; of a wire that touches nothing only the kept are left."""
    pattern = chain_with_sides(touching)
    stays = np.isin(np.arange(len(pattern)), kept)
    first, left, begin, neighbours = eliminate_chains(*csr(pattern), stays)
    found, counts = eliminated(pattern, first)
    assert max(counts) <= 2
    if len(kept) < 2:
        nodes = [count for vertex, count in zip(first, counts, strict=True) if vertex < 12]
        assert touching or nodes.count(2) <= 2 - len(kept)  # free ends, which have a side; from there along the wire
    assert np.array_equal(np.sort(np.concatenate([first, left])), np.arange(len(pattern)))
    assert touching or np.array_equal(left, kept)
    for i, start, stop in zip(left, begin[:-1], begin[1:], strict=True):
        assert np.array_equal(np.sort(neighbours[start:stop]), np.flatnonzero(found[i]))


@pytest.mark.parametrize("name", [ordering.ORDERING, "qmd"])
@pytest.mark.parametrize("touching", [False, True])
def test_kept_vertices_come_last(touching, name, monkeypatch):
    """Also with PETSc's own minimum degree, where it has been built without SuiteSparse."""
    monkeypatch.setattr(ordering, "ORDERING", name)
    pattern, kept = chain_with_sides(touching), np.array([3, 11])
    order = fill_reducing_order(*csr(pattern), kept)
    assert np.array_equal(np.sort(order), np.arange(len(pattern)))
    assert set(order[-2:]) == {3, 11}
