"""The exponential return map of k², ζ and κ at many points: what follows from the two equations of each (`local`).

The fast path of the law is four files: `local`, the two equations of a point; `local_rows`, which solves them at many
points; `groups`, what is common to all laws of many points; this one.
"""

import numpy as np

from coilset.model.core.material.law.functions import HELD
from coilset.model.core.material.point.groups import (
    BACK,
    DIAGONAL,
    LARGEST,
    LEFT,
    NORMAL,
    OTHERS,
    RIGHT,
    STRAIN,
    STRESS,
    Components,
    is_axial,
    keep,
    modulus,
    of_stress,
    products,
    respond,
    weight,
)
from coilset.model.core.material.point.local import Start, Turn, yield_crossing
from coilset.model.core.material.point.local_rows import (
    BETA,
    GROUP,
    JACOBIAN,
    K2,
    LAST_ZETA,
    TURN_A,
    TURN_C,
    WORK,
    ZETA,
    B,
    Points,
    group_from,
    keep_start,
    solve_rows,
    turn_of,
)
from coilset.model.core.runtime.kernels import INLINE, PASTED, njit

# By which β follows n₀ and e: 1/n₀:e, 0 if it does not.
SLOPE, ALONG_B, ALONG_L = range(OTHERS, OTHERS + 3)
P = LEFT + 2 * LARGEST  # plastic strain, before the dyads' last left vector
ROWS = ALONG_L + 1


@njit(**PASTED)
def flow_points(
    p: np.ndarray,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """One increment of the law at many points, as `law.loop.flow_points`.

    Args:
        p: parameter array of the law.
        components: ROD or SOLID.
        old: states at the start, as in `groups`, shape (points, 7 or 13, or more); not written.
        de: strain increments, shape (3 or 6, points).
        new: states at the end; written.
        tangent: dσ/dε by rows, shape (9 or 36, points), N/mm²; written if `with_tangent`.
        count: local iterations of each point, 0 if it stayed elastic, -1 if there was no convergence (then the state is
            that at the start), shape (points,); written.

    Returns:
        Whether the law found a solution at all points.
    """
    good, first = True, 0
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.uint64)  # without sign, which numba would test
    while first < old.shape[0]:
        of = group_from(p, old, first, 2 * len(components) + 1)
        flow, whole = respond(p, of, components, old, de, new, tangent, with_tangent, place, w)
        first += of.size
        count[of.first : first] = 0
        if flow == 0:
            continue
        _begin(p, of, components, whole, w)
        solve_rows(p, of, modulus(of, len(components), 0), flow, whole, w)
        _end(of, components, whole, w)
        if with_tangent:
            _tangent(of, components, whole, w)
        if not keep(of, components, 1, flow, with_tangent, place, w, new, tangent, count):
            good = False
            for k in range(of.first, first):
                if count[k] < 0:
                    for j in range(new.shape[1]):
                        new[k, j] = old[k, j]
    return good


