"""The constitutive law for the full stress state.

Order of components: 11, 22, 33, 12, 13, 23. Strain increments hold engineering shear strains, γ12 = 2ε12; stress and
back stress hold the tensor's components. A point's state is a row of σ (6), B (6), b* and, where each point has its
own, the temperature, in N/mm² and K; what stands behind stays.

The law is hypoelastic with the Zaremba-Jaumann rate (3.1.2): it holds in a frame that rotates with the material's spin.
The caller works in such a frame, or rotates the point's state by the increment's rotation first.
"""

from collections import namedtuple

import numpy as np

from coilset.model.material.point.local import Local, Start, yield_crossing
from coilset.model.material.point.local_rows import (
    BETA,
    ENDED,
    FLOWS,
    FORM,
    GROUP,
    K2,
    WORK,
    Points,
    gather,
    group_from,
    harden,
    keep_start,
    local_of,
    solve_rows,
    start_of,
)
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

Six = tuple[float, float, float, float, float, float]  # components 11, 22, 33, 12, 13, 23
Pair = tuple[float, float]
# Where the plastic part of an increment starts: elastic fraction β before it, n₀, e of the whole increment, the Start.
Beginning = namedtuple("Beginning", "beta n0 whole start")
# The elastic tangent less the consistent one: a multiple of the deviator, and of n₀ n₀, n₀ e, e n₀ and e e.
Loss = namedtuple("Loss", "identity nn ne en ee")

STATE = 13  # columns of a point's state
# Rows of the full stress state: stress, back stress and strain increment, which are given; n₀; the `Loss`.
STRESS, BACK, STRAIN = FORM, FORM + 6, FORM + 12
GIVEN = 18
NORMAL = FORM + GIVEN
LOSS = NORMAL + 6
ROWS = LOSS + 5


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
def begin(b: float, G: float, n0: Six, e: Six, k2: float) -> Beginning:
    """Where the plastic part starts: n₀ there (n0 + β e)."""
    ne, ee = inner(n0, e), inner(e, e)
    beta = yield_crossing(inner(n0, n0), ne, ee, k2)
    rest = 1.0 - beta
    n0 = combined(1.0, n0, beta, e)
    c, nn, ne = 2.0 * G, inner(n0, n0), inner(n0, e)
    return Beginning(beta, n0, e, Start(b, c, 0.0, 0.0, c, nn, rest * ne, rest * rest * ee))


@njit(**INLINE)
def plastic_strain(beginning: Beginning, local: Local) -> Six:
    """p at the end of the plastic part."""
    t, m, rest = local.c, 1.0 / (beginning.start.cc + local.zeta), 1.0 - beginning.beta
    return combined(m * (1.0 - t.phi), beginning.n0, m * rest * (1.0 - t.y), beginning.whole)


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


@njit(**KERNEL)
def return_map_points(
    p: np.ndarray, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray, count: np.ndarray
) -> bool:
    """One increment of the law for the full stress state at many points.

    Args:
        p: parameter array of the law.
        old: states at the start, shape (points, 13), or wider if each point has a temperature of its own; not written.
        de: strain increments, engineering shear strains, shape (points, 6).
        new: states at the end; written.
        C: dσ/dε, shape (points, 6, 6), N/mm²; written.
        count: local iterations of each point, 0 if it stayed elastic, -1 if there was no convergence (then the state is
            that at the start), shape (points,); written.

    Returns:
        Whether the law found a solution at all points.
    """
    good, first = True, 0
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.uint64)  # without sign, which numba would test
    new[:, STATE:] = old[:, STATE:]
    while first < old.shape[0]:
        of = group_from(p, old, first, STATE)
        _trial(p, of, old, de, w, new)
        first += of.size
        for k in range(of.first, first):
            hooke(of.E, of.G, C[k])
        flow, whole = gather(of.size, GIVEN, place, w)
        count[of.first : first] = 0
        if flow == 0:
            continue
        _begin(of.G, whole, w)
        solve_rows(p, of, 2.0 * of.G, flow, whole, w)
        _end(of.E, of.G, whole, w)
        for j in range(flow):
            k = of.first + int(place[j])
            count[k] = int(w[ENDED, j])
            if count[k] > 0:
                _write(of.G, w, j, new[k], C[k])
            else:
                good = False
                for i in range(6):
                    new[k, i] = old[k, i]
    return good


