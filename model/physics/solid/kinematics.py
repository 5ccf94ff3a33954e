"""Finite increments at the points: logarithmic stretch and polar rotation, and their exact linearisation.

The increment is `F = R U` from the last equilibrium. The law is integrated in the unrotated frame with the strain
increment `ln U`, and stress and back stress are rotated by R. On the path `R(t) exp(t ln U)` the spin of R is the
material's spin W, so this integrates the Zaremba-Jaumann rate of chapter 3 without error of its own; a rigid motion
superposed on the increment only rotates the result, and `tr ln U` is the logarithm of the change of
volume.

Six components are ordered 11, 22, 33, 12, 13, 23. Internally, Mandel's basis is used (shear times √2), in which
rotations of tensors are orthogonal 6 × 6 matrices.
"""

import math

import numpy as np

from coilset.model.core.runtime.kernels import njit

ROOT2 = math.sqrt(2.0)
FIRST = (0, 1, 2, 0, 0, 1)
SECOND = (0, 1, 2, 1, 2, 2)


@njit(cache=True)
def eigen_symmetric(A: np.ndarray, Q: np.ndarray) -> None:
    """Diagonalise the symmetric 3 × 3 matrix A by Jacobi's rotations: A becomes diagonal, Q holds its eigenvectors."""
    for i in range(3):
        for j in range(3):
            Q[i, j] = 1.0 if i == j else 0.0
    for _ in range(12):
        off = A[0, 1] ** 2 + A[0, 2] ** 2 + A[1, 2] ** 2
        if off <= 1e-34 * (A[0, 0] ** 2 + A[1, 1] ** 2 + A[2, 2] ** 2):
            return
        for p in range(2):
            for q in range(p + 1, 3):
                if A[p, q] == 0.0:
                    continue
                θ = 0.5 * (A[q, q] - A[p, p]) / A[p, q]
                t = math.copysign(1.0, θ) / (abs(θ) + math.sqrt(1.0 + θ * θ))
                c = 1.0 / math.sqrt(1.0 + t * t)
                s = t * c
                for k in range(3):
                    x, y = A[k, p], A[k, q]
                    A[k, p], A[k, q] = c * x - s * y, s * x + c * y
                for k in range(3):
                    x, y = A[p, k], A[q, k]
                    A[p, k], A[q, k] = c * x - s * y, s * x + c * y
                for k in range(3):
                    x, y = Q[k, p], Q[k, q]
                    Q[k, p], Q[k, q] = c * x - s * y, s * x + c * y


