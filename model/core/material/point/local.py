"""The local problem of the implicit return mapping, common to the rod and to the three-dimensional law.

The rate equations of chapter 3 are integrated exactly as far as they are linear. With e the elastic increment of the
active deviator over the plastic part of the increment (e = c Δε′; c = 2G, but ⅔E for the rod's axial component), n₀ its
value when that part starts, p the plastic strain increment and n = T − B at the end,

    (1 + κζ) ḋ = λ n + κ Ṫ,   Ṫ = ė − c ḋ,   Ḃ = ζ ḋ          (3.1.6, 3.1.8)

give ṅ = x ė − s λ n with h = 1 + κ(ζ + c), x = 1/h, s = (c + ζ)/h. With ζ and κ at half of the increment's plastic work
and λ constant, Λ = λΔt, the solution is

    n = φ n₀ + ψ x e,   φ = exp(−sΛ),   ψ = (1 − φ)/(sΛ),   p = (n₀ + e − n) / (c + ζ).

The error is of second order in the increment. However long the increment is, n turns towards the direction of e and
does not overshoot. Backward Euler has φ = ψ = 1/(1 + sΛ) instead, with an error of first order, visible where the
strain path changes direction.

Two scalars remain, the plastic work b* and Λ, with two equations:

    n:n = k²(b*)    (3.1.4)         b* = b*₀ + ½ (n₀ + n):p        (3.1.7)

The classic radial return with a yield stress linear in the plastic strain is a special case, exact to rounding.

Newton's method for both is safeguarded in two ways. For a given b* the root Λ of the first comes from a Newton
iteration for 1/|n|, which is nearly linear in Λ; and b* stays in a bracket, which is halved where Newton's method would
leave it: k² is steep at b* = 0, so that Newton's method alone overshoots there, and the slope of k² jumps at b1*.

Neutral loading. The κ term sets in abruptly on loading. In the rod, where x differs between the axial and the shear
components, there is a narrow cone of strain increments, nearly tangential to the yield surface, for which the elastic
response leaves the surface although the plastic one with λ ≥ 0 moves inside: neither is admissible. In the limit of
ever smaller steps that alternate between the two, the state stays on the surface with λ = 0 and a smaller κ; `_neutral`
finds this κ. The plastic work is then of second order, so ζ is kept.

Points several at a time (`local_rows`) start from a closed estimate of the solution, from which one or two of Newton's
steps lead to rounding. With z = sΛ of group c and t = z/(2 + z), Padé's approximants φ ≈ (1 − z/2)/(1 + z/2) and ψ ≈
1/(1 + z/2) make n = φ n₀ + ψ x e linear in t,

    n = N − t M,   N = n₀ + x e,   M = 2 n₀ + x e,

exact where n keeps its direction and length. Group a has z r in the place of z, r = sₐ/s, and so r t + r (1 − r) t² in
the place of t, to second order. With ζ and κ as at the start of the increment, n:n and the work are polynomials of
second degree in t, and so is the difference of n:n and k² ≈ k₀² + k²′ (b* − b*₀). Its smaller root is the estimate. The
error of b* is of third order in the increment, that of φ of second, by ζ and κ.

A point has two groups of components: `a`, a single one with modulus `ca` (the rod's axial one), and `c`, any number
with modulus `cc`, of which only the inner products enter.
"""

import math
from collections import namedtuple

import numpy as np

from coilset.model.core.material.law.exponential import decay
from coilset.model.core.material.law.functions import HELD, Functions, functions
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit

MAX_ITERATIONS = 60
FAILED, TOO_HOT = -1, -2  # instead of a number of iterations; TOO_HOT: heated out of the material's table
FINE = 1e-6  # relative residual below which one more Newton step ends the iteration
COARSE = 1e-3  # relative error of |n| to which Λ is brought before the two equations are solved together

GREATEST = 0.95  # of t in the estimate: z = 38