@njit(**INLINE)
def _begin(p: np.ndarray, of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Where the plastic part of the increment begins: β and n₀ there (n₀ + β e), and the Start."""
    n, ca, cc, moves = len(components), modulus(of, len(components), 0), 2.0 * of.G, p[HELD] == 0.0
    for k in range(size):
        na, ea, nn, ne, ee = products(components, w, k)
        along, square = 1.5 * na * ea + ne, 1.5 * ea * ea + ee
        beta = yield_crossing(1.5 * na * na + nn, along, square, w[K2, k])
        rest, steep = 1.0 - beta, along + beta * square
        w[BETA, k], w[SLOPE, k] = beta, 1.0 / steep if moves & (beta > 0.0) & (steep > 0.0) else 0.0
        nn, ne = nn + beta * (2.0 * ne + beta * ee), ne + beta * ee
        keep_start(Start(w[WORK, k], ca, na + beta * ea, rest * ea, cc, nn, rest * ne, rest * rest * ee), w, k)
        for j in range(n):
            w[NORMAL + j, k] += beta * w[STRAIN + j, k]


@njit(**INLINE)
def _end(of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Replace the initial state by the final one."""
    n = len(components)
    for k in range(size):
        beta, zeta = w[BETA, k], w[LAST_ZETA, k]
        for j in range(n):
            t, c, n0, whole = _turn(n, j, w, k), modulus(of, n, j), w[NORMAL + j, k], w[STRAIN + j, k]
            e = (1.0 - beta) * whole
            strain = 1.0 / (c + zeta) * (n0 + e - t.phi * n0 - t.y * e)
            w[P + j, k] = strain
            w[STRESS + j, k] += whole - c * strain
            w[BACK + j, k] += zeta * strain  # (3.1.8)
        w[WORK, k] = w[B, k]


@njit(**INLINE)
def _turn(n: int, j: int, w: np.ndarray, k: int) -> Turn:
    """How a component of n turns."""
    return turn_of(w, TURN_A if is_axial(n, j) else TURN_C, k)


@njit(**INLINE)
def _tangent(of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Write the diagonal and the dyads of the tangent.

    With a change v of e, n₀ at the crossing of the yield surface changes by dn = β (v − σ (n₀:v) e), e of the whole
    increment and σ = 1/n₀:e. The two local equations stay true, and with d = φ − y the plastic strain follows by

        dp = m [(1 − y) v − d dn − (∂n/∂b* + p ∂ζ/∂b*) db* − ∂n/∂Λ dΛ],   db* = b:v + b′:dn,   dΛ = l:v + l′:dn,

    m = 1/(c + ζ), which is a diagonal and three dyads, by n₀, b* and Λ. Under neutral loading κ is in the place of Λ.
    """
    n = len(components)
    for k in range(size):
        beta, r1b, r1l = w[BETA, k], w[JACOBIAN, k], w[JACOBIAN + 1, k]
        r2b, r2l = w[JACOBIAN + 2, k], w[JACOBIAN + 3, k]
        along_b = along_l = 0.0
        for j in range(n):
            t, n0, whole, strain = _turn(n, j, w, k), w[NORMAL + j, k], w[STRAIN + j, k], w[P + j, k]
            normal, d = t.phi * n0 + t.y * (1.0 - beta) * whole, t.phi - t.y
            both = 1.0 / (modulus(of, n, j) + w[LAST_ZETA, k]) * (n0 + normal)
            q = strain - both
            # n:n and ½ (n₀ + n):p by v and by dn
            square, square_0 = 2.0 * t.y * normal, 2.0 * d * normal
            work, work_0 = 0.5 * (both + t.y * q), 0.5 * (strain + d * q)
            b_0, l_0 = -r2l * square_0 - r1l * work_0, r2b * square_0 + r1b * work_0
            along_b += weight(n, j) * b_0 * whole
            along_l += weight(n, j) * l_0 * whole
            w[RIGHT + LARGEST + j, k] = beta * b_0 - r2l * square - r1l * work
            w[RIGHT + 2 * LARGEST + j, k] = beta * l_0 + r2b * square + r1b * work
        turn = beta * w[SLOPE, k]
        w[ALONG_B, k], w[ALONG_L, k] = turn * along_b, turn * along_l
    for k in range(size):
        for j in range(n):
            scale, n0 = modulus(of, n, j) * of_stress(n, j), w[NORMAL + j, k]
            w[RIGHT + LARGEST + j, k] = scale * (w[RIGHT + LARGEST + j, k] - w[ALONG_B, k] * n0)
            w[RIGHT + 2 * LARGEST + j, k] = scale * (w[RIGHT + 2 * LARGEST + j, k] - w[ALONG_L, k] * n0)
    for k in range(size):
        beta, dzeta = w[BETA, k], w[ZETA + 1, k]
        for j in range(n):
            t, c, n0, whole = _turn(n, j, w, k), modulus(of, n, j), w[NORMAL + j, k], w[STRAIN + j, k]
            scale, e, d = c * of_stress(n, j), (1.0 - beta) * whole, t.phi - t.y
            m = 1.0 / (c + w[LAST_ZETA, k]) * scale
            w[LEFT + j, k] = -m * beta * w[SLOPE, k] * d * whole
            w[LEFT + LARGEST + j, k] = m * (t.phi_b * n0 + t.y_b * e + dzeta * w[P + j, k])
            w[LEFT + 2 * LARGEST + j, k] = m * (t.phi_l * n0 + t.y_l * e)
            w[DIAGONAL + j, k] = scale - c * m * (1.0 - t.y - beta * d)
            w[RIGHT + j, k] = scale * n0
