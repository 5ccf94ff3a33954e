"""The closed estimate of the local problem against the solution that Newton's method finds."""

import numpy as np
import pytest

from coilset.model.core.material import library
from coilset.model.core.material.law.functions import functions
from coilset.model.core.material.point.local import Group, Start, estimate, rough_turn, solve, turn

COUNT = 30


def starts(p, seed, size):
    """Increments from points on the yield surface outwards, all `size` times their first-order e."""
    rng = np.random.default_rng(seed)
    law = library.load("ck15")
    for _ in range(COUNT):
        b = rng.uniform(0.5, 60.0)
        values = functions(p, b, 293.0)
        n = rng.normal(size=3)
        n *= np.sqrt(values[0] / (1.5 * n[0] ** 2 + 2 * n[1] ** 2 + 2 * n[2] ** 2))
        e = size * 2 * law.G * (n / np.linalg.norm(n) + 0.4 * rng.uniform(-1, 1, size=3))
        c = 2.0 * np.array([n[1:] @ n[1:], n[1:] @ e[1:], e[1:] @ e[1:]])
        yield Start(b, law.E / 1.5, n[0], e[0], 2 * law.G, *c), values


def errors(size):
    """Relative errors of the plastic work and of φ at the estimated Λ."""
    p = library.load("ck15").parameters()
    found = []
    for start, values in starts(p, 4, size):
        guess, exact = estimate(start, *values[:3], values[4]), solve(p, 293.0, start, values)
        assert guess.loads
        assert exact.iterations > 0
        h = 1.0 + values[4] * (values[2] + start.cc)
        phi = np.exp(-(start.cc + values[2]) / h * guess.multiplier)
        found.append((abs((guess.b - start.b) / (exact.b - start.b) - 1.0), abs(phi - exact.c.phi)))
    return np.max(found, axis=0)


def test_error_of_the_work_is_of_second_order():
    """Relative error of b* − b*₀; and all of it is small."""
    coarse, fine = errors(4e-4)[0], errors(1e-4)[0]
    assert fine < 1e-4  # 3e-5
    assert coarse < 4e-3  # 1.1e-3
    assert fine < coarse / 8


def test_error_of_the_turn_is_of_second_order():
    """ζ and κ are those at the start, so the error of φ is of second order."""
    coarse, fine = errors(4e-4)[1], errors(1e-4)[1]
    assert fine < 3e-4  # 1.1e-4
    assert fine < coarse / 8


@pytest.mark.parametrize("z", [1e-3, 0.05, 0.2, 0.5])
def test_rough_turn(z):
    """1/φ lacks z⁵/120 and less: φ is wrong by that at most, ψ by its z-th part, and dψ/dz by the z-th part of that."""
    g = Group(2.0, 0.0, 0.7, 0.0)
    rough, exact = rough_turn(g, 0.5 * z), turn(g, 0.5 * z)
    wrong = z**5 / 120
    assert abs(rough.phi - exact.phi) < wrong + 1e-15
    assert abs(rough.y - exact.y) < 0.7 * wrong / z + 1e-15
    assert abs(rough.phi_l - exact.phi_l) < 2.0 * wrong + 1e-15
    assert abs(rough.y_l - exact.y_l) < 1.4 * wrong / z**2 + 1e-14


def test_rough_turn_decays():
    """Where Padé's approximants would come back to 1."""
    g = Group(1.0, 0.0, 1.0, 0.0)
    assert 0.0 < rough_turn(g, 20.0).phi < 24.0 / 20.0**4
    assert rough_turn(g, 20.0).y == pytest.approx(turn(g, 20.0).y, rel=1e-3)