Products = tuple[float, float, float]
Polynomial = tuple[float, float, float]
# An estimate: b*, Λ, and whether the point loads plastically: the elastic response with the plastic x lies outside of
# the yield surface, and the linear path from there to the surface does work.
Estimate = namedtuple("Estimate", "b multiplier loads")
# What the increment starts from. na, ea: n₀ and e of group a, with the metric's weight 3/2 to be applied; nn, ne, ee:
# inner products of n₀ and e of group c.
Start = namedtuple("Start", "b ca na ea cc nn ne ee")
# s, x of a group and their derivatives with respect to b*.
Group = namedtuple("Group", "s ds x dx")
# n = φ n₀ + y e in a group, y = ψ x, and the derivatives of φ and y with respect to b* and Λ (κ if neutral).
Turn = namedtuple("Turn", "phi y phi_b y_b phi_l y_l")
# The residuals of the two equations (see Local), their Jacobian in (b*, Λ), and the work ½ (n₀ + n):p.
Equations = namedtuple("Equations", "r1 r2 r1b r1l r2b r2l work")
# Newton's correction of b* and Λ, one over the Jacobian's determinant, and r2 where r1 is made zero by Λ alone.
Correction = namedtuple("Correction", "b multiplier inverse g")
# The solution: b*, ζ at half of the increment's plastic work, dζ/db* of its end, the Turns of both groups, and the
# Jacobian of the two equations (r1: n:n − k², r2: b* − b*₀ − ½ (n₀ + n):p) in (b*, Λ), or in (b*, κ) if neutral,
# divided by its determinant.
Local = namedtuple("Local", "iterations b zeta dzeta a c r1b r1l r2b r2l")


@njit(**INLINE)
def yield_crossing(nn: float, ne: float, ee: float, k2: float) -> float:
    """Elastic fraction of an increment that starts inside or on the yield surface and ends outside: |n₀ + β e|² = k².

    The κ term of (3.1.6) belongs to plastic loading only, so it must not see the elastic part.
    """
    root = ne * ne + ee * (k2 - nn)
    none = (root <= 0.0) | ((nn >= k2) & (ne >= 0.0))
    root = math.sqrt(root if root > 0.0 else 0.0)
    beta = (k2 - nn if ne > 0.0 else root - ne) / (ne + root if ne > 0.0 else ee)
    return 0.0 if none else min(max(beta, 0.0), 1.0)


@njit(**INLINE)
def group(c: float, zeta: float, dzeta: float, kappa: float, dkappa: float) -> Group:
    """s and x of a group with the modulus c; ζ and κ with their slopes in b*."""
    x = 1.0 / (1.0 + kappa * (zeta + c))
    dx = -x * x * (dkappa * (zeta + c) + kappa * dzeta)
    return Group((c + zeta) * x, dzeta * x + (c + zeta) * dx, x, dx)


@njit(**INLINE)
def turn(g: Group, multiplier: float) -> Turn:
    """A group's n from n₀ and e at Λ = `multiplier`."""
    phi, psi, slope = decay(g.s * multiplier)
    phi_b, y_b = -phi * g.ds * multiplier, slope * g.ds * multiplier * g.x + psi * g.dx
    return Turn(phi, psi * g.x, phi_b, y_b, -phi * g.s, slope * g.s * g.x)


@njit(**INLINE)
def rough_turn(g: Group, multiplier: float) -> Turn:
    """`turn` with 1/φ = exp(z) as its series up to z⁴/24, and without the derivatives in b*."""
    z = g.s * multiplier
    r = 1.0 + z * (1 / 3) * (1.0 + z * (1 / 4))
    q = 1.0 + 0.5 * z * r
    phi = 1.0 / (1.0 + z * q)
    return Turn(phi, phi * q * g.x, 0.0, 0.0, -phi * g.s, -0.5 * phi * r * g.s * g.x)


@njit(**INLINE)
def _square(t: Turn, nn: float, ne: float, ee: float) -> tuple[float, float]:
    """A group's n:n, and its derivative in Λ."""
    left, right = t.phi * nn + t.y * ne, t.phi * ne + t.y * ee  # n:n₀, n:e
    return t.phi * left + t.y * right, 2.0 * (left * t.phi_l + right * t.y_l)


