"""The warping of one section: its strains, Newton's method for it, and its condensation; see `warping`."""

import math

import numpy as np

from coilset.model.material.point.choice import solid_point
from coilset.model.runtime.kernels import KERNEL, njit

# A change of the warping, a strain, that ends the iteration. Its effect on the resultants is added to them, so that
# their error is its square over the strain at which the law's slope changes, some 1e-3.
TOLERANCE = 1e-10
MAX_ITERATIONS = 40
SHORTEST = 1e-3  # part of a correction


@njit(cache=True)
def strain_operator(
    y: np.ndarray, z: np.ndarray, f: np.ndarray, radius: float, curvature: float, torsion: float, B: np.ndarray
) -> None:
    """Strains of a section's points for unit section strains and unit warping.

    Columns: ε, γ12, γ13, φ′, κ2, κ3; w2 = y, w3 = z, (w2, w3) = (z, y); then the polynomials as w1, w2, w3 in turn.
    Rows of a point: ε11, ε22, ε33, γ12, γ13, γ23.

    Args:
        y, z: on the unit disk, shape (points,).
        f: polynomials and their slopes, shape (3, points, polynomials).
        radius, curvature, torsion: of the wire, mm and 1/mm.
        B: written, shape (points, 6, 9 + 3 polynomials); its zeros are taken to be there.
    """
    kr, tr = curvature * radius, torsion * radius
    n = f.shape[2]
    for p in range(len(y)):
        Y, Z = y[p], z[p]
        i = 1.0 / (1.0 - kr * Y)
        b = B[p]
        b[0, 0] = b[3, 1] = b[4, 2] = i
        b[3, 3], b[4, 3] = -radius * Z * i, radius * Y * i
        b[0, 4], b[0, 5] = radius * Z * i, -radius * Y * i
        # w2 = y: Ω × w = (−κ w2, 0, τ w2), τ (z w,y − y w,z) = τ z along n
        b[0, 6], b[1, 6], b[3, 6], b[4, 6] = -kr * Y * i, 1.0, tr * Z * i, tr * Y * i
        # w3 = z: Ω × w = (0, −τ w3, 0), −τ y along b
        b[2, 7], b[3, 7], b[4, 7] = 1.0, -tr * Z * i, -tr * Y * i
        # (z, y): Ω × w = (−κ z, −τ y, τ z), τ (−y, z) along n and b
        b[0, 8], b[3, 8], b[4, 8], b[5, 8] = -kr * Z * i, -2.0 * tr * Y * i, 2.0 * tr * Z * i, 2.0
        for k in range(n):
            value, fy, fz = f[0, p, k], f[1, p, k], f[2, p, k]
            turned = tr * (Z * fy - Y * fz) * i
            bent, twisted = kr * value * i, tr * value * i
            j = 9 + k
            b[0, j], b[3, j], b[4, j] = turned, bent + fy, fz
            j += n
            b[0, j], b[1, j], b[3, j], b[4, j], b[5, j] = -bent, fy, turned, twisted, fz
            j += n
            b[2, j], b[3, j], b[4, j], b[5, j] = fz, -twisted, turned, fy


@njit(cache=True)
def find_warping(
    p: np.ndarray,
    B: np.ndarray,
    dA: np.ndarray,
    old: np.ndarray,
    old_a: np.ndarray,
    a: np.ndarray,
    new: np.ndarray,
    step: np.ndarray,
    C: np.ndarray,
    CB: np.ndarray,
    K: np.ndarray,
    r: np.ndarray,
    X: np.ndarray,
    count: np.ndarray,
) -> bool:
    """Newton's method for the warping `a` at the section strain increment in the first six places of `step`.

    Far from the solution a correction may overshoot, since flow makes the section soft. If the work of the residual
    forces, r_a · Δa, is larger in magnitude after it than before, it is shortened to the zero of a straight line
    through both.

    K, r: written, stiffness and forces of strains and warping; X: written, D_aa⁻¹ (D_ae, r_a) in its last columns.

    Returns:
        Whether the law had a solution everywhere and the last change of the warping is within the tolerance.
    """
    n = len(a)
    before, part = math.inf, 1.0
    for _ in range(MAX_ITERATIONS):
        for i in range(n):
            step[6 + i] = a[i] - old_a[i]
        count[1] += 1
        if not integrate(p, B, dA, step, old, new, C, CB, K, r):
            return False
        after = 0.0
        if before < math.inf:
            for i in range(n):
                after -= X[i, n + 6] * r[6 + i]
        if after > before and part > SHORTEST:
            shorter = part * max(before / (before + after), 0.1)
            for i in range(n):
                a[i] += (part - shorter) * X[i, n + 6]
            part = shorter
            continue
        X[:, :n] = K[6:, 6:]
        X[:, n : n + 6] = K[6:, :6]
        X[:, n + 6] = r[6:]
        if not eliminate(X):
            return False
        largest, before, part = 0.0, 0.0, 1.0
        for i in range(n):
            largest = max(largest, abs(X[i, n + 6]))
            before += X[i, n + 6] * r[6 + i]
        if not math.isfinite(largest):
            return False
        if largest <= TOLERANCE:
            return True
        for i in range(n):
            a[i] -= X[i, n + 6]
    return False


