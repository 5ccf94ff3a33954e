"""Quadrature of the disk against its exact moments."""

from math import gamma, pi

import numpy as np
import pytest

from coilset.model.core.case.case import SectionSpec
from coilset.model.core.section.rules import abramowitz9, polar, upper_half


def moment(a, b):
    """Mean of y^a z^b over the unit disk, from the beta function (Folland, Amer. Math. Monthly 108 (2001) 446)."""
    if a % 2 or b % 2:
        return 0.0
    return 2 * gamma((a + 1) / 2) * gamma((b + 1) / 2) / gamma((a + b) / 2 + 1) / (a + b + 2) / pi


RULES = [
    (abramowitz9(), 5),
    (polar(1, 4), 3),
    (polar(2, 8), 7),
    (polar(4, 12, staggered=False), 11),
    (polar(3, 9), 8),
    (polar(), 19),
]


@pytest.mark.parametrize(("rule", "degree"), RULES)
def test_moments_are_exact_up_to_the_rules_degree(rule, degree):
    y, z = rule.points.T
    for a in range(degree + 1):
        for b in range(degree + 1 - a):
            assert rule.weights @ (y**a * z**b) == pytest.approx(moment(a, b), abs=1e-14), (a, b)


def test_abramowitz9_is_exact_for_the_second_moment_as_in_the_thesis():
    """I = πR⁴/4 (5.2.43): the mean of y² is R²/4."""
    rule = abramowitz9()
    assert len(rule) == 9
    assert rule.weights @ rule.points[:, 0] ** 2 == pytest.approx(0.25, rel=1e-15)


def test_staggered_rings_have_twice_as_many_angles():
    """Every second ring of eight angles is turned by a sixteenth of a turn; rings and weights stay."""
    plain, staggered = polar(4, 8, staggered=False), polar(4, 8)
    for rule, angles in ((plain, 8), (staggered, 16)):
        angle = np.arctan2(*rule.points.T[::-1]) % (2 * pi)
        assert len(np.unique(np.round(angle, 9) % round(2 * pi, 9))) == angles
    np.testing.assert_allclose(np.hypot(*plain.points.T), np.hypot(*staggered.points.T), rtol=1e-14)
    np.testing.assert_array_equal(plain.weights, staggered.weights)


@pytest.mark.parametrize("rule", [polar(4, 8), polar(4, 8, staggered=False), polar(3, 7), abramowitz9()])
def test_upper_half_integrates_what_is_even_in_z(rule):
    """Points on the y axis count once."""
    half = upper_half(rule)
    assert (half.points[:, 1] >= 0.0).all()
    for a, b in ((0, 0), (1, 2), (2, 0), (2, 4), (3, 2)):
        whole = rule.weights @ (rule.points[:, 0] ** a * rule.points[:, 1] ** b)
        assert half.weights @ (half.points[:, 0] ** a * half.points[:, 1] ** b) == pytest.approx(whole, abs=1e-15)


def test_the_default_of_a_case_is_that_of_the_rule():
    default, rule = SectionSpec().build(), polar()
    assert default.name == rule.name == "polar 8 × 20, staggered"
    np.testing.assert_array_equal(default.points, rule.points)


def test_coiled_wire_has_more_angles_unless_the_case_gives_them():
    spec = SectionSpec()
    assert spec.build(coiled=True).name == "polar 8 × 32, staggered"
    assert SectionSpec(angular=24).build(coiled=True).name == SectionSpec(angular=24).build().name