@njit(**INLINE)
def _six(w: np.ndarray, row: int, j: int) -> Six:
    return (w[row, j], w[row + 1, j], w[row + 2, j], w[row + 3, j], w[row + 4, j], w[row + 5, j])


@njit(**INLINE)
def _set(values: Six, w: np.ndarray, row: int, j: int) -> None:
    for i in range(6):
        w[row + i, j] = values[i]


@njit(**INLINE)
def _trial(p: np.ndarray, of: Points, old: np.ndarray, de: np.ndarray, w: np.ndarray, new: np.ndarray) -> None:
    """The elastic response of a group, written as if it were the state at the end, and which of its points flow."""
    first, size, E, G = of.first, of.size, of.E, of.G
    for k in range(size):
        for i in range(STATE - 1):
            w[STRESS + i, k] = old[first + k, i]
        w[WORK, k] = old[first + k, STATE - 1]
        for i in range(6):
            w[STRAIN + i, k] = de[first + k, i]
    harden(p, of, size, WORK, K2, w)
    for k in range(size):
        trial, B = elastic(_six(w, STRESS, k), _six(w, STRAIN, k), E, G), _six(w, BACK, k)
        n = active(trial, B)
        _set(trial, w, NORMAL, k)
        w[FLOWS, k] = 0.0 if inner(n, n) <= w[K2, k] * (1.0 + 1e-12) else 1.0
    for k in range(size):
        for i in range(6):
            new[first + k, i], new[first + k, 6 + i] = w[NORMAL + i, k], w[BACK + i, k]
        new[first + k, STATE - 1] = w[WORK, k]


@njit(**INLINE)
def _begin(G: float, size: int, w: np.ndarray) -> None:
    """Where the plastic part of the increment begins."""
    for j in range(size):
        n, e = active(_six(w, STRESS, j), _six(w, BACK, j)), elastic_deviator(_six(w, STRAIN, j), G)
        beginning = begin(w[WORK, j], G, n, e, w[K2, j])
        w[BETA, j] = beginning.beta
        _set(beginning.n0, w, NORMAL, j)
        keep_start(beginning.start, w, j)


@njit(**INLINE)
def _end(E: float, G: float, size: int, w: np.ndarray) -> None:
    """Replace the initial states by the final ones, and write what the tangent loses."""
    for j in range(size):
        local, strain = local_of(w, j), _six(w, STRAIN, j)
        start = start_of(2.0 * G, 2.0 * G, w, j)
        beginning = Beginning(w[BETA, j], _six(w, NORMAL, j), elastic_deviator(strain, G), start)
        pl = plastic_strain(beginning, local)
        taken = loss(beginning, local)
        trial = elastic(_six(w, STRESS, j), strain, E, G)
        _set(combined(1.0, trial, -2.0 * G, pl), w, STRESS, j)
        _set(combined(1.0, _six(w, BACK, j), local.zeta, pl), w, BACK, j)  # (3.1.8)
        w[WORK, j] = local.b
        w[LOSS, j], w[LOSS + 1, j], w[LOSS + 2, j], w[LOSS + 3, j] = taken.identity, taken.nn, taken.ne, taken.en
        w[LOSS + 4, j] = taken.ee


@njit(**INLINE)
def _write(G: float, w: np.ndarray, j: int, new: np.ndarray, C: np.ndarray) -> None:
    """Write the state of a point that flows, and take off its tangent what it loses."""
    for i in range(STATE - 1):
        new[i] = w[STRESS + i, j]
    new[STATE - 1] = w[WORK, j]
    taken = Loss(w[LOSS, j], w[LOSS + 1, j], w[LOSS + 2, j], w[LOSS + 3, j], w[LOSS + 4, j])
    soften(taken, _six(w, NORMAL, j), elastic_deviator(_six(w, STRAIN, j), G), C)
