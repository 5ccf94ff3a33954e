"""Piecewise polynomials are scipy's, to the last bit."""

import numpy as np
import pytest
from scipy.interpolate import PPoly

from coilset.meshes.springs.piecewise import PiecewisePolynomial


@pytest.fixture(params=[(1, 1), (2, 4), (4, 1), (4, 7)], ids=lambda shape: f"{shape[0] - 1}. degree, {shape[1]} pieces")
def pair(request):
    """The same function twice, ours and scipy's."""
    numbers = np.random.default_rng(3)
    c, x = numbers.standard_normal(request.param), np.cumsum(numbers.uniform(0.1, 1.0, request.param[1] + 1))
    return PiecewisePolynomial(c, x), PPoly(c, x)


def places(x):
    """Breaks, places between them, and places beyond both ends, in two dimensions."""
    inside = np.linspace(x[0] - 0.5, x[-1] + 0.5, 200 - len(x))
    return np.concatenate([x, inside]).reshape(4, -1)


@pytest.mark.parametrize("order", [0, 1, 2, 3, 4, 5])
def test_values_and_derivatives(pair, order):
    ours, theirs = (one.derivative(order) for one in pair)
    t = places(pair[0].x)
    np.testing.assert_array_equal(ours(t), theirs(t))


@pytest.mark.parametrize("pieces", [1, 3])
@pytest.mark.parametrize("degree", [0, 1])
def test_powers_that_no_piece_has(degree, pieces):
    c, x = np.zeros((4, pieces)), np.arange(pieces + 1.0)
    c[3 - degree :] = np.random.default_rng(4).standard_normal((degree + 1, pieces))
    np.testing.assert_array_equal(PiecewisePolynomial(c, x)(places(x)), PPoly(c, x)(places(x)))


def test_integral(pair):
    ours, theirs = (one.antiderivative() for one in pair)
    t = places(pair[0].x)
    np.testing.assert_array_equal(ours(t), theirs(t))


def test_a_number_gives_a_number_without_dimension(pair):
    ours, theirs = pair
    assert ours(0.3).shape == theirs(0.3).shape == ()
    assert float(ours(0.3)) == float(theirs(0.3))
