"""Equilibrium of the uniform coil's section, compiled: strains, resultants, and one step of Newton's method.

The equations and the letters are those of `coilset.model.physics.uniform_coil.rod`.
"""

import math
from collections import namedtuple

import numpy as np

from coilset.model.core.material.law.loop import flow_points
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit
from coilset.model.core.section.shape import shear_by_force

RADIUS, INCLINATION, RISE, TURN = range(4)  # the coordinates q = (R̄, ϑ, h̄, λ)
MAX_ITERATIONS = 25
PRECISION = 1e-9  # out-of-balance force over that which the step puts on the coil
ROUNDING = 1e-12  # below which, times the maximum resultant, nothing is out of balance

# One coil and how it is driven: the law; radius R, rise h, j = √(R² + h²); places and areas of the points;
# dm/dy, R/j² or, for a plain section, 0; m ∂(γ₁₂, γ₁₃)/∂Γ₃ at the points.
Coil = namedtuple("Coil", "law R h j y z area bend across along by_force free")


@njit(cache=True)
def force_shear(r: float, y: np.ndarray, z: np.ndarray, bend: float) -> tuple[np.ndarray, np.ndarray]:
    """m ∂(γ₁₂, γ₁₃)/∂Γ₃ at points y (outward), z of a wire of radius r, mm, as in `core/section/shape.py`."""
    across, along = np.empty_like(y), np.empty_like(y)
    for k in range(len(y)):
        # y is outward here, towards the centre there
        shear = shear_by_force(-y[k] / r, z[k] / r, bend * r, 1.0 + bend * y[k])
        across[k], along[k] = -shear[1], shear[3]
    return across, along


@njit(**INLINE)
def strains(coil: Coil, q: np.ndarray, E: np.ndarray) -> None:
    """Write E = (Γ₁, Γ₃, K₁, K₃) at the coordinates q."""
    c, s, j = math.cos(q[INCLINATION]), math.sin(q[INCLINATION]), coil.j
    around, up = q[TURN] * q[RADIUS], q[RISE]
    E[0] = (around * c + up * s) / j - 1.0
    E[1] = (up * c - around * s) / j
    E[2] = q[TURN] * s / j - coil.h / j**2
    E[3] = q[TURN] * c / j - coil.R / j**2


@njit(**INLINE)
def derivatives(coil: Coil, q: np.ndarray, S: np.ndarray, B: np.ndarray, H: np.ndarray) -> None:
    """Write B = ∂E/∂q and H = Σ S_k ∂²E_k/∂q², both 4 × 4."""
    c, s, j = math.cos(q[INCLINATION]), math.sin(q[INCLINATION]), coil.j
    r, up, λ = q[RADIUS], q[RISE], q[TURN]
    B[:] = 0.0
    B[0, RADIUS], B[0, INCLINATION], B[0, RISE], B[0, TURN] = λ * c, up * c - λ * r * s, s, r * c
    B[1, RADIUS], B[1, INCLINATION], B[1, RISE], B[1, TURN] = -λ * s, -λ * r * c - up * s, c, -r * s
    B[2, INCLINATION], B[2, TURN] = λ * c, s
    B[3, INCLINATION], B[3, TURN] = -λ * s, c
    B /= j
    H[:] = 0.0
    H[RADIUS, INCLINATION] = -λ * (S[0] * s + S[1] * c)
    H[RADIUS, TURN] = S[0] * c - S[1] * s
    H[INCLINATION, RISE] = S[0] * c - S[1] * s
    H[INCLINATION, TURN] = -r * (S[0] * s + S[1] * c) + S[2] * c - S[3] * s
    for a in range(4):
        for b in range(a):
            H[a, b] = H[b, a]
    H[INCLINATION, INCLINATION] = -S[0] * (λ * r * c + up * s) + S[1] * (λ * r * s - up * c) - λ * (S[2] * s + S[3] * c)
    H /= j


