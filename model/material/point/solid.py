"""The constitutive law for the full stress state.

Order of components: 11, 22, 33, 12, 13, 23. Strain increments hold engineering shear strains, γ12 = 2ε12; stress and
back stress hold the tensor's components. A point's state is a row of σ (6), B (6), b* and, where each point has its
own, the temperature, in N/mm² and K; what stands behind stays.

The law is hypoelastic with the Zaremba-Jaumann rate (3.1.2): it holds in a frame that rotates with the material's spin.
The caller works in such a frame, or rotates the point's state by the increment's rotation first.
"""

import numpy as np

from coilset.model.material.law.functions import TEMPERATURE, elasticity, functions
from coilset.model.material.point.local import Local, Start, Turn, solve, yield_crossing
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

Six = tuple[float, float, float, float, float, float]  # components 11, 22, 33, 12, 13, 23
Pair = tuple[float, float]


@njit(**INLINE)
def _inner(a: Six, b: Six) -> float:
    """a:b of two symmetric tensors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])


@njit(**INLINE)
def _deviator_increment(dD: np.ndarray, G: float) -> Six:
    """2G times the deviator of a strain increment."""
    g = 2.0 * G
    mean = (dD[0] + dD[1] + dD[2]) / 3.0
    return (g * (dD[0] - mean), g * (dD[1] - mean), g * (dD[2] - mean), G * dD[3], G * dD[4], G * dD[5])


@njit(**INLINE)
def _active(row: np.ndarray) -> Six:
    """n = T − B of a point's state."""
    mean = (row[0] + row[1] + row[2]) / 3.0
    return (
        row[0] - mean - row[6],
        row[1] - mean - row[7],
        row[2] - mean - row[8],
        row[3] - row[9],
        row[4] - row[10],
        row[5] - row[11],
    )


@njit(**INLINE)
def _combined(f: float, a: Six, g: float, b: Six) -> Six:
    """f a + g b."""
    return (
        f * a[0] + g * b[0],
        f * a[1] + g * b[1],
        f * a[2] + g * b[2],
        f * a[3] + g * b[3],
        f * a[4] + g * b[4],
        f * a[5] + g * b[5],
    )


@njit(**INLINE)
def _elastic(old: np.ndarray, dD: np.ndarray, E: float, G: float, new: np.ndarray, C: np.ndarray) -> Six:
    bulk = E * G / (3.0 * (3.0 * G - E))
    volume = bulk * (dD[0] + dD[1] + dD[2])
    e = _deviator_increment(dD, G)
    for i in range(6):
        new[i] = old[i] + e[i] + (volume if i < 3 else 0.0)
        for j in range(6):
            C[i, j] = 0.0
    for i in range(6, old.shape[0]):
        new[i] = old[i]
    for i in range(3):
        for j in range(3):
            C[i, j] = bulk - 2.0 * G / 3.0
        C[i, i] += 2.0 * G
        C[3 + i, 3 + i] = G
    return e