@njit(**INLINE)
def _multiplier(ga: Group, gc: Group, a: Products, c: Products, k2: float, start: float, precision: float) -> float:
    """Root Λ of n:n = k² at given s, x of both groups; a, c: their inner products n₀:n₀, n₀:e, e:e."""
    multiplier = max(start, -1.0 / max(ga.s, gc.s))
    for _ in range(MAX_ITERATIONS):
        y, closer = nearer(ga, gc, turn(ga, multiplier), turn(gc, multiplier), a, c, k2, multiplier)
        if abs(y - k2) < 2.0 * precision * k2:
            break
        multiplier = closer
    return multiplier


@njit(**INLINE)
def nearer(
    ga: Group, gc: Group, ta: Turn, tc: Turn, a: Products, c: Products, k2: float, multiplier: float
) -> tuple[float, float]:
    """n:n of both groups' turns at Λ = `multiplier`, and a Λ nearer to the root of n:n = k²."""
    ya, la = _square(ta, *a)
    yc, lc = _square(tc, *c)
    y, slope = ya + yc, la + lc
    unit = 1.0 / max(ga.s, gc.s)
    step = -2.0 * y * (math.sqrt(y / k2) - 1.0) / slope if slope < 0.0 else unit  # Newton for 1/|n| = 1/k
    return y, max(multiplier + step, 0.5 * (multiplier - unit))


@njit(**INLINE)
def _group_terms(t: Turn, c: float, zeta: float, dzeta: float, products: Products) -> Functions:
    """A group's n:n and ½ (n₀ + n):p, each with its derivatives in b* and Λ; `products` are n₀:n₀, n₀:e, e:e."""
    nn, ne, ee = products
    phi, y, m = t.phi, t.y, 1.0 / (c + zeta)
    left, right = phi * nn + y * ne, phi * ne + y * ee  # n:n₀, n:e
    square = phi * left + y * right
    square_b, square_l = 2.0 * (left * t.phi_b + right * t.y_b), 2.0 * (left * t.phi_l + right * t.y_l)
    half = 0.5 * m
    work = half * (nn + ne + right - square)  # (n₀ + n):(n₀ + e − n)
    work_b = half * (t.phi_b * ne + t.y_b * ee - square_b) - work * dzeta * m
    work_l = half * (t.phi_l * ne + t.y_l * ee - square_l)
    return square, square_b, square_l, work, work_b, work_l


@njit(**INLINE)
def axial_products(start: Start) -> Products:
    """n₀:n₀, n₀:e, e:e of group a."""
    return 1.5 * start.na * start.na, 1.5 * start.na * start.ea, 1.5 * start.ea * start.ea


@njit(**INLINE)
def equations(start: Start, values: Functions, middle: Functions, ta: Turn, tc: Turn, b: float) -> Equations:
    """The two equations, n:n − k² and b* − b*₀ − ½ (n₀ + n):p, at b* and at the Λ of both groups' turns.

    `values` are the material functions at the end, `middle` half way, with their slopes in the end's b*.
    """
    zeta, dzeta = middle[2], middle[3]
    a, c = axial_products(start), (start.nn, start.ne, start.ee)
    nna, nnab, nnal, wa, wab, wal = _group_terms(ta, start.ca, zeta, dzeta, a)
    nnc, nncb, nncl, wc, wcb, wcl = _group_terms(tc, start.cc, zeta, dzeta, c)
    r1, r2 = nna + nnc - values[0], b - start.b - wa - wc
    return Equations(r1, r2, nnab + nncb - values[1], nnal + nncl, 1.0 - wab - wcb, -wal - wcl, wa + wc)


@njit(**INLINE)
def correction(at: Equations) -> Correction:
    """Newton's correction."""
    g = at.r2 - at.r2l * at.r1 / at.r1l
    inverse = 1.0 / (at.r1b * at.r2l - at.r1l * at.r2b)  # positive as r1l < 0 where dg/db* is
    b = (at.r1l * at.r2 - at.r2l * at.r1) * inverse
    return Correction(b, (at.r2b * at.r1 - at.r1b * at.r2) * inverse, inverse, g)


