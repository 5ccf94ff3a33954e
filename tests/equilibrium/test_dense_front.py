"""The elimination of a front's first unknowns against NumPy, below and above the size from which it goes in panels."""

import numpy as np
import pytest

from coilset.model.equilibrium.dense_front import LARGE, PANEL, ROWS, TILE, eliminate_pivots

TILES = np.empty((PANEL + ROWS) * TILE)


def made(w: int, negative: int = 0) -> np.ndarray:
    """A matrix that needs no pivoting; of a symmetric part with so many negative eigenvalues."""
    rng = np.random.default_rng(w)
    matrix = rng.normal(size=(w, w)) + 2.0 * w * np.eye(w)
    matrix[:negative] *= -1.0
    return matrix


@pytest.mark.parametrize("w", [LARGE - 1, LARGE, TILE + PANEL + 2 * ROWS + 3])
@pytest.mark.parametrize("k", [1, PANEL + 3, LARGE - 1])
def test_factors_and_what_is_left_are_numpys(w, k):
    """Also where pivots, rows and columns fill no whole panel or tile."""
    matrix = made(w)
    front = matrix.copy()
    assert eliminate_pivots(front, k, TILES) == 0
    lower, upper = np.tril(front[:, :k], -1) + np.eye(w, k), np.triu(front)[:k]
    left = matrix - lower @ upper
    bound = 1e-14 * w * np.abs(matrix).max()
    np.testing.assert_allclose(left[:k], 0.0, atol=bound)
    np.testing.assert_allclose(left[:, :k], 0.0, atol=bound)
    np.testing.assert_allclose(front[k:, k:], left[k:, k:], atol=bound)


@pytest.mark.parametrize("w", [LARGE - 1, LARGE + PANEL])
def test_negative_pivots_are_counted_and_unusable_ones_told(w):
    """Also of the second panel."""
    assert eliminate_pivots(made(w, negative=PANEL + 5), w, TILES) == PANEL + 5
    for value in (0.0, np.nan):
        matrix = made(w)
        matrix[PANEL + 1], matrix[:, PANEL + 1] = 0.0, 0.0
        matrix[PANEL + 1, PANEL + 1] = value
        assert eliminate_pivots(matrix, w, TILES) == -1
