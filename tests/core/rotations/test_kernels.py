"""Compiled kernels of single rotations against scipy's, and the chart's tangent against differences."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from coilset.model.core.rotations import kernels
from coilset.model.core.rotations.vectors import carried, cross_matrix, nearest_vector, rotation_matrix

ANGLES = [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 9.9e-4, 1.1e-3, 0.3, 2.0, 2.69, 2.7, 3.1]
ANGLES += [np.pi - part for part in (1e-6, 1e-9, 1e-12)]
EPS = np.finfo(float).eps


def vectors(angle):
    """Five random rotation vectors of that size."""
    v = np.random.default_rng(7).normal(size=(5, 3))
    return angle * v / np.linalg.norm(v, axis=1)[:, None]


@pytest.mark.parametrize("angle", [*ANGLES, 4.0, 6.2])
def test_exponential_agrees_with_scipy(angle):
    """With `Rotation`, by quaternions, and with `expm`, whose scaling and squaring loses some digits above π."""
    for v in vectors(angle):
        R = np.empty((3, 3))
        kernels.exponential(v, R)
        np.testing.assert_allclose(R, Rotation.from_rotvec(v).as_matrix(), rtol=0, atol=1e-14)
        np.testing.assert_allclose(R, expm(cross_matrix(v)), rtol=0, atol=1e-13)


@pytest.mark.parametrize("angle", ANGLES)
def test_logarithm_undoes_the_exponential(angle):
    """To rounding, also near π, where the sine of the angle, which gives the axis elsewhere, vanishes."""
    for v in vectors(angle):
        R, back = np.empty((3, 3)), np.empty(3)
        kernels.exponential(v, R)
        kernels.logarithm(R, back)
        np.testing.assert_allclose(back, v, rtol=0, atol=20.0 * EPS * angle)


@pytest.mark.parametrize("axis", [*np.eye(3), *np.array([[1.0, -1.0, 0.0], [0.0, 3.0, -4.0], [1.0, 2.0, -2.0]])])
def test_a_half_turn_has_one_of_its_two_vectors(axis):
    """R = 2 n nᵀ − 1, symmetric to the last bit: nothing in it says which of π n and −π n is meant."""
    n, back = axis / np.linalg.norm(axis), np.empty(3)
    kernels.logarithm(2.0 * np.outer(n, n) - np.eye(3), back)
    np.testing.assert_allclose(back * np.sign(back @ n), np.pi * n, rtol=0, atol=20.0 * EPS)


@pytest.mark.parametrize("axis", [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.1, -0.2, 1.0]])
def test_the_nearest_vector_follows_a_rotation_through_any_number_of_half_turns(axis):
    """In steps of 18°, the tenth of which is a half turn to the last digit."""
    n, now = np.array(axis) / np.linalg.norm(axis), np.zeros(3)
    for step in range(1, 81):
        there = np.radians(18.0 * step) * n
        now = nearest_vector(rotation_matrix(there), now)
        np.testing.assert_allclose(now, there, rtol=0, atol=1e-13)


@pytest.mark.parametrize("angle", [1e-12, 1e-5, 5e-3, 0.02, 0.7, 2.5, 3.1415, 6.0])
def test_chart_tangent_is_the_spin_of_the_exponential(angle):
    """exp(v + h δ) exp(v)ᵀ = exp(h T δ) + O(h²); the difference quotient is good to 1e-9 for h = 1e-5, central."""
    delta, h = np.array([0.3, -0.5, 0.2]), 1e-5
    for v in vectors(angle):
        T, P, factors = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 2))
        kernels.chart_tangent(v, T)
        kernels.inverse_chart_tangent(v, P, factors[0])
        plus, minus = (Rotation.from_rotvec(v + sign * h * delta) for sign in (1, -1))
        spin = (plus * minus.inv()).as_rotvec() / (2 * h)
        np.testing.assert_allclose(T @ delta, spin, rtol=0, atol=2e-9)
        np.testing.assert_allclose(P @ T, np.eye(3), rtol=0, atol=1e-12)
        for sign, row in ((1, 1), (-1, 2)):
            kernels.inverse_chart_tangent(v + sign * h * delta, P, factors[row])
        np.testing.assert_allclose(factors[0, 1] * (v @ delta), (factors[1, 0] - factors[2, 0]) / (2 * h), atol=2e-9)


def test_nodes_are_rotated_by_their_vectors():
    """R_new = exp(v) R_old for each node, with the tangent of its chart."""
    rng = np.random.default_rng(3)
    v, old = rng.normal(size=(4, 3)), Rotation.random(4, rng).as_matrix()
    new, T, expected, work = np.empty((4, 3, 3)), np.empty((4, 3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for node in range(4):
        kernels.rotate(v[node], old[node], new[node], T[node], work)
    np.testing.assert_allclose(new, Rotation.from_rotvec(v).as_matrix() @ old, rtol=0, atol=1e-14)
    for node in range(4):
        kernels.chart_tangent(v[node], expected)
        np.testing.assert_array_equal(T[node], expected)


@pytest.mark.parametrize(("of", "gap", "to"), [(1.0, 0.0, 1.0), (0.0, 0.0, 1.0), (1.0, 0.0, 3.0), (0.4, 1.0, 0.7)])
def test_points_that_turn_about_an_axis_are_carried_on_along_their_helices(of, gap, to):
    """To rounding; `of` 0: from their velocities."""
    rng = np.random.default_rng(2)
    ψ, x = np.array([0.3, -0.5, 0.4]), rng.normal(size=(6, 3))
    n = ψ / np.linalg.norm(ψ)

    def at(t):
        return x @ rotation_matrix(t * ψ).T + 0.7 * t * n

    before = (at(of) - at(0.0)) / of if of else np.cross(ψ, x) + 0.7 * n
    found = carried(before, np.tile(ψ, (6, 1)), of, gap, to)
    np.testing.assert_allclose(found, (at(of + gap + to) - at(of + gap)) / to, rtol=0, atol=1e-14)
