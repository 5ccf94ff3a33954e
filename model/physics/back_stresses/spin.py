"""The material's spin relative to the rod's section (5.2.33), as a rotation that depends on the state, not on the path.

The spin w1j = −½ γ̇1j changes the three stresses by

    σ̇11 = −γ̇12 τ12 − γ̇13 τ13,   τ̇1j = ½ γ̇1j σ11.

With Hooke's law τ̇1j = G γ̇1j beside it, a point that is stretched by ε and then sheared by γ = (γ12, γ13) has exactly

    σ11 = (2G + Eε) cos θ − 2G,   τ1j = (G + ½Eε) γ1j sin θ/θ,   θ = |γ|/√2:

(σ11/√2 + √2 G, τ12, τ13) is a vector of length √2 (G + ½Eε), rotated by θ. The rates themselves are not the
derivative of a stress: for a point that is sheared first they omit τ̇1j = (E/2G) τ1j ε̇11, and a closed strain path
leaves a shear stress of ½ E ε γ. The missing term is the shear (1 + ν) γ ε̇ by which a sheared fibre rotates as it is
stretched
and becomes thinner. Here the stress is this function of the elastic strain on all elastic paths: an increment adds to
the ε and γ that correspond to the stress at its start. A closed elastic path therefore leaves no stress; each of its
increments has the rates of (5.2.33) and this term, to the order θ².

Plastic flow follows (5.2.33) unchanged: in the part β … 1 of an increment, beyond the yield surface, the stress
(σ11/√2, τ12, τ13) is rotated by the shear of that part, by the angle (1 − β)|Δγ|/√2. β is where the elastic path meets
the surface. The back stress, (√3/2 B11, B12, B13), rotates by √3/2 |Δγ|, with the elastic γ before and after it.
"""

import math
from collections import namedtuple

from coilset.model.core.material.point.groups import Vector, active, add, inner, scaled
from coilset.model.core.material.point.local import yield_crossing
from coilset.model.core.runtime.kernels import INLINE, njit

Columns = tuple[Vector, Vector, Vector]
# sin θ/θ, (1 − cos θ)/θ², and twice their derivatives with respect to θ².
Ratios = namedtuple("Ratios", "S K dS dK")
# Stress and back stress from which Hooke's law leads to the end of an increment without plastic flow, and the columns
# of their derivatives with respect to ε11, γ12, γ13.
Spun = namedtuple("Spun", "stress back d_stress d_back")
# The part β of an increment up to the yield surface, and its derivatives.
Crossing = namedtuple("Crossing", "beta d_beta")
WHOLE = Crossing(1.0, (0.0, 0.0, 0.0))
STRESS, BACK = 0.5, 0.75  # c² of a turn, see _turn
SMALL = 1e-2  # θ² below which the series are exact to rounding


@njit(**INLINE)
def crossing_of_spin(s: Vector, B: Vector, k2: float, E: float, G: float, e: Vector) -> Crossing:
    """Where the elastic path leaves the yield surface; e is the increment of the active deviator."""
    n = active(s, B)
    nn, ne, ee = inner(n, n), inner(n, e), inner(e, e)
    if nn + 2.0 * ne + ee <= k2 * (1.0 + 1e-12):
        return WHOLE
    beta = yield_crossing(nn, ne, ee, k2)
    at = add(n, scaled(e, beta))
    slope = inner(at, e)
    if beta <= 0.0 or beta >= 1.0 or slope <= 0.0:
        return Crossing(beta, (0.0, 0.0, 0.0))
    f = -beta / slope
    return Crossing(beta, (f * E * at[0], 2.0 * f * G * at[1], 2.0 * f * G * at[2]))


@njit(**INLINE)
def _ratios(t: float) -> Ratios:
    """Ratios at θ² = t."""
    if t < SMALL:
        S = 1.0 - t / 6.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0 * (1.0 - t / 72.0)))
        K = 0.5 * (1.0 - t / 12.0 * (1.0 - t / 30.0 * (1.0 - t / 56.0 * (1.0 - t / 90.0))))
        dS = -1.0 / 3.0 * (1.0 - t / 10.0 * (1.0 - t / 28.0 * (1.0 - t / 54.0)))
        dK = -1.0 / 12.0 * (1.0 - t / 15.0 * (1.0 - t / 112.0 * 3.0 * (1.0 - t / 67.5)))
        return Ratios(S, K, dS, dK)
    angle = math.sqrt(t)
    S, cosine = math.sin(angle) / angle, math.cos(angle)
    K = (1.0 - cosine) / t
    return Ratios(S, K, (cosine - S) / t, (S - 2.0 * K) / t)


@njit(**INLINE)
def _elastic_shear(s: Vector, G: float) -> tuple[float, float, float]:
    """E ε and γ12, γ13 of the elastic strain that corresponds to the stress `s`."""
    length = math.sqrt((G + 0.5 * s[0]) ** 2 + 0.5 * (s[1] * s[1] + s[2] * s[2]))
    angle = math.atan2(math.sqrt(0.5 * (s[1] * s[1] + s[2] * s[2])), G + 0.5 * s[0])
    factor = 1.0 / (length * _ratios(angle * angle).S)
    return 2.0 * (length - G), factor * s[1], factor * s[2]


