"""Rotation vector, matrix, and the tangent of the chart; compiled kernels on single 3-vectors and 3×3 matrices.

Rodrigues' formula and its inverse; see J. Argyris, An excursion into large rotations, CMAME 32 (1982) 85. All write
into arrays of the caller, so that a loop over nodes allocates nothing.
"""

import math

import numpy as np

from coilset.model.core.runtime.kernels import njit

NEARLY_BACK = -0.9  # cosine of the angle from which on the symmetric part of a rotation gives its axis


@njit(cache=True)
def exponential(v: np.ndarray, R: np.ndarray) -> None:
    """Write into `R` the rotation matrix of the rotation vector `v` (rad): R = 1 + a v× + b v×v×."""
    x, y, z = v[0], v[1], v[2]
    angle2 = x * x + y * y + z * z
    if angle2 < 1e-6:  # series, error below 1e-15
        a = 1.0 - angle2 / 6.0 + angle2 * angle2 / 120.0
        b = 0.5 - angle2 / 24.0 + angle2 * angle2 / 720.0
    else:
        angle = math.sqrt(angle2)
        a = math.sin(angle) / angle
        b = (1.0 - math.cos(angle)) / angle2
    R[0, 0] = 1.0 - b * (y * y + z * z)
    R[0, 1] = b * x * y - a * z
    R[0, 2] = b * x * z + a * y
    R[1, 0] = b * x * y + a * z
    R[1, 1] = 1.0 - b * (x * x + z * z)
    R[1, 2] = b * y * z - a * x
    R[2, 0] = b * x * z - a * y
    R[2, 1] = b * y * z + a * x
    R[2, 2] = 1.0 - b * (x * x + y * y)


@njit(cache=True)
def logarithm(R: np.ndarray, v: np.ndarray) -> None:
    """Write into `v` the rotation vector of the matrix `R`, of an angle up to π; at π itself one of the two.

    The antisymmetric part of R = 1 + sin α [n] + (1 − cos α)(n nᵀ − 1) gives the axis n, unless the sine is small
    beside α: then the symmetric part does, but for its sign.
    """
    x, y, z = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]  # 2 sin(angle) times the axis
    sine = 0.5 * math.sqrt(x * x + y * y + z * z)
    cosine = 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0)
    angle = math.atan2(sine, cosine)
    if cosine > NEARLY_BACK:
        # angle / (2 sin angle); series where sine and angle vanish together
        factor = 0.5 + angle * angle / 12.0 + 7.0 * angle**4 / 720.0 if angle < 1e-3 else 0.5 * angle / sine
        v[0], v[1], v[2] = factor * x, factor * y, factor * z
        return
    k = 0
    for i in range(1, 3):
        if R[i, i] > R[k, k]:
            k = i
    for i in range(3):  # (1 − cos α) n[k] n, with |n[k]| > 1/2
        v[i] = 0.5 * (R[i, k] + R[k, i])
    v[k] -= cosine
    factor = angle / math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    if v[0] * x + v[1] * y + v[2] * z < 0.0:
        factor = -factor
    for i in range(3):
        v[i] *= factor


@njit(cache=True)
def chart_tangent(v: np.ndarray, T: np.ndarray) -> None:
    """Write into `T` the matrix with ω = T v̇: spatial spin of exp(v) for a rate of the rotation vector."""
    x, y, z = v[0], v[1], v[2]
    angle2 = x * x + y * y + z * z
    if angle2 < 1e-6:
        b = 0.5 - angle2 / 24.0
        c = 1.0 / 6.0 - angle2 / 120.0
    else:
        angle = math.sqrt(angle2)
        b = (1.0 - math.cos(angle)) / angle2
        c = (angle - math.sin(angle)) / (angle2 * angle)
    T[0, 0] = 1.0 - c * (y * y + z * z)
    T[0, 1] = c * x * y - b * z
    T[0, 2] = c * x * z + b * y
    T[1, 0] = c * x * y + b * z
    T[1, 1] = 1.0 - c * (x * x + z * z)
    T[1, 2] = c * y * z - b * x
    T[2, 0] = c * x * z - b * y
    T[2, 1] = c * y * z + b * x
    T[2, 2] = 1.0 - c * (x * x + y * y)


@njit(cache=True)
def inverse_chart_tangent(v: np.ndarray, P: np.ndarray, factors: np.ndarray) -> None:
    """Write into `P` the inverse of the chart's tangent: v̇ = P ω, for angles below 2π.

    P = 1 − ½ [v] + c [v]², c = (1 − ½ α cot ½ α)/α² with the angle α = |v|. `factors` gets c, and ζ of its rate
    ċ = ζ v · v̇, ζ = (¼ − 3 c + c² α²)/α².
    """
    x, y, z = v[0], v[1], v[2]
    angle2 = x * x + y * y + z * z
    if angle2 < 1e-2:  # series, errors below 1e-15 and 1e-14
        c = 1.0 / 12.0 + angle2 * (1.0 / 720.0 + angle2 * (1.0 / 30240.0 + angle2 * (1.0 / 1209600.0)))
        rate = 1.0 / 360.0 + angle2 * (1.0 / 7560.0 + angle2 * (1.0 / 201600.0 + angle2 * (1.0 / 5987520.0)))
    else:
        half = 0.5 * math.sqrt(angle2)
        c = (1.0 - half / math.tan(half)) / angle2
        rate = (0.25 - 3.0 * c + c * c * angle2) / angle2
    factors[0], factors[1] = c, rate
    P[0, 0] = 1.0 - c * (y * y + z * z)
    P[0, 1] = c * x * y + 0.5 * z
    P[0, 2] = c * x * z - 0.5 * y
    P[1, 0] = c * x * y - 0.5 * z
    P[1, 1] = 1.0 - c * (x * x + z * z)
    P[1, 2] = c * y * z + 0.5 * x
    P[2, 0] = c * x * z + 0.5 * y
    P[2, 1] = c * y * z - 0.5 * x
    P[2, 2] = 1.0 - c * (x * x + y * y)


@njit(cache=True)
def multiply(A: np.ndarray, B: np.ndarray, C: np.ndarray) -> None:
    """C = A B for 3×3 matrices, without an allocation."""
    for i in range(3):
        for j in range(3):
            C[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]


@njit(cache=True)
def multiply_transposed(A: np.ndarray, B: np.ndarray, C: np.ndarray) -> None:
    """C = Aᵀ B for 3×3 matrices, without an allocation."""
    for i in range(3):
        for j in range(3):
            C[i, j] = A[0, i] * B[0, j] + A[1, i] * B[1, j] + A[2, i] * B[2, j]


@njit(cache=True)
def rotate(v: np.ndarray, R_old: np.ndarray, R_new: np.ndarray, T: np.ndarray, work: np.ndarray) -> None:
    """Rotate a node's matrix by its rotation vector: R_new = exp(v) R_old, with the chart's tangent T.

    Args:
        v: rotation vector since the last equilibrium, shape (3,), rad.
        R_old: rotation at the last equilibrium, shape (3, 3).
        R_new, T: written, shape (3, 3).
        work: 3×3 matrix of work space.
    """
    exponential(v, work)
    multiply(work, R_old, R_new)
    chart_tangent(v, T)
