"""Quadrature of the disk against its exact moments."""

from math import gamma, pi

import pytest

from coilset.model.section.rules import abramowitz9, polar


def moment(a, b):
    """Mean of y^a z^b over the unit disk, from the beta function (Folland, Amer. Math. Monthly 108 (2001) 446)."""
    if a % 2 or b % 2:
        return 0.0
    return 2 * gamma((a + 1) / 2) * gamma((b + 1) / 2) / gamma((a + b) / 2 + 1) / (a + b + 2) / pi


RULES = [(abramowitz9(), 5), (polar(1, 4), 3), (polar(2, 8), 7), (polar(4, 12), 11)]


@pytest.mark.parametrize(("rule", "degree"), RULES)
def test_moments_are_exact_up_to_the_rules_degree(rule, degree):
    y, z = rule.points.T
    for a in range(degree + 1):
        for b in range(degree + 1 - a):
            assert rule.weights @ (y**a * z**b) == pytest.approx(moment(a, b), abs=1e-14), (a, b)


def test_abramowitz9_is_exact_for_the_second_moment_as_the_thesis_says():
    """I = πR⁴/4 (5.2.43): the mean of y² is R²/4."""
    rule = abramowitz9()
    assert len(rule) == 9
    assert rule.weights @ rule.points[:, 0] ** 2 == pytest.approx(0.25, rel=1e-15)
