"""Rotation matrices, the tangents of their chart, and derivatives of both by the rotation vector.

With the rotation vector θ, α = |θ| and [θ] a = θ × a, Rodrigues' formula and the tangent of its chart are

    R = exp([θ]) = 1 + c1 [θ] + c2 [θ]²,   ω = T θ̇,   T = 1 + c2 [θ] + c3 [θ]²,

with Stumpff's functions c_k of s = α²; c1 = sin α/α and c2 = (1 − cos α)/α². They are analytic in s, without a special
case at θ = 0, and their derivatives are again such functions: 2 dc_k/ds = k c_{k+2} − c_{k+1}. See E. Stiefel and
G. Scheifele, Linear and Regular Celestial Mechanics, Springer 1971, for c_k; J. Argyris, An excursion into large
rotations, CMAME 32 (1982) 85, for R and T.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from coilset.model.core.rotations.kernels import exponential, logarithm

ORDER = 6  # the highest of Stumpff's functions here; second derivatives of R reach up to it
TERMS = 19  # of the series of c5 and c6: what follows is below 1e-20 of them for rotations up to 2π


def stumpff(square: np.ndarray) -> list[np.ndarray]:
    """Stumpff's functions c_k(s) = Σ (−s)^j/(k + 2j)!, for k = 0 … 6.

    The two highest come from their series, the others by c_k = 1/k! − s c_{k+2}, which loses no digits up to s = (2π)².

    Args:
        square: s, squares of angles, of any shape.

    Returns:
        c0 … c6, each of that shape.
    """
    c = [square] * (ORDER + 1)
    for k in (ORDER, ORDER - 1):
        c[k] = np.full_like(square, 1.0 / math.factorial(k + 2 * TERMS))
        for j in reversed(range(TERMS)):
            c[k] = 1.0 / math.factorial(k + 2 * j) - square * c[k]
    for k in reversed(range(ORDER - 1)):
        c[k] = 1.0 / math.factorial(k) - square * c[k + 2]
    return c


def cross_matrix(v: np.ndarray) -> np.ndarray:
    """[v] with [v] a = v × a, shape (3,) → (3, 3)."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


AXES = np.array([cross_matrix(axis) for axis in np.eye(3)])  # ∂[θ]/∂θk
PRODUCTS = np.einsum("kij,ljm->klim", AXES, AXES)
PRODUCTS = PRODUCTS + np.swapaxes(PRODUCTS, 0, 1)  # ∂²[θ]²/∂θk∂θl


def rotation_matrix(θ: ArrayLike) -> np.ndarray:
    """R = exp([θ]) of a rotation vector of any size, shape (3,), rad → (3, 3)."""
    R = np.empty((3, 3))
    exponential(np.asarray(θ, dtype=float), R)
    return R


def rotated(v: np.ndarray, θ: np.ndarray) -> np.ndarray:
    """Vectors turned by rotation vectors, v + c1 θ × v + c2 θ × (θ × v), shapes (m, 3)."""
    c, across = stumpff(np.sum(θ**2, axis=1, keepdims=True)), np.cross(θ, v)
    return np.asarray(v + c[1] * across + c[2] * np.cross(θ, across))


def carried(v: np.ndarray, ψ: np.ndarray, of: float, gap: float, to: float) -> np.ndarray:
    """Displacements over one interval, per its length, as they are over a later one if their rates turn with ψ.

    A rate u̇ that turns has moved a point by ∫ exp([tψ]) u̇ dt: along ψ as it is, across it in the direction half way,
    and less than without turning by the factor sin x/x, x = ½ |ψ| times the interval's length. So a point that turns
    about an axis is carried on along its circle.

    Args:
        v: displacements per length, shape (m, 3).
        ψ: rotations per length, shape (m, 3), rad.
        of: length of their interval; 0: they are rates at a moment.
        gap: from its end to the start of the later one.
        to: length of the later one.
    """
    turned, half = rotated(v, (0.5 * of + gap + 0.5 * to) * ψ), 0.5 * np.linalg.norm(ψ, axis=1, keepdims=True)
    axis = ψ / np.where(half > 0.0, 2.0 * half, 1.0)
    along = np.sum(turned * axis, axis=1, keepdims=True) * axis
    # of more than half a turn, which no step should have, the factor comes near to 0 / 0
    kept = np.where(half * max(of, to) < 0.5 * np.pi, _sinc(half * to) / _sinc(np.minimum(half * of, 0.5 * np.pi)), 1.0)
    return np.asarray(along + kept * (turned - along))


