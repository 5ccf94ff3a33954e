"""Finite rotations against scipy's, and the chart's tangent against differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coilset.model.frames import rotations


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 9.9e-4, 1.1e-3, 0.3, 2.0, 3.1])
def test_exponential_and_logarithm_agree_with_scipy(angle):
    v = angle * np.array([0.36, -0.48, 0.8])
    R, back = np.empty((3, 3)), np.empty(3)
    rotations.exponential(v, R)
    np.testing.assert_allclose(R, Rotation.from_rotvec(v).as_matrix(), rtol=0, atol=1e-14)
    rotations.logarithm(R, back)
    np.testing.assert_allclose(back, v, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("angle", [1e-5, 5e-3, 0.02, 0.7, 2.5])
def test_chart_tangent_is_the_spin_of_the_exponential(angle):
    """exp(v + h δ) exp(v)ᵀ = exp(h T δ) + O(h²); the difference quotient is good to 1e-9 for h = 1e-5, central."""
    v, delta, h = angle * np.array([0.6, 0.0, -0.8]), np.array([0.3, -0.5, 0.2]), 1e-5
    T, P = np.empty((3, 3)), np.empty((3, 3))
    rotations.chart_tangent(v, T)
    rotations.inverse_chart_tangent(v, P)
    plus, minus = (Rotation.from_rotvec(v + sign * h * delta) for sign in (1, -1))
    spin = (plus * minus.inv()).as_rotvec() / (2 * h)
    np.testing.assert_allclose(T @ delta, spin, rtol=0, atol=2e-9)
    np.testing.assert_allclose(P @ T, np.eye(3), rtol=0, atol=1e-12)


def test_triads_are_right_handed_with_the_chord_first():
    chords = np.array([[1.0, 2.0, 3.0], [0.0, 0.0, -5.0], [0.0, 1.0, 0.0]])
    E = rotations.triads(chords)
    np.testing.assert_allclose(np.einsum("nji,njk->nik", E, E), np.tile(np.eye(3), (3, 1, 1)), atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(E), 1.0, rtol=1e-14)
    np.testing.assert_allclose(E[:, :, 0], chords / np.linalg.norm(chords, axis=1)[:, None], rtol=1e-15)