@njit(**KERNEL)
def integrate(
    p: np.ndarray,
    B: np.ndarray,
    dA: np.ndarray,
    step: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    C: np.ndarray,
    CB: np.ndarray,
    K: np.ndarray,
    r: np.ndarray,
) -> bool:
    """Stresses of all points for the increment `step` of strains and warping, r = ∫ Bᵀ σ g dA, K = ∫ Bᵀ C B g dA."""
    size = len(step)
    n = (size - 9) // 3
    K[:] = 0.0
    r[:] = 0.0
    strain = np.empty(6)
    for k in range(len(dA)):
        b, area = B[k], dA[k]
        strain[:] = 0.0
        for j in range(size):
            for i in range(6):
                strain[i] += b[i, j] * step[j]
        if solid_point(p, old[k], strain, new[k], C) < 0:
            return False
        for i in range(6):
            sigma = new[k, i] * area
            c0, c1, c2, c3, c4, c5 = C[i, 0], C[i, 1], C[i, 2], C[i, 3], C[i, 4], C[i, 5]
            for j in range(size):
                r[j] += b[i, j] * sigma
                CB[i, j] = area * (
                    c0 * b[0, j] + c1 * b[1, j] + c2 * b[2, j] + c3 * b[3, j] + c4 * b[4, j] + c5 * b[5, j]
                )
        for i in range(9):
            add_rows(b, CB, i, K)
        for i in range(9, 9 + n):  # w1 strains ε11, γ12, γ13 only
            b0, b3, b4 = b[0, i], b[3, i], b[4, i]
            for j in range(size):
                K[i, j] += b0 * CB[0, j] + b3 * CB[3, j] + b4 * CB[4, j]
        for i in range(9 + n, 9 + 2 * n):  # w2 all but ε33
            b0, b1, b3, b4, b5 = b[0, i], b[1, i], b[3, i], b[4, i], b[5, i]
            for j in range(size):
                K[i, j] += b0 * CB[0, j] + b1 * CB[1, j] + b3 * CB[3, j] + b4 * CB[4, j] + b5 * CB[5, j]
        for i in range(9 + 2 * n, size):  # w3 all but ε11 and ε22
            b2, b3, b4, b5 = b[2, i], b[3, i], b[4, i], b[5, i]
            for j in range(size):
                K[i, j] += b2 * CB[2, j] + b3 * CB[3, j] + b4 * CB[4, j] + b5 * CB[5, j]
    return True


@njit(**KERNEL)
def add_rows(b: np.ndarray, CB: np.ndarray, i: int, K: np.ndarray) -> None:
    """Add row i of Bᵀ (C B)."""
    b0, b1, b2, b3, b4, b5 = b[0, i], b[1, i], b[2, i], b[3, i], b[4, i], b[5, i]
    for j in range(K.shape[0]):
        K[i, j] += b0 * CB[0, j] + b1 * CB[1, j] + b2 * CB[2, j] + b3 * CB[3, j] + b4 * CB[4, j] + b5 * CB[5, j]


@njit(**KERNEL)
def eliminate(X: np.ndarray) -> bool:
    """Solve in place: the first n columns of X, shape (n, n + m), are a matrix, the others right-hand sides.

    Gaussian elimination with partial pivoting; False if the matrix is singular.
    """
    n, columns = X.shape
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(X[i, k]) > abs(X[best, k]):
                best = i
        if not abs(X[best, k]) > 0.0:
            return False
        if best != k:
            for j in range(k, columns):
                X[k, j], X[best, j] = X[best, j], X[k, j]
        inverse = 1.0 / X[k, k]
        for i in range(k + 1, n):
            factor = X[i, k] * inverse
            for j in range(k + 1, columns):
                X[i, j] -= factor * X[k, j]
    for k in range(n - 1, -1, -1):
        inverse = 1.0 / X[k, k]
        for j in range(n, columns):
            X[k, j] *= inverse
        for i in range(k):
            for j in range(n, columns):
                X[i, j] -= X[i, k] * X[k, j]
    return True


@njit(cache=True)
def condense(K: np.ndarray, r: np.ndarray, X: np.ndarray, s: np.ndarray, D: np.ndarray) -> None:
    """s = r_e − D_ea D_aa⁻¹ r_a, D = D_ee − D_ea D_aa⁻¹ D_ae, with X as `find_warping` leaves it."""
    n = len(X)
    for i in range(6):
        s[i] = r[i]
        for k in range(n):
            s[i] -= K[i, 6 + k] * X[k, n + 6]
        for j in range(6):
            D[i, j] = K[i, j]
            for k in range(n):
                D[i, j] -= K[i, 6 + k] * X[k, n + j]
