"""The section tangent is the derivative of the section resultants: Taylor remainder of order 2."""

import numpy as np
import pytest

from coilset.model.section.rules import polar
from coilset.model.section.update import update_sections

RADIUS = np.array([2.5])
PLASTIC = np.array([2e-3, 3e-4, -2e-4, 3e-3, -1.5e-3, 1e-3])  # surface strains far past yield (8e-4)


def placement():
    """A section off the chord and tilted against it, made of one rotation and one offset; and ds/dx."""
    angle, offset = 0.1, np.array([0.0, 0.3, -0.2])
    tilt = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    cross = -np.cross(np.eye(3), offset)  # K × offset = cross @ K
    P = np.block([[tilt, tilt @ cross], [np.zeros((3, 3)), tilt]]) / 1.02
    return np.tile(P, (1, 2, 1, 1)), np.full((1, 2), 1.02)


STRAIGHT = (np.eye(6)[None, None].repeat(2, axis=1), np.ones((1, 2)))


def update(law, de, old, place=STRAIGHT):
    rule = polar()
    y, z = np.ascontiguousarray(rule.points.T)
    new, s, D = np.empty_like(old), np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
    good = update_sections(law.parameters(), y, z, rule.weights, RADIUS, np.tile(de, (1, 2, 1)), *place, old, new, s, D)
    assert good == 0
    return s[0, 0], D[0, 0], new


def slope(law, de, old, direction, place):
    s, D, _ = update(law, de, old, place)
    steps = np.array([1e-2, 5e-3, 2.5e-3])
    remainders = [np.linalg.norm(update(law, de + h * direction, old, place)[0] - s - h * D @ direction) for h in steps]
    return np.polyfit(np.log(steps), np.log(remainders), 1)[0], remainders[-1] / np.linalg.norm(s)


@pytest.mark.parametrize("place", [STRAIGHT, placement()], ids=["straight", "curved"])
def test_elastic_tangent_is_the_linear_map_of_an_elastic_section(ck15, place):
    """Elastic: the remainder vanishes, and the straight tangent is diag(EA, GA, GA, GIp, EI, EI)."""
    old = np.zeros((1, 2, 48, 7))
    small = np.array([1e-5, 2e-6, 0, 1e-5, 1e-5, -2e-5])
    s, D, _ = update(ck15, small, old, place)
    # the spin terms (5.2.33) are of second order: strain 1e-5 times the resultant
    np.testing.assert_allclose(s, D @ small, rtol=0, atol=1e-4 * np.abs(s).max())
    if place is STRAIGHT:
        A, I = np.pi * 2.5**2, np.pi * 2.5**4 / 4
        expected = [ck15.E * A, ck15.G * A, ck15.G * A, 2 * ck15.G * I, ck15.E * I, ck15.E * I]
        _, D, _ = update(ck15, np.zeros(6), old)
        np.testing.assert_allclose(D, np.diag(expected), rtol=1e-12, atol=1e-6)


@pytest.mark.parametrize("place", [STRAIGHT, placement()], ids=["straight", "curved"])
@pytest.mark.parametrize("start", ["virgin", "hardened", "reversed"])
def test_plastic_tangent_has_taylor_slope_two(ck15, place, start):
    old = np.zeros((1, 2, 48, 7))
    de = PLASTIC
    if start != "virgin":
        old = update(ck15, PLASTIC, old, place)[2]
        de = PLASTIC if start == "hardened" else -2.0 * PLASTIC
    direction = np.array([0.7e-3, -1e-4, 2e-4, -1e-3, 0.8e-3, 1.3e-3])
    order, remainder = slope(ck15, de, old, direction, place)
    assert order == pytest.approx(2.0, abs=0.15)  # kinks of points that pass the yield surface cost some of it
    assert 0 < remainder < 1e-4


def test_a_failed_update_is_reported(ck15):
    """Strains that are not numbers are never swallowed."""
    rule = polar()
    y, z = np.ascontiguousarray(rule.points.T)
    old = np.zeros((1, 2, 48, 7))
    de = np.full((1, 2, 6), np.nan)
    out = np.empty_like(old), np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
    assert update_sections(ck15.parameters(), y, z, rule.weights, RADIUS, de, *STRAIGHT, old, *out) == -1