@njit(**INLINE)
def is_last(start: Start, k2: float, at: Equations, newton: Correction, b: float) -> bool:
    """Whether this correction ends the iteration; the remaining error is of the order FINE²."""
    # the second term is the rounding of b* and of n:(n_trial − n), all times c
    small = abs(newton.g) * start.cc <= FINE * at.work * start.cc + 1e-15 * (b * start.cc + k2)
    return small & (abs(at.r1) <= FINE * k2) & (newton.inverse > 0.0)


@njit(**INLINE)
def corrected(t: Turn, newton: Correction) -> Turn:
    """A turn after the last correction of b* and Λ."""
    phi = t.phi + t.phi_b * newton.b + t.phi_l * newton.multiplier
    y = t.y + t.y_b * newton.b + t.y_l * newton.multiplier
    return Turn(phi, y, t.phi_b, t.y_b, t.phi_l, t.y_l)


@njit(**INLINE)
def halved(values: Functions) -> Functions:
    """Material functions half way, with their slopes in the end's b*."""
    k2, dk2, zeta, dzeta, kappa, dkappa = values
    return k2, 0.5 * dk2, zeta, 0.5 * dzeta, kappa, 0.5 * dkappa


@njit(**KERNEL)
def _neutral(p: np.ndarray, temperature: float, start: Start, values: Functions) -> Local:
    """The smaller κ for which the increment ends on the yield surface with λ = 0."""
    k2_start, _, zeta, _, kappa, _ = values
    na, ea = start.na, start.ea
    low, high, width = 0.0, kappa, math.inf
    for iteration in range(1, MAX_ITERATIONS):
        xa, xc = 1.0 / (1.0 + kappa * (zeta + start.ca)), 1.0 / (1.0 + kappa * (zeta + start.cc))
        dxa, dxc = -xa * xa * (zeta + start.ca), -xc * xc * (zeta + start.cc)
        # n:n, n:(x′ e), and the work ½ (n₀ + n):p with p = κ x e; x′ = dx/dκ, (κ x)′ = x²
        nn = 1.5 * (na + xa * ea) ** 2 + start.nn + xc * (2.0 * start.ne + xc * start.ee)
        ndxe = 1.5 * (na + xa * ea) * dxa * ea + dxc * (start.ne + xc * start.ee)
        mean_a, mean_c = 1.5 * (na + 0.5 * xa * ea) * ea, start.ne + 0.5 * xc * start.ee
        work = kappa * (xa * mean_a + xc * mean_c)
        dwork = xa * xa * mean_a + xc * xc * mean_c
        dwork += 0.5 * kappa * (1.5 * xa * dxa * ea * ea + xc * dxc * start.ee)
        # With spin, the work may be slightly negative, to higher order; b* does not decrease.
        b = start.b + max(work, 0.0)
        k2, dk2, _, _, _, _ = functions(p, b, temperature)
        r1 = nn - k2
        db = dwork if work > 0.0 else 0.0
        slope = 2.0 * ndxe - dk2 * db
        if abs(r1) <= 1e-14 * k2_start or high - low <= 1e-15 * high:
            a, c = Turn(1.0, xa, 0.0, 0.0, 0.0, dxa), Turn(1.0, xc, 0.0, 0.0, 0.0, dxc)
            inverse = 1.0 / (dk2 * db - 2.0 * ndxe)
            moves = inverse if work > 0.0 else 0.0  # else b* is kept
            if p[HELD] > 0.0:
                return Local(iteration, b, zeta, 0.0, a, c, 0.0, 0.0, 0.0, 0.0)
            return Local(iteration, b, zeta, 0.0, a, c, -dk2 * moves, 2.0 * ndxe * moves, inverse, -db * inverse)
        if r1 > 0.0:
            low = kappa
        else:
            high = kappa
        step = -r1 / slope
        if low < kappa + step < high and abs(step) <= 0.5 * width:
            width = abs(step)
            kappa += step
        else:
            width = 0.5 * (high - low)
            kappa = 0.5 * (low + high)
    return _failed(start)