@njit(**KERNEL)
def return_map(p: np.ndarray, old: np.ndarray, dD: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """One increment of the law for the full stress state, of second order (see `local`), with its consistent tangent.

    Args:
        p: parameter array of the law, `Law.parameters()`.
        old: the point's state at the start, shape (13,), or longer if the point has a temperature of its own; not
            written.
        dD: strain increment, shape (6,), engineering shear strains.
        new: the state at the end; always fully written.
        C: dσ/dε, shape (6, 6), N/mm²; written.

    Returns:
        Number of local iterations, 0 for an elastic increment, -1 if there was no convergence (then `new` is `old`, C
        elastic).
    """
    temperature = old[13] if old.shape[0] > 13 else p[TEMPERATURE]
    E, G, _ = elasticity(p, temperature)
    e = _elastic(old, dD, E, G, new, C)
    n0 = _active(old)
    trial = _active(new)
    values = functions(p, old[12], temperature)
    if _inner(trial, trial) <= values[0] * (1.0 + 1e-12):
        return 0

    ne, ee = _inner(n0, e), _inner(e, e)
    beta = yield_crossing(_inner(n0, n0), ne, ee, values[0])
    rest = 1.0 - beta
    n0 = _combined(1.0, n0, beta, e)
    nn, ne = _inner(n0, n0), _inner(n0, e)
    c = 2.0 * G
    start = Start(old[12], temperature, c, 0.0, 0.0, c, nn, rest * ne, rest * rest * ee)
    local = solve(p, start, values)
    if local.iterations < 0:
        for i in range(new.shape[0]):
            new[i] = old[i]
        return local.iterations
    t, m = local.c, 1.0 / (c + local.zeta)
    pl = _combined(m * (1.0 - t.phi), n0, m * rest * (1.0 - t.y), e)
    for i in range(6):
        new[i] -= c * pl[i]
        new[6 + i] += local.zeta * pl[i]  # (3.1.8)
    new[12] = local.b
    _tangent(local, n0, e, beta, (ne, ee), t, m, c, C)
    return local.iterations


@njit(**INLINE)
def _pair(f: float, a: Pair, g: float, b: Pair) -> Pair:
    return (f * a[0] + g * b[0], f * a[1] + g * b[1])


@njit(**INLINE)
def _tangent(
    local: Local,
    n0: Six,
    e: Six,
    beta: float,
    products: tuple[float, float],
    t: Turn,
    m: float,
    c: float,
    C: np.ndarray,
) -> None:
    """Subtract the effect of the plastic strain from the elastic tangent in C.

    Every vector here is a combination of n₀ and of the increment's e and is written as the pair of its two factors.
    """
    ne, ee = products
    rest, phi, y = 1.0 - beta, t.phi, t.y
    n, both = (phi, y * rest), (1.0 + phi, y * rest)
    pl = (m * (1.0 - phi), m * rest * (1.0 - y))
    # Derivatives of n:n − k² and of b*₀ + ½ (n₀ + n):p by n₀ and by e; from them those of b* and Λ.
    r1n, r2n = _pair(2.0 * phi, n, 0.0, n), _pair(0.5 * (1.0 + phi), pl, 0.5 * m * (1.0 - phi), both)
    r1e, r2e = _pair(2.0 * y, n, 0.0, n), _pair(0.5 * y, pl, 0.5 * m * (1.0 - y), both)
    bn, be = _pair(-local.r1l, r2n, -local.r2l, r1n), _pair(-local.r1l, r2e, -local.r2l, r1e)
    ln, le = _pair(local.r1b, r2n, local.r2b, r1n), _pair(local.r1b, r2e, local.r2b, r1e)
    # The elastic fraction β follows e, too: |n₀ + β e|² = k².
    gb, gl, gbeta = _pair(beta, bn, rest, be), _pair(beta, ln, rest, le), (0.0, 0.0)
    if beta > 0.0 and ne > 0.0:
        gbeta = (-beta / ne, 0.0)
        gb = _pair(1.0, gb, (bn[0] - be[0]) * ne + (bn[1] - be[1]) * ee, gbeta)
        gl = _pair(1.0, gl, (ln[0] - le[0]) * ne + (ln[1] - le[1]) * ee, gbeta)
    fb, fl = _pair(local.dzeta, pl, 1.0, (t.phi_b, t.y_b * rest)), (t.phi_l, t.y_l * rest)
    # dp = m [(1 − φ β − y (1 − β)) de − (φ − y) e dβ − fb db* − fl dΛ]
    scale = c * c * m
    identity = scale * (1.0 - phi * beta - y * rest)
    fbeta = (0.0, phi - y)
    left_n = -scale * fb[0], -scale * fl[0], -scale * fbeta[0]
    left_e = -scale * fb[1], -scale * fl[1], -scale * fbeta[1]
    for j in range(6):
        db = gb[0] * n0[j] + gb[1] * e[j]
        dl = gl[0] * n0[j] + gl[1] * e[j]
        dbeta = gbeta[0] * n0[j]
        along_n = left_n[0] * db + left_n[1] * dl + left_n[2] * dbeta
        along_e = left_e[0] * db + left_e[1] * dl + left_e[2] * dbeta
        for i in range(6):
            C[i, j] -= along_n * n0[i] + along_e * e[i]
    for i in range(3):
        C[i, i] -= identity
        C[3 + i, 3 + i] -= 0.5 * identity
        for j in range(3):
            C[i, j] += identity / 3.0