def _sinc(x: np.ndarray) -> np.ndarray:
    """sin x/x."""
    return np.asarray(np.sinc(x / np.pi))


def nearest_vector(R: np.ndarray, near: np.ndarray) -> np.ndarray:
    """The rotation vector of a matrix that is nearest to another vector, of any number of turns, shape (3,), rad."""
    v = np.empty(3)
    logarithm(np.ascontiguousarray(R), v)
    angle = float(np.linalg.norm(v))
    axis = v / angle if angle > 1e-9 else near / (np.linalg.norm(near) or 1.0)
    turns = np.round((near @ axis - angle) / (2.0 * np.pi))
    return v + 2.0 * np.pi * turns * axis


def rotation_derivatives(θ: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The rotation matrix with its first and second derivatives by the rotation vector.

    With M = [θ], a1 = 2 dc1/ds = c3 − c2, a2 = 2 dc2/ds = 2 c4 − c3, and b1, b2 the same of a1, a2,

        R,k = c1 M,k + c2 (M²),k + θk (a1 M + a2 M²),
        R,kl = c2 (M²),kl + (a1 M + a2 M²) δkl + (b1 M + b2 M²) θk θl
               + θl (a1 M,k + a2 (M²),k) + θk (a1 M,l + a2 (M²),l).

    Args:
        θ: rotation vector, shape (3,), rad.

    Returns:
        R, ∂R/∂θk and ∂²R/∂θk∂θl, shapes (3, 3), (3, 3, 3) and (3, 3, 3, 3), differentiations first; right to rounding
        up to 2π.
    """
    _, c1, c2, c3, c4, c5, c6 = stumpff(np.asarray(θ @ θ))
    a1, a2 = c3 - c2, 2.0 * c4 - c3
    b1, b2 = 3.0 * c5 - 3.0 * c4 + c3, 8.0 * c6 - 5.0 * c5 + c4
    M = cross_matrix(θ)
    M2, dM2 = M @ M, AXES @ M + M @ AXES
    along, first = a1 * M + a2 * M2, a1 * AXES + a2 * dM2
    mixed = np.einsum("k,lij->klij", θ, first)
    dR = c1 * AXES + c2 * dM2 + θ[:, None, None] * along
    ddR = c2 * PRODUCTS + np.einsum("kl,ij->klij", np.eye(3), along)
    ddR += np.einsum("k,l,ij->klij", θ, θ, b1 * M + b2 * M2) + mixed + np.swapaxes(mixed, 0, 1)
    return np.eye(3) + c1 * M + c2 * M2, dR, ddR


def chart_derivatives(θ: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The chart's tangent with its derivatives by the rotation vector.

    T,k = c2 M,k + c3 (M²),k + θk (a2 M + a3 M²), with M, a2 as in `rotation_derivatives` and a3 = 2 dc3/ds = 3 c5 − c4.

    Args:
        θ: rotation vector, shape (3,), rad.

    Returns:
        T and ∂T/∂θk, shapes (3, 3) and (3, 3, 3), differentiation first; right to rounding up to 2π.
    """
    _, _, c2, c3, c4, c5, _ = stumpff(np.asarray(θ @ θ))
    M = cross_matrix(θ)
    M2 = M @ M
    along = (2.0 * c4 - c3) * M + (3.0 * c5 - c4) * M2
    dT = c2 * AXES + c3 * (AXES @ M + M @ AXES) + θ[:, None, None] * along
    return np.eye(3) + c2 * M + c3 * M2, dT