@njit(cache=True)
def invert(A: np.ndarray, B: np.ndarray) -> float:
    """Write A⁻¹ into B, 3 × 3, and return det A."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for m in range(3):
            n, o = (m + 1) % 3, (m + 2) % 3
            B[m, i] = A[j, n] * A[k, o] - A[j, o] * A[k, n]
    det = A[0, 0] * B[0, 0] + A[0, 1] * B[1, 0] + A[0, 2] * B[2, 0]
    if det != 0.0:
        for i in range(3):
            for j in range(3):
                B[i, j] /= det
    return det


@njit(cache=True)
def mandel_rotation(Q: np.ndarray, M: np.ndarray) -> None:
    """Write into M, 6 × 6, the matrix that takes Mandel components of T to those of Q T Qᵀ."""
    for a in range(6):
        i, j = FIRST[a], SECOND[a]
        for b in range(6):
            k, m = FIRST[b], SECOND[b]
            entry = Q[i, k] * Q[j, m]
            if b >= 3:
                entry = (entry + Q[i, m] * Q[j, k]) / ROOT2
            M[a, b] = ROOT2 * entry if a >= 3 else entry


@njit(cache=True)
def stretches(
    gradient: np.ndarray, strain: np.ndarray, axes: np.ndarray, rotation: np.ndarray, log_stretch: np.ndarray
) -> int:
    """Split increments into stretch and rotation.

    Args:
        gradient: ∂Δu/∂x at the end of the increment, shape (points, 3, 3).
        strain: written, ln U in the unrotated frame, shear doubled, shape (points, 6).
        axes: written, columns are the eigenvectors of U, shape (points, 3, 3).
        rotation: written, R, shape (points, 3, 3).
        log_stretch: written, logarithms of the eigenvalues of U, shape (points, 3).

    Returns:
        0, or -1 if the increment inverts the material at some point.
    """
    back, F, C, W = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for point in range(len(gradient)):
        Q, R, ln = axes[point], rotation[point], log_stretch[point]
        for i in range(3):
            for j in range(3):
                back[i, j] = (1.0 if i == j else 0.0) - gradient[point, i, j]
        if not invert(back, F) > 0.0:
            return -1
        for i in range(3):
            for j in range(3):
                C[i, j] = F[0, i] * F[0, j] + F[1, i] * F[1, j] + F[2, i] * F[2, j]
        eigen_symmetric(C, Q)
        for k in range(3):
            ln[k] = 0.5 * math.log(C[k, k])
        for a in range(6):
            i, j = FIRST[a], SECOND[a]
            entry = ln[0] * Q[i, 0] * Q[j, 0] + ln[1] * Q[i, 1] * Q[j, 1] + ln[2] * Q[i, 2] * Q[j, 2]
            strain[point, a] = entry if a < 3 else 2.0 * entry
        for i in range(3):  # W = F Q / λ, R = W Qᵀ
            for k in range(3):
                W[i, k] = (F[i, 0] * Q[0, k] + F[i, 1] * Q[1, k] + F[i, 2] * Q[2, k]) / math.exp(ln[k])
        for i in range(3):
            for j in range(3):
                R[i, j] = W[i, 0] * Q[j, 0] + W[i, 1] * Q[j, 1] + W[i, 2] * Q[j, 2]
    return 0


@njit(cache=True)
def turn(M: np.ndarray, t: np.ndarray, out: np.ndarray) -> None:
    """Write into `out` the six components of the tensor `t` after the Mandel rotation M; `out` may be `t`."""
    x = (t[0], t[1], t[2], ROOT2 * t[3], ROOT2 * t[4], ROOT2 * t[5])
    for a in range(6):
        y = 0.0
        for b in range(6):
            y += M[a, b] * x[b]
        out[a] = y if a < 3 else y / ROOT2


@njit(cache=True)
def _sandwich(M: np.ndarray, C: np.ndarray, transpose: bool, work: np.ndarray, out: np.ndarray) -> None:
    """out = M C Mᵀ, or Mᵀ C M if `transpose`."""
    for i in range(6):
        for j in range(6):
            x = 0.0
            for k in range(6):
                x += C[i, k] * (M[k, j] if transpose else M[j, k])
            work[i, j] = x
    for i in range(6):
        for j in range(6):
            x = 0.0
            for k in range(6):
                x += (M[k, i] if transpose else M[i, k]) * work[k, j]
            out[i, j] = x


@njit(cache=True)
def principal_moduli(s: np.ndarray, ln: np.ndarray, C: np.ndarray, A: np.ndarray) -> None:
    """Moduli of the increment in the axes of U, from those of the law.

    With d = sym(δx-gradient) rotated back by R, x = ln λi − ln λj, in these axes (δR Rᵀ and δ ln U of F = R U):

        δ(ln U)ij = x / sinh x · dij        (δR Rᵀ)ij = wij − tanh(x/2) dij

    so that δσ = w σ − σ w + C : δ ln U − N s + s N with N = tanh(x/2) ∘ d. The current volume adds σ tr d, and the
    rotation of the gradient −σ (d − w); what remains of both besides the initial-stress term is −(d s + s d).

    Args:
        s: stress in the axes of U, 3 × 3.
        ln: logarithms of the eigenvalues of U.
        C: ∂s/∂(ln U) in the axes of U, Mandel's basis, 6 × 6.
        A: written, 6 × 6, Mandel's basis.
    """
    for b in range(6):
        k, m = FIRST[b], SECOND[b]
        x = ln[k] - ln[m]
        ratio = 1.0 - x * x / 6.0 if abs(x) < 1e-4 else x / math.sinh(x)
        turning = math.tanh(0.5 * x)
        unit = 1.0 if b < 3 else 1.0 / ROOT2  # d = unit (e_k e_m + e_m e_k) / (1 or 2 if k = m)
        for a in range(6):
            i, j = FIRST[a], SECOND[a]
            # d s + s d and N s − s N for d with the entries (k, m) and (m, k), N with turning and −turning
            ds = (unit * s[m, j] if i == k else 0.0) + (unit * s[i, k] if j == m else 0.0)
            ns = (turning * unit * s[m, j] if i == k else 0.0) - (turning * unit * s[i, k] if j == m else 0.0)
            if b >= 3:
                ds += (unit * s[k, j] if i == m else 0.0) + (unit * s[i, m] if j == k else 0.0)
                ns += -(turning * unit * s[k, j] if i == m else 0.0) + (turning * unit * s[i, m] if j == k else 0.0)
            volume = s[i, j] if b < 3 else 0.0
            weight = 1.0 if a < 3 else ROOT2
            A[a, b] = C[a, b] * ratio + weight * (volume - ds - ns)


@njit(cache=True)
def push_forward(
    state: np.ndarray,
    C: np.ndarray,
    axes: np.ndarray,
    rotation: np.ndarray,
    log_stretch: np.ndarray,
    stress: np.ndarray,
    moduli: np.ndarray,
    symmetric: bool,
) -> None:
    """Rotate the state into the current configuration and form the moduli of the virtual work's linearisation.

    The linearised virtual work is ∫ δd : A : d + ∇δu : (∇u σ) over the current volume.

    Args:
        state: point states after the increment in the unrotated frame; stress, back stress and, behind b*, each six
            entries of further back stresses are rotated in place; up to five before them are scalars. Shape (points,
            n).
        C: ∂σ/∂D of the law (columns for strain components with doubled shear), shape (points, 6, 6), MPa.
        axes, rotation, log_stretch: of `stretches`.
        stress: written, Cauchy stress, shape (points, 6), MPa.
        moduli: written, A for strain components with doubled shear, shape (points, 6, 6), MPa.
        symmetric: keep only the symmetric part of A.
    """
    MQ, MR, MW = np.empty((6, 6)), np.empty((6, 6)), np.empty((6, 6))
    mandel, principal, work, A = np.empty((6, 6)), np.empty((6, 6)), np.empty((6, 6)), np.empty((6, 6))
    six, s = np.empty(6), np.empty((3, 3))
    weight = np.array([1.0, 1.0, 1.0, ROOT2, ROOT2, ROOT2])
    for point in range(len(state)):
        mandel_rotation(axes[point], MQ)
        mandel_rotation(rotation[point], MR)
        for i in range(6):
            for j in range(6):
                mandel[i, j] = weight[i] * C[point, i, j] * weight[j]
                MW[i, j] = 0.0
                for k in range(6):
                    MW[i, j] += MR[i, k] * MQ[k, j]
        _sandwich(MQ, mandel, True, work, principal)
        turn(MQ.T, state[point, :6], six)
        for a in range(6):
            s[FIRST[a], SECOND[a]] = six[a]
            s[SECOND[a], FIRST[a]] = six[a]
        principal_moduli(s, log_stretch[point], principal, A)
        _sandwich(MW, A, False, work, mandel)
        for i in range(6):
            for j in range(6):
                entry = 0.5 * (mandel[i, j] + mandel[j, i]) if symmetric else mandel[i, j]
                moduli[point, i, j] = entry / (weight[i] * weight[j])
        turn(MR, state[point, :6], state[point, :6])
        turn(MR, state[point, 6:12], state[point, 6:12])
        for first in range(13 + (state.shape[1] - 13) % 6, state.shape[1] - 5, 6):
            turn(MR, state[point, first : first + 6], state[point, first : first + 6])
        for a in range(6):
            stress[point, a] = state[point, a]
