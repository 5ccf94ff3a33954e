"""A closed estimate of the local problem's solution, from which one or two of Newton's steps lead to rounding.

With z = sΛ of group c and t = z/(2 + z), Padé's approximants φ ≈ (1 − z/2)/(1 + z/2) and ψ ≈ 1/(1 + z/2) make
n = φ n₀ + ψ x e linear in t,

    n = N − t M,   N = n₀ + x e,   M = 2 n₀ + x e,

exact where n keeps its direction and length. Group a has z r in the place of z, r = sₐ/s, and so r t + r (1 − r) t² in
the place of t, to second order. With ζ and κ as at the start of the increment, n:n and the work

    ½ (n₀ + n):p = ½ m (n₀:n₀ + n₀:e + n:e − n:n),   p = m (n₀ + e − n),   m = 1/(c + ζ),

are polynomials of second degree in t, and so is the difference of n:n and k² ≈ k₀² + k²′ (b* − b*₀). Its smaller root
is the estimate. The error of b* is of third order in the increment, that of φ of second, by ζ and κ.
"""

import math
from collections import namedtuple

from numba import njit

from coilset.model.base.kernel import INLINE
from coilset.model.material.point.local import Products, Start, axial_products, group

GREATEST = 0.95  # of t: z = 38

# b*, Λ, and whether the point loads plastically: the elastic response with the plastic x lies outside of the yield
# surface, and the linear path from there to the surface does work.
Estimate = namedtuple("Estimate", "b multiplier loads")
Polynomial = tuple[float, float, float]


@njit(**INLINE)
def estimate(start: Start, k2: float, dk2: float, zeta: float, kappa: float) -> Estimate:
    """b* and Λ at the end of the increment, by k², k²′, ζ and κ where it starts."""
    ga, gc = group(start.ca, zeta, 0.0, kappa, 0.0), group(start.cc, zeta, 0.0, kappa, 0.0)
    fa, wa = _polynomials(axial_products(start, start.b), ga.x, ga.s / gc.s, 0.5 / (start.ca + zeta))
    fc, wc = _polynomials((start.nn, start.ne, start.ee), gc.x, 1.0, 0.5 / (start.cc + zeta))
    w0, w1, w2 = wa[0] + wc[0], wa[1] + wc[1], wa[2] + wc[2]
    outside, fall = fa[0] + fc[0] - k2, fa[1] + fc[1]
    # A t² − 2 B t + C = 0
    A, B, C = fa[2] + fc[2] - dk2 * w2, 0.5 * (fall + dk2 * w1), outside - dk2 * w0
    square = B * B - A * C
    t = C / (B + math.sqrt(square if square > 0.0 else 0.0))
    t = t if t > 0.0 else 0.0
    t = t if t < GREATEST else GREATEST
    work = w0 + t * (w1 + t * w2)
    loads = (outside >= 0.0) & (fall > 0.0) & (w0 * fall + w1 * outside >= 0.0)
    return Estimate(start.b + (work if work > 0.0 else 0.0), 2.0 * t / ((1.0 - t) * gc.s), loads)


@njit(**INLINE)
def _polynomials(products: Products, x: float, r: float, half: float) -> tuple[Polynomial, Polynomial]:
    """f₀, f₁, f₂ of a group's n:n = f₀ − f₁ t + f₂ t², and w₀, w₁, w₂ of its work w₀ + w₁ t + w₂ t²; half: ½ m."""
    nn, ne, ee = products[0], x * products[1], x * x * products[2]  # n₀:n₀, n₀:xe, xe:xe
    NN, NM, MM = nn + 2.0 * ne + ee, 2.0 * nn + 3.0 * ne + ee, 4.0 * (nn + ne) + ee
    along, bend = 2.0 * products[1] + x * products[2], r * (1.0 - r)  # M:e
    f1, f2 = 2.0 * r * NM, r * r * MM - 2.0 * bend * NM
    return (NN, f1, f2), (half * (1.0 - x) * along, half * (f1 - r * along), -half * (f2 + bend * along))
