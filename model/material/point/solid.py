"""The constitutive law for the full stress state.

Order of components: 11, 22, 33, 12, 13, 23. Strain increments hold engineering shear strains, γ12 = 2ε12; stress and
back stress hold the tensor's components. A point's state is a row of σ (6), B (6), b* and, where each point has its
own, the temperature, in N/mm² and K; what stands behind stays.

The law is hypoelastic with the Zaremba-Jaumann rate (3.1.2): it holds in a frame that rotates with the material's spin.
The caller works in such a frame, or rotates the point's state by the increment's rotation first.
"""

from collections import namedtuple

import numpy as np

from coilset.model.material.law.functions import TEMPERATURE, elasticity, functions
from coilset.model.material.point.local import Local, Start, solve, yield_crossing
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

Six = tuple[float, float, float, float, float, float]  # components 11, 22, 33, 12, 13, 23
Pair = tuple[float, float]
# Where the plastic part of an increment starts: elastic fraction β before it, n₀, e of the whole increment, the Start.
Beginning = namedtuple("Beginning", "beta n0 whole start")
# The elastic tangent less the consistent one: a multiple of the deviator, and of n₀ n₀, n₀ e, e n₀ and e e.
Loss = namedtuple("Loss", "identity nn ne en ee")


@njit(**INLINE)
def inner(a: Six, b: Six) -> float:
    """a:b of two symmetric tensors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])


@njit(**INLINE)
def elastic_deviator(dD: Six, G: float) -> Six:
    """2G times the deviator of a strain increment."""
    g = 2.0 * G
    mean = (dD[0] + dD[1] + dD[2]) / 3.0
    return (g * (dD[0] - mean), g * (dD[1] - mean), g * (dD[2] - mean), G * dD[3], G * dD[4], G * dD[5])


@njit(**INLINE)
def active(s: Six, b: Six) -> Six:
    """n = T − B of a stress and a back stress."""
    mean = (s[0] + s[1] + s[2]) / 3.0
    return (s[0] - mean - b[0], s[1] - mean - b[1], s[2] - mean - b[2], s[3] - b[3], s[4] - b[4], s[5] - b[5])


@njit(**INLINE)
def combined(f: float, a: Six, g: float, b: Six) -> Six:
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
def six(row: np.ndarray, first: int) -> Six:
    """Six entries of a row."""
    return (row[first], row[first + 1], row[first + 2], row[first + 3], row[first + 4], row[first + 5])


@njit(**INLINE)
def bulk_modulus(E: float, G: float) -> float:
    """K of E and G."""
    return E * G / (3.0 * (3.0 * G - E))


@njit(**INLINE)
def hooke(E: float, G: float, C: np.ndarray) -> None:
    """Write the elastic tangent."""
    bulk = bulk_modulus(E, G)
    for i in range(6):
        for j in range(6):
            C[i, j] = 0.0
    for i in range(3):
        for j in range(3):
            C[i, j] = bulk - 2.0 * G / 3.0
        C[i, i] += 2.0 * G
        C[3 + i, 3 + i] = G


@njit(**INLINE)
def elastic(s: Six, dD: Six, E: float, G: float) -> Six:
    """The stress after an elastic increment."""
    volume, e = bulk_modulus(E, G) * (dD[0] + dD[1] + dD[2]), elastic_deviator(dD, G)
    return (s[0] + e[0] + volume, s[1] + e[1] + volume, s[2] + e[2] + volume, s[3] + e[3], s[4] + e[4], s[5] + e[5])


@njit(**INLINE)
def begin(b: float, temperature: float, G: float, n0: Six, e: Six, k2: float) -> Beginning:
    """Where the plastic part starts: n₀ there (n0 + β e)."""
    ne, ee = inner(n0, e), inner(e, e)
    beta = yield_crossing(inner(n0, n0), ne, ee, k2)
    rest = 1.0 - beta
    n0 = combined(1.0, n0, beta, e)
    c, nn, ne = 2.0 * G, inner(n0, n0), inner(n0, e)
    return Beginning(beta, n0, e, Start(b, temperature, c, 0.0, 0.0, c, nn, rest * ne, rest * rest * ee))


@njit(**INLINE)
def plastic_strain(beginning: Beginning, local: Local) -> Six:
    """p at the end of the plastic part."""
    t, m, rest = local.c, 1.0 / (beginning.start.cc + local.zeta), 1.0 - beginning.beta
    return combined(m * (1.0 - t.phi), beginning.n0, m * rest * (1.0 - t.y), beginning.whole)


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
    hooke(E, G, C)
    for i in range(old.shape[0]):
        new[i] = old[i]
    s, B = six(old, 0), six(old, 6)
    trial = elastic(s, six(dD, 0), E, G)
    n = active(trial, B)
    values = functions(p, old[12], temperature)
    count = 0
    if not inner(n, n) <= values[0] * (1.0 + 1e-12):
        beginning = begin(old[12], temperature, G, active(s, B), elastic_deviator(six(dD, 0), G), values[0])
        local = solve(p, beginning.start, values)
        if local.iterations < 0:
            return local.iterations
        count, pl = local.iterations, plastic_strain(beginning, local)
        trial = combined(1.0, trial, -2.0 * G, pl)
        B = combined(1.0, B, local.zeta, pl)  # (3.1.8)
        new[12] = local.b
        soften(loss(beginning, local), beginning.n0, beginning.whole, C)
    for i in range(6):
        new[i], new[6 + i] = trial[i], B[i]
    return count


@njit(**INLINE)
def _pair(f: float, a: Pair, g: float, b: Pair) -> Pair:
    return (f * a[0] + g * b[0], f * a[1] + g * b[1])


@njit(**INLINE)
def loss(beginning: Beginning, local: Local) -> Loss:
    """What the plastic strain takes from the elastic tangent.

    Every vector here is a combination of n₀ and of the increment's e and is written as the pair of its two factors.
    """
    n0, e, beta, c, t = beginning.n0, beginning.whole, beginning.beta, beginning.start.cc, local.c
    ne, ee, m = inner(n0, e), inner(e, e), 1.0 / (c + local.zeta)
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
    left_n = -scale * fb[0], -scale * fl[0]
    left_e = -scale * fb[1], -scale * fl[1], -scale * (phi - y)
    nn, ne = left_n[0] * gb[0] + left_n[1] * gl[0], left_n[0] * gb[1] + left_n[1] * gl[1]
    en = left_e[0] * gb[0] + left_e[1] * gl[0] + left_e[2] * gbeta[0]
    return Loss(identity, nn, ne, en, left_e[0] * gb[1] + left_e[1] * gl[1])


@njit(**INLINE)
def soften(loss: Loss, n0: Six, e: Six, C: np.ndarray) -> None:
    """Subtract the effect of the plastic strain from the elastic tangent in C."""
    along_n, along_e = combined(loss.nn, n0, loss.ne, e), combined(loss.en, n0, loss.ee, e)
    for i in range(6):
        for j in range(6):
            C[i, j] -= n0[i] * along_n[j] + e[i] * along_e[j]
    for i in range(3):
        C[i, i] -= loss.identity
        C[3 + i, 3 + i] -= 0.5 * loss.identity
        for j in range(3):
            C[i, j] += loss.identity / 3.0
