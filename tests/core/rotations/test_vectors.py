"""Rotations of arrays and derivatives of the rotation matrix: against scipy, closed forms, and Taylor's remainder."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from coilset.model.core.rotations import kernels
from coilset.model.core.rotations.vectors import (
    AXES,
    chart_derivatives,
    cross_matrix,
    rotation_derivatives,
    rotation_matrix,
    stumpff,
)

ANGLES = [0.0, 1e-12, 1e-9, 1e-6, 1.1e-3, 0.1, 1.0, 2.0, np.pi - 1e-7, np.pi, 4.0, 5.0, 6.28]


def vector(angle, seed=0):
    """A random rotation vector of that size."""
    v = np.random.default_rng(seed).normal(size=3)
    return angle * v / np.linalg.norm(v)


def test_stumpff_functions_are_their_closed_forms():
    """Above 1 rad the closed forms lose few digits: rounding of terms up to α⁴/24, over α⁶."""
    α = np.linspace(1.0, 2.0 * np.pi, 50)
    closed = [
        np.cos(α),
        np.sin(α) / α,
        (1.0 - np.cos(α)) / α**2,
        (α - np.sin(α)) / α**3,
        (np.cos(α) - 1.0 + α**2 / 2.0) / α**4,
        (np.sin(α) - α + α**3 / 6.0) / α**5,
        (1.0 - α**2 / 2.0 + α**4 / 24.0 - np.cos(α)) / α**6,
    ]
    for k, (ours, theirs) in enumerate(zip(stumpff(α**2), closed, strict=True)):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-14 if k < 3 else 1e-15, err_msg=f"c{k}")


@pytest.mark.parametrize("angle", ANGLES)
def test_matrix_and_derivatives_agree_with_matrix_exponentials(angle):
    """A block of exp([[M, A], [0, M]]) is the derivative of exp(M) along A, one of the next larger the second one (C.
    Van Loan, IEEE Trans. Autom. Control 23 (1978) 395). expm of 12 × 12 matrices is good to some 1e-14 at 2π."""
    θ, Z = vector(angle), np.zeros((3, 3))
    R, dR, ddR = rotation_derivatives(θ)
    M = cross_matrix(θ)
    np.testing.assert_allclose(R, Rotation.from_rotvec(θ).as_matrix(), rtol=0, atol=1e-14)
    np.testing.assert_allclose(R, rotation_matrix(θ), rtol=0, atol=1e-14)
    np.testing.assert_allclose(R.T @ R, np.eye(3), rtol=0, atol=2e-14)
    for k, A in enumerate(AXES):
        np.testing.assert_allclose(dR[k], expm(np.block([[M, A], [Z, M]]))[:3, 3:], rtol=0, atol=1e-13)
        for l, B in enumerate(AXES):
            large = expm(np.block([[M, A, B, Z], [Z, M, Z, B], [Z, Z, M, A], [Z, Z, Z, M]]))
            np.testing.assert_allclose(ddR[k, l], large[:3, 9:], rtol=0, atol=1e-13)


@pytest.mark.parametrize("angle", [0.0, 1e-3, 0.5, 2.0, np.pi, 6.0])
def test_taylor_remainders_are_of_second_and_third_order(angle):
    """R(θ + h d) less its first terms: without the second derivative h² is left, with it h³."""
    θ, d = vector(angle), vector(1.0, seed=1)
    R, dR, ddR = rotation_derivatives(θ)
    first, second = np.tensordot(d, dR, 1), np.einsum("k,l,klij->ij", d, d, ddR)
    steps, rests = 2.0 ** -np.arange(3, 8), []
    for h in steps:
        change = rotation_matrix(θ + h * d) - R
        rests.append([np.abs(change - h * first).max(), np.abs(change - h * first - h**2 / 2 * second).max()])
    orders = np.log2(np.divide(rests[:-1], rests[1:]))
    np.testing.assert_allclose(orders[-1], [2.0, 3.0], atol=0.1)
    np.testing.assert_allclose(ddR, np.swapaxes(ddR, 0, 1), rtol=0, atol=1e-15)


@pytest.mark.parametrize("angle", ANGLES)
def test_tangent_of_the_chart_is_the_compiled_one_and_changes_as_its_derivatives(angle):
    """The kernel's 1 − cos α loses digits where its series ends: 4e-14 of T at 1.1e-3 rad. Central differences of T
    with h = 1e-5 are good to 1e-10. T is the spin of R: R,k Rᵀ = [T e_k]."""
    θ, h, compiled = vector(angle), 1e-5, np.empty((3, 3))
    T, dT = chart_derivatives(θ)
    kernels.chart_tangent(θ, compiled)
    np.testing.assert_allclose(T, compiled, rtol=0, atol=2e-13 if 0.0 < angle < 0.1 else 2e-14)
    R, dR, _ = rotation_derivatives(θ)
    for k, along in enumerate(np.eye(3)):
        np.testing.assert_allclose(dR[k] @ R.T, cross_matrix(T[:, k]), rtol=0, atol=5e-14)
        change = (chart_derivatives(θ + h * along)[0] - chart_derivatives(θ - h * along)[0]) / (2 * h)
        np.testing.assert_allclose(dT[k], change, rtol=0, atol=1e-9)