@njit(**INLINE)
def _elastic_stress(Ee: float, g2: float, g3: float, E: float, G: float) -> tuple[Vector, Columns]:
    """Stress of the elastic strain, given as E ε and γ, and its derivatives by columns."""
    t = 0.5 * (g2 * g2 + g3 * g3)
    r, a = _ratios(t), G + 0.5 * Ee
    s = (Ee - 2.0 * a * t * r.K, a * r.S * g2, a * r.S * g3)
    return s, (
        (E * (1.0 - t * r.K), 0.5 * E * r.S * g2, 0.5 * E * r.S * g3),
        (-s[1], a * (r.S + 0.5 * r.dS * g2 * g2), 0.5 * a * r.dS * g2 * g3),
        (-s[2], 0.5 * a * r.dS * g2 * g3, a * (r.S + 0.5 * r.dS * g3 * g3)),
    )


@njit(**INLINE)
def _turn(v: Vector, g2: float, g3: float, c2: float) -> Vector:
    """(c v11, v12, v13) after a turn by the angle c|g|, as v."""
    t, u = c2 * (g2 * g2 + g3 * g3), g2 * v[1] + g3 * v[2]
    r = _ratios(t)
    along = c2 * (r.S * v[0] - r.K * u)
    return (v[0] * (1.0 - t * r.K) - r.S * u, v[1] + along * g2, v[2] + along * g3)


@njit(**INLINE)
def _turn_rates(v: Vector, g: tuple[float, float], k: int, c2: float) -> Vector:
    """Derivative of `_turn` with respect to g_k."""
    r, u = _ratios(c2 * (g[0] * g[0] + g[1] * g[1])), g[0] * v[1] + g[1] * v[2]
    along = c2 * (r.S * v[0] - r.K * u)
    grows = c2 * (c2 * g[k] * (r.dS * v[0] - r.dK * u) - r.K * v[1 + k])
    first = -c2 * g[k] * (r.S * v[0] + r.dS * u) - r.S * v[1 + k]
    return (first, grows * g[0] + (along if k == 0 else 0.0), grows * g[1] + (along if k == 1 else 0.0))


@njit(**INLINE)
def spun(s: Vector, B: Vector, E: float, G: float, de11: float, dg12: float, dg13: float, crossing: Crossing) -> Spun:
    """Effect of an increment's spin on the stress and back stress at its start.

    Args:
        s, B: stress and back stress at the start.
        E, G: moduli, N/mm².
        de11, dg12, dg13: increments of ε11, γ12, γ13.
        crossing: the part of the increment that is elastic.
    """
    beta, d_beta = crossing.beta, crossing.d_beta
    Ee, g2, g3 = _elastic_shear(s, G)
    home = _turn(B, -g2, -g3, BACK)
    end = (g2 + dg12, g3 + dg13)
    elastic, d = _elastic_stress(Ee + beta * E * de11, g2 + beta * dg12, g3 + beta * dg13, E, G)
    g = ((1.0 - beta) * dg12, (1.0 - beta) * dg13)
    start = _turn(elastic, g[0], g[1], STRESS)
    start = (start[0] - beta * E * de11, start[1] - beta * G * dg12, start[2] - beta * G * dg13)
    by_2, by_3 = _turn_rates(elastic, g, 0, STRESS), _turn_rates(elastic, g, 1, STRESS)
    col_1, col_2, col_3 = _turn(d[0], *g, STRESS), _turn(d[1], *g, STRESS), _turn(d[2], *g, STRESS)
    col_1 = (col_1[0] - E, col_1[1], col_1[2])
    col_2 = (col_2[0], col_2[1] - G, col_2[2])
    col_3 = (col_3[0], col_3[1], col_3[2] - G)
    # by β itself
    move = _sum(col_1, col_2, col_3, (de11, dg12, dg13))
    turn = _sum(move, by_2, by_3, (1.0, -dg12, -dg13))
    rest = 1.0 - beta
    d_stress = (
        _sum(col_1, turn, turn, (beta, d_beta[0], 0.0)),
        _sum(col_2, turn, by_2, (beta, d_beta[1], rest)),
        _sum(col_3, turn, by_3, (beta, d_beta[2], rest)),
    )
    d_back = ((0.0, 0.0, 0.0), _turn_rates(home, end, 0, BACK), _turn_rates(home, end, 1, BACK))
    return Spun(start, _turn(home, end[0], end[1], BACK), d_stress, d_back)


@njit(**INLINE)
def _sum(a: Vector, b: Vector, c: Vector, factors: Vector) -> Vector:
    f, g, h = factors
    return (f * a[0] + g * b[0] + h * c[0], f * a[1] + g * b[1] + h * c[1], f * a[2] + g * b[2] + h * c[2])