@njit(**KERNEL)
def integrate(
    coil: Coil,
    E: np.ndarray,
    old_E: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    S: np.ndarray,
    T: np.ndarray,
) -> bool:
    """Resultants S = (N, Q₃, Mt, M₃) and T = ∂S/∂E of the strains E, reached from `old_E` and the rows `old`.

    Returns:
        False if the law found no solution at some point, or a fibre is turned inside out.
    """
    S[:] = 0.0
    T[:] = 0.0
    points = len(coil.y)
    strain, tangent, count = np.empty((3, points)), np.empty((9, points)), np.empty(points, np.int64)
    for k in range(points):
        y, z = coil.y[k], coil.z[k]
        m = 1.0 + y * coil.bend
        stretched, before = m + E[0] + y * E[3], m + old_E[0] + y * old_E[3]
        if not stretched > 0.0:
            return False
        strain[0, k] = math.log(stretched / before)
        strain[1, k] = (coil.across[k] * (E[1] - old_E[1]) + (E[2] - old_E[2]) * z) / m
        strain[2, k] = (coil.along[k] * (E[1] - old_E[1]) - y * (E[2] - old_E[2])) / m
    if not flow_points(coil.law, 3, old, strain, new, tangent, True, count):
        return False
    for k in range(points):
        y, z, across, along = coil.y[k], coil.z[k], coil.across[k], coil.along[k]
        C, m = tangent[:, k], 1.0 + y * coil.bend
        stretched, dA = m + E[0] + y * E[3], coil.area[k] * m
        # ∂(ε₁₁, γ₁₂, γ₁₃)/∂E: (a, 0, 0, ya), b (0, across, z, 0), b (0, along, −y, 0)
        a, b = 1.0 / stretched, 1.0 / m
        σ, t2, t3 = new[k, 0] * dA, new[k, 1] * dA, new[k, 2] * dA
        S[0] += σ * a
        S[1] += (t2 * across + t3 * along) * b
        S[2] += (t2 * z - t3 * y) * b
        S[3] += σ * a * y
        c00 = (C[0] * dA - σ) * a * a  # with the logarithm's second derivative
        ab, bb = dA * a * b, dA * b * b
        c0q, cq0 = (C[1] * across + C[2] * along) * ab, (C[3] * across + C[6] * along) * ab
        c0t, ct0 = (C[1] * z - C[2] * y) * ab, (C[3] * z - C[6] * y) * ab
        q2, q3 = (C[4] * across + C[5] * along) * bb, (C[7] * across + C[8] * along) * bb
        t2, t3 = (C[4] * z - C[5] * y) * bb, (C[7] * z - C[8] * y) * bb
        cqq, cqt = across * q2 + along * q3, across * t2 + along * t3
        ctq, ctt = z * q2 - y * q3, z * t2 - y * t3
        T[0, 0] += c00
        T[0, 1] += c0q
        T[0, 2] += c0t
        T[0, 3] += c00 * y
        T[1, 0] += cq0
        T[1, 1] += cqq
        T[1, 2] += cqt
        T[1, 3] += cq0 * y
        T[2, 0] += ct0
        T[2, 1] += ctq
        T[2, 2] += ctt
        T[2, 3] += ct0 * y
        T[3, 0] += c00 * y
        T[3, 1] += c0q * y
        T[3, 2] += c0t * y
        T[3, 3] += c00 * y * y
    return math.isfinite(S.sum())


@njit(cache=True)
def residual_and_tangent(coil: Coil, q: np.ndarray, S: np.ndarray, T: np.ndarray, f: np.ndarray, K: np.ndarray) -> None:
    """Write f = ∂W/∂q per radian (N, and N mm for ϑ and λ) and its derivative K; ∂W/∂h̄ is the force that pulls."""
    B, H = np.empty((4, 4)), np.empty((4, 4))
    derivatives(coil, q, S, B, H)
    for a in range(4):
        f[a] = 0.0
        for k in range(4):
            f[a] += coil.j * S[k] * B[k, a]
        for b in range(4):
            K[a, b] = H[a, b]
            for k in range(4):
                for l in range(4):
                    K[a, b] += B[k, a] * T[k, l] * B[l, b]
            K[a, b] *= coil.j


@njit(cache=True)
def step(
    coil: Coil,
    value: float,
    elastic: bool,
    q: np.ndarray,
    points: np.ndarray,
    new: np.ndarray,
    S: np.ndarray,
    T: np.ndarray,
) -> tuple[bool, float, float]:
    """One step: to the rise `value` (mm/rad), or under the axial force `value` (compression positive, N).

    Args:
        coil: Coil.
        elastic: begin with the elastic tangent, not with that of the last step.
        q, points: coordinates and point states at the last equilibrium; replaced if there is a new one.
        new: room for point states.
        S, T: resultants and their tangent at the last equilibrium; replaced.

    Returns:
        Whether there is an equilibrium, the axial force (compression positive, N) and the torque (N mm).
    """
    E, old_E = np.empty(4), np.empty(4)
    f, K, held = np.empty(4), np.empty((4, 4)), np.zeros(4, dtype=np.bool_)
    trial, scale = q.copy(), np.array([1.0, 1.0 / coil.R, 1.0, 1.0 / coil.R])
    kept_S, kept_T = S.copy(), T.copy()
    held[RISE], held[TURN] = not coil.by_force, not coil.free
    strains(coil, q, old_E)
    good = integrate(coil, old_E, old_E, points, new, S, T) if elastic else True
    load = 0.0
    for iteration in range(MAX_ITERATIONS):
        if not good:
            break
        residual_and_tangent(coil, trial, S, T, f, K)
        force, torque = -f[RISE], f[TURN]
        f[RISE] += value if coil.by_force else 0.0
        size = 0.0
        for a in range(4):
            if not held[a]:
                size = max(size, abs(f[a] * scale[a]))
        if iteration == 0:
            load = abs(f[RISE]) if coil.by_force else np.abs(K[:, RISE] * scale).max() * abs(value - q[RISE])
            load = max(load, size)  # what time alone brings out of balance
        elif size <= max(PRECISION * load, ROUNDING * np.abs(S).max()):
            q[:], points[:] = trial, new
            return True, force, torque
        for a in range(4):
            if held[a]:
                for b in range(4):
                    K[a, b] = 1.0 if a == b else 0.0
                f[a] = 0.0
        if iteration == 0 and not coil.by_force:
            f[RISE] = q[RISE] - value
        trial -= np.linalg.solve(K, f)
        strains(coil, trial, E)
        good = integrate(coil, E, old_E, points, new, S, T)
    S[:], T[:] = kept_S, kept_T
    return False, 0.0, 0.0