@njit(**KERNEL)
def _frozen(start: Start, values: Functions, ga: Group, gc: Group) -> Local:
    """At the edge of the cone spin can make the work slightly negative: b* is kept, and only n:n = k² is solved."""
    a, c = axial_products(start), (start.nn, start.ne, start.ee)
    multiplier = _multiplier(ga, gc, a, c, values[0], 0.0, 1e-15)
    ta, tc = turn(Group(ga.s, 0.0, ga.x, 0.0), multiplier), turn(Group(gc.s, 0.0, gc.x, 0.0), multiplier)
    slope = _square(ta, *a)[1] + _square(tc, *c)[1]
    return Local(1, start.b, values[2], 0.0, ta, tc, 0.0, 0.0, -1.0 / slope, 0.0)


@njit(**INLINE)
def _failed(start: Start) -> Local:
    nothing = Turn(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return Local(FAILED, start.b, 0.0, 0.0, nothing, nothing, 0.0, 0.0, 0.0, 0.0)


@njit(**KERNEL)
def solve(p: np.ndarray, temperature: float, start: Start, values: Functions) -> Local:
    """Solve the two local equations.

    Args:
        p: parameter array.
        temperature: of the point, K.
        start: the increment's plastic part, a `Start`.
        values: `functions` where it starts.

    Returns:
        A `Local`; its `iterations` are -1 if there was no convergence.
    """
    low = start.b
    # twice the max over n of ½ (n₀ + n):(n₀ + e − n), which is ½ |n₀ + ½ e|²
    middle_a, middle_c = start.na + 0.5 * start.ea, start.nn + start.ne + 0.25 * start.ee
    high = low + 1.5 * middle_a * middle_a / start.ca + middle_c / start.cc
    b, multiplier, last = low, 0.0, math.inf
    for iteration in range(1, MAX_ITERATIONS):
        middle = halved(functions(p, start.b + 0.5 * (b - start.b), temperature))
        if not (values[0] > 0.0 and middle[0] > 0.0):
            break
        ga = group(start.ca, middle[2], middle[3], middle[4], middle[5])
        gc = group(start.cc, middle[2], middle[3], middle[4], middle[5])
        if b > start.b:
            c = (start.nn, start.ne, start.ee)
            multiplier = _multiplier(ga, gc, axial_products(start), c, values[0], multiplier, COARSE)
        ta, tc = turn(ga, multiplier), turn(gc, multiplier)
        at = equations(start, values, middle, ta, tc, b)
        newton = correction(at)
        step, inverse = newton.b, newton.inverse
        if iteration == 1 and at.r1 < 0.0:
            return _neutral(p, temperature, start, values)
        if iteration == 1 and newton.g > 0.0:
            return _frozen(start, values, ga, gc)
        if is_last(start, values[0], at, newton, b):
            # The last Newton step is taken in everything.
            return Local(
                iteration,
                b + step,
                middle[2] + middle[3] * step,
                middle[3],
                corrected(ta, newton),
                corrected(tc, newton),
                at.r1b * inverse,
                at.r1l * inverse,
                at.r2b * inverse,
                at.r2l * inverse,
            )
        # else Λ is not accurate enough for a reliable sign
        if abs(newton.g) > 10.0 * COARSE * at.work or abs(at.r1) <= FINE * values[0]:
            if newton.g < 0.0:
                low = b
            else:
                high = b
        # Newton, unless it leaves the bracket or oscillates across a kink.
        if inverse > 0.0 and low < b + step < high and (step * last > 0.0 or abs(step) <= 0.5 * abs(last)):
            multiplier += newton.multiplier
        else:
            step = 0.5 * (low + high) - b
        last = step
        b += step
        values = functions(p, b, temperature)
    return _failed(start)


@njit(**INLINE)
def estimate(start: Start, k2: float, dk2: float, zeta: float, kappa: float) -> Estimate:
    """b* and Λ at the end of the increment, by k², k²′, ζ and κ where it starts."""
    ga, gc = group(start.ca, zeta, 0.0, kappa, 0.0), group(start.cc, zeta, 0.0, kappa, 0.0)
    fa, wa = _polynomials(axial_products(start), ga.x, ga.s / gc.s, 0.5 / (start.ca + zeta))
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
