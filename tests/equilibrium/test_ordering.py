"""The order of elimination along chains, against an elimination of the dense pattern."""

import numpy as np
import pytest

from coilset.model.equilibrium import elimination, ordering
from coilset.model.equilibrium.elimination import plan_elimination
from coilset.model.equilibrium.multifrontal import PartialLU
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


WINDINGS, AROUND = 40, 12  # a tube: many more windings than stations in each


def tube():
    """Pattern of stations along a wire whose windings all touch; five stations of each are coupled with the next."""
    n = WINDINGS * AROUND
    near = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    return (near <= 1) | (np.abs(near - AROUND) <= 2)


def plan_of_tube(keep, most, monkeypatch):
    """Plan whose narrow fronts have up to `most` rows."""
    monkeypatch.setattr(elimination, "NARROW", most)
    return plan_elimination(*csr(tube()), keep)


@pytest.mark.parametrize("kept", [slice(0, 0), slice(-AROUND, None), slice(0, AROUND)], ids=["none", "end", "start"])
def test_a_tube_is_swept_towards_what_is_kept(kept, monkeypatch):
    """In fewer multiplications than minimum degree takes; what is left of the kept ones is that of a dense solve."""
    keep = np.zeros(WINDINGS * AROUND, dtype=bool)
    keep[kept] = True
    by_degree, swept = plan_of_tube(keep, len(keep), monkeypatch), plan_of_tube(keep, AROUND, monkeypatch)
    assert swept.multiplications < 0.9 * by_degree.multiplications
    assert set(swept.order[len(keep) - swept.kept :]) == set(np.flatnonzero(keep))
    towards = -1.0 if keep[0] else 1.0
    late = swept.order[len(keep) // 2 : len(keep) - swept.kept]
    assert np.corrcoef(towards * late, np.arange(len(late)))[0, 1] > 0.9
    rng = np.random.default_rng(7)
    matrix = np.where(tube(), rng.normal(size=tube().shape), 0.0) + 20.0 * np.eye(len(keep))
    factors = PartialLU(swept)
    assert factors.factorise(matrix[tube()])
    inner, last = np.flatnonzero(~keep), swept.order[len(keep) - swept.kept :]
    left = np.linalg.solve(matrix[np.ix_(inner, inner)], matrix[np.ix_(inner, last)])
    schur = matrix[np.ix_(last, last)] - matrix[np.ix_(last, inner)] @ left
    np.testing.assert_allclose(factors.schur, schur, rtol=0, atol=1e-11 * np.abs(matrix).max())


def test_a_few_long_windings_are_left_to_minimum_degree(monkeypatch):
    """A sweep along the wire would carry a whole one of them, which is more than the cuts of a dissection across."""
    wide = 3 * AROUND  # the tube's windings are longer then, and there are four
    near = np.abs(np.subtract.outer(np.arange(4 * wide), np.arange(4 * wide)))
    pattern = (near <= 1) | (np.abs(near - wide) <= 2)
    plans = []
    for most in (len(pattern), AROUND):
        monkeypatch.setattr(elimination, "NARROW", most)
        plans.append(plan_elimination(*csr(pattern), np.zeros(len(pattern), dtype=bool)))
    np.testing.assert_array_equal(plans[1].order, plans[0].order)
