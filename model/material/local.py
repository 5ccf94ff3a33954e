"""The local problem of the implicit return mapping, common to the rod and to the three-dimensional law.

Backward Euler for the rate equations of chapter 3: all functions are taken at the end of the plastic part of the
increment. With e the elastic increment of the active deviator over that part (e = c Δε′; c = 2G, but ⅔E for the rod's
axial component), n₀ its value when the part starts, p the plastic strain increment and n = T − B at the end,

    (1 + κζ) p = Λ n + κ ΔT,   ΔT = e − c p,   ΔB = ζ p          (3.1.6, 3.1.8), Λ = 2λΔt

is solved in closed form: with h = 1 + κ(ζ + c), x = 1/h, s = (c + ζ)/h

    n = q / (1 + sΛ),   q = n₀ + x e,   p = (n₀ + e − n) / (c + ζ).

Two scalars are left, the plastic work b* and Λ, and two equations:

    n:n = k²(b*)    (3.1.4)         b* = b*₀ + f n:p,  f = ½(1 + k(b*₀)/k(b*))        (3.1.7)

The factor f puts the mean of |n| at the start and at the end into the work, which makes the classic radial return with
a yield stress linear in the plastic strain a special case, exact to rounding.

Newton's method on both is kept safe in two ways. For a given b* the root Λ of the first comes from a Newton iteration
that cannot fail, since 1/|n| is a concave, growing function of Λ; and b* stays in a bracket, halved where Newton would
leave it: k² is steep at b* = 0, so that Newton alone overshoots there, and the slope of k² jumps at b1*.

Neutral loading. The κ term sets in suddenly with loading. In the rod, where x differs between the axial and the shear
components, there is a narrow cone of strain increments, nearly tangential to the yield surface, for which the elastic
answer leaves the surface although the plastic one with λ ≥ 0 moves inside: neither may be. The limit of ever smaller
steps that switch between the two stays on the surface with λ = 0 and a smaller κ; `_neutral` finds that κ. The plastic
work is then of second order, so ζ and the temperature are kept.

A point has two groups of components: `a`, a single one with modulus `ca` (the rod's axial one), and `c`, any number
with modulus `cc`, of which only the inner products enter.
"""

import math
from collections import namedtuple

import numpy as np
from numba import njit

from coilset.model.material.functions import CHANGE, INLINE, KERNEL, Functions, functions, inside_table

MAX_ITERATIONS = 60
FAILED, TOO_HOT = -1, -2  # in the place of a number of iterations; TOO_HOT: heated out of the material's table
FINE = 1e-6  # relative residual below which one more Newton step ends the iteration
COARSE = 1e-3  # relative error of |n| to which Λ is brought before the two equations are solved together

# What the increment starts from. na, ea: n₀ and e of group a, with the metric's weight 3/2 to be applied; dea = de/db*,
# the thermal strain's part; nn, ne, ee: inner products of n₀ and e of group c.
Start = namedtuple("Start", "b temperature heating ca na ea dea cc nn ne ee")
# s, x of a group and their derivatives with respect to b*.
Group = namedtuple("Group", "s ds x dx")
# The solution, and the Jacobian of the two equations (r1: n:n − k², r2: b* − b*₀ − f n:p) in (b*, Λ), or in (b*, κ) if
# neutral, divided by its determinant; mean is f.
Local = namedtuple("Local", "iterations neutral b multiplier mean zeta dzeta a c r1b r1l r2b r2l")


@njit(**INLINE)
def surface(p: np.ndarray, b: float, temperature: float, k2: float) -> tuple[float, float]:
    """k² at the start of the increment, and its change until the end, where it is `k2`, by the prescribed temperature.

    With it `yield_crossing` keeps the elastic fraction of an increment from the surface at zero, although the surface
    has moved away until the end.
    """
    if p[CHANGE] == 0.0:
        return k2, 0.0
    start = functions(p, b, temperature - p[CHANGE])[0]
    return start, k2 - start


@njit(**INLINE)
def yield_crossing(nn: float, ne: float, ee: float, k2: float) -> float:
    """Elastic fraction of an increment that starts inside or on the yield surface and ends outside: |n₀ + β e|² = k².

    The κ term of (3.1.6) belongs to plastic loading only, so it must not see the elastic part.
    """
    root = ne * ne + ee * (k2 - nn)
    if root <= 0.0 or (nn >= k2 and ne >= 0.0):
        return 0.0
    root = math.sqrt(root)
    beta = (k2 - nn) / (ne + root) if ne > 0.0 else (root - ne) / ee
    return min(max(beta, 0.0), 1.0)


@njit(**INLINE)
def _group(c: float, zeta: float, dzeta: float, kappa: float, dkappa: float) -> Group:
    x = 1.0 / (1.0 + kappa * (zeta + c))
    dx = -x * x * (dkappa * (zeta + c) + kappa * dzeta)
    return Group((c + zeta) * x, dzeta * x + (c + zeta) * dx, x, dx)


@njit(**INLINE)
def _multiplier(
    qa: float, sa: float, qc: float, sc: float, k2: float, start: float, precision: float
) -> tuple[float, float, float]:
    """Root Λ of qa/(1 + sa Λ)² + qc/(1 + sc Λ)² = k², and both 1/(1 + s Λ); qa, qc: squared norms."""
    lowest = -1.0 / max(sa, sc)
    multiplier = max(start, 0.5 * lowest)
    for _ in range(MAX_ITERATIONS):
        ua, uc = 1.0 / (1.0 + sa * multiplier), 1.0 / (1.0 + sc * multiplier)
        ya, yc = qa * ua * ua, qc * uc * uc
        y = ya + yc
        if abs(y - k2) < 2.0 * precision * k2:
            break
        step = y * (math.sqrt(y / k2) - 1.0) / (ya * sa * ua + yc * sc * uc)  # Newton for 1/|n| = 1/k
        multiplier = max(multiplier + step, 0.5 * (multiplier + lowest))
    return multiplier, ua, uc


@njit(**INLINE)
def _group_terms(
    g: Group,
    c: float,
    zeta: float,
    dzeta: float,
    multiplier: float,
    u: float,
    qq: float,
    dqq: float,
    qt: float,
    dqt: float,
) -> Functions:
    """A group's n:n and n:p, each with its derivatives in b* and Λ; qq = q:q, qt = q:(n₀ + e), dqq, dqt = d/db*."""
    m = 1.0 / (c + zeta)
    du = -u * u * g.ds * multiplier
    lu = -u * u * g.s
    nn = qq * u * u
    work = (qt * u - nn) * m
    slope = (qt - 2.0 * qq * u) * m
    work_b = (dqt * u - dqq * u * u) * m - work * dzeta * m + slope * du
    return nn, dqq * u * u + 2.0 * qq * u * du, 2.0 * qq * u * lu, work, work_b, slope * lu


@njit(**INLINE)
def _equations(
    start: Start,
    k_start: float,
    values: Functions,
    ga: Group,
    gc: Group,
    b: float,
    multiplier: float,
) -> tuple[float, ...]:
    """Residuals n:n − k² and b* − b*₀ − f n:p, their Jacobian in (b*, Λ), Λ made coarsely right first, f n:p and f."""
    k2, dk2, zeta, dzeta, _, _ = values
    na, ea = start.na, start.ea + start.dea * (b - start.b)
    qa, dqa, ta = na + ga.x * ea, ga.dx * ea + ga.x * start.dea, na + ea
    qqa = 1.5 * qa * qa
    qqc = start.nn + gc.x * (2.0 * start.ne + gc.x * start.ee)
    ua = uc = 1.0
    if b > start.b:
        multiplier, ua, uc = _multiplier(qqa, ga.s, qqc, gc.s, k2, multiplier, COARSE)
    nna, nnab, nnal, wa, wab, wal = _group_terms(
        ga, start.ca, zeta, dzeta, multiplier, ua, qqa, 3.0 * qa * dqa, 1.5 * qa * ta, 1.5 * (dqa * ta + qa * start.dea)
    )
    nnc, nncb, nncl, wc, wcb, wcl = _group_terms(
        gc, start.cc, zeta, dzeta, multiplier, uc,
        qqc, 2.0 * gc.dx * (start.ne + gc.x * start.ee),
        start.nn + start.ne + gc.x * (start.ne + start.ee), gc.dx * (start.ne + start.ee),
    )  # fmt: skip
    ratio = 0.5 * k_start / math.sqrt(k2)
    mean = 0.5 + ratio
    work = mean * (wa + wc)
    r1, r2 = nna + nnc - k2, b - start.b - work
    r2b = 1.0 - mean * (wab + wcb) + ratio * 0.5 * dk2 / k2 * (wa + wc)
    return r1, r2, nnab + nncb - dk2, nnal + nncl, r2b, -mean * (wal + wcl), multiplier, work, mean


@njit(**KERNEL)
def _neutral(p: np.ndarray, start: Start, values: Functions) -> Local:
    """The smaller κ for which the increment ends on the yield surface with λ = 0."""
    k2_start, _, zeta, _, kappa, _ = values
    na, ea = start.na, start.ea
    low, high, width = 0.0, kappa, math.inf
    for iteration in range(1, MAX_ITERATIONS):
        xa, xc = 1.0 / (1.0 + kappa * (zeta + start.ca)), 1.0 / (1.0 + kappa * (zeta + start.cc))
        dxa, dxc = -xa * xa * (zeta + start.ca), -xc * xc * (zeta + start.cc)
        # q:q, q:(x e) and q:(x′ e), (x e):(x′ e); x′ = dx/dκ
        qq = 1.5 * (na + xa * ea) ** 2 + start.nn + xc * (2.0 * start.ne + xc * start.ee)
        qxe = 1.5 * (na + xa * ea) * xa * ea + xc * (start.ne + xc * start.ee)
        qdxe = 1.5 * (na + xa * ea) * dxa * ea + dxc * (start.ne + xc * start.ee)
        xedxe = 1.5 * xa * dxa * ea * ea + xc * dxc * start.ee
        # With spin, n:p may come out negative by a trifle of higher order; b* does not fall.
        b = start.b + max(kappa * qxe, 0.0)
        k2, dk2, _, _, _, _ = functions(p, b, start.temperature)
        r1 = qq - k2
        db = qxe + kappa * (qdxe + xedxe) if qxe > 0.0 else 0.0
        slope = 2.0 * qdxe - dk2 * db
        if abs(r1) <= 1e-14 * k2_start or high - low <= 1e-15 * high:
            a, c = Group((start.ca + zeta) * xa, 0.0, xa, 0.0), Group((start.cc + zeta) * xc, 0.0, xc, 0.0)
            inverse = 1.0 / (dk2 * db - 2.0 * qdxe)
            return Local(
                iteration, True, b, 0.0, 1.0, zeta, 0.0, a, c,
                -dk2 * inverse, 2.0 * qdxe * inverse, inverse, -db * inverse,
            )  # fmt: skip
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
def _frozen(start: Start, values: Functions, a: Group, c: Group) -> Local:
    """On the edge of the cone the rod's spin can make n:p negative by a trifle: b* is kept, only n:n = k² solved."""
    qa = start.na + a.x * start.ea
    qqa, qqc = 1.5 * qa * qa, start.nn + c.x * (2.0 * start.ne + c.x * start.ee)
    multiplier, ua, uc = _multiplier(qqa, a.s, qqc, c.s, values[0], 0.0, 1e-15)
    slope = -2.0 * (qqa * a.s * ua * ua * ua + qqc * c.s * uc * uc * uc)
    a, c = Group(a.s, 0.0, a.x, 0.0), Group(c.s, 0.0, c.x, 0.0)
    return Local(1, False, start.b, multiplier, 1.0, values[2], 0.0, a, c, 0.0, 0.0, -1.0 / slope, 0.0)


@njit(**INLINE)
def _failed(start: Start, why: int = FAILED) -> Local:
    nothing = Group(0.0, 0.0, 0.0, 0.0)
    return Local(why, False, start.b, 0.0, 1.0, 0.0, 0.0, nothing, nothing, 0.0, 0.0, 0.0, 0.0)


@njit(**INLINE)
def solve(p: np.ndarray, start: Start, values: Functions) -> Local:
    """Solve the two local equations.

    Args:
        p: parameter array.
        start: the increment's plastic part, a `Start`.
        values: `functions` where it starts.

    Returns:
        A `Local`; its `iterations` are -1 if there was no convergence, -2 if the temperature left the table.
    """
    low = start.b
    # max over n of n:(n_trial − n) is |n_trial|²/4; twice that leaves room for thermal strain.
    high = low + 0.5 * (1.5 * (start.na + start.ea) ** 2 / start.ca + (start.nn + 2.0 * start.ne + start.ee) / start.cc)
    k_start = math.sqrt(values[0])
    b, multiplier, last = low, 0.0, math.inf
    for iteration in range(1, MAX_ITERATIONS):
        k2, _, zeta, dzeta, kappa, dkappa = values
        if not k2 > 0.0:
            break
        ga = _group(start.ca, zeta, dzeta, kappa, dkappa)
        gc = _group(start.cc, zeta, dzeta, kappa, dkappa)
        r1, r2, r1b, r1l, r2b, r2l, multiplier, work, mean = _equations(start, k_start, values, ga, gc, b, multiplier)
        g = r2 - r2l * r1 / r1l
        inverse = 1.0 / (r1b * r2l - r1l * r2b)  # positive as r1l < 0 where dg/db* is
        step = (r1l * r2 - r2l * r1) * inverse
        follow = (r2b * r1 - r1b * r2) * inverse
        if iteration == 1 and r1 < 0.0:
            return _neutral(p, start, values)
        if iteration == 1 and g > 0.0:
            return _frozen(start, values, ga, gc)
        # The second term is the rounding of b* and of n:(n_trial − n).
        if abs(g) <= FINE * work + 1e-15 * (b + k2 / start.cc) and abs(r1) <= FINE * k2 and inverse > 0.0:
            if start.heating > 0.0 and not inside_table(p, start.temperature + start.heating * (b - start.b)):
                return _failed(start, TOO_HOT)
            # The last Newton step is taken in everything: what it leaves is of the order FINE².
            return Local(
                iteration, False, b + step, multiplier + follow, mean, zeta + dzeta * step, dzeta,
                Group(ga.s + ga.ds * step, ga.ds, ga.x + ga.dx * step, ga.dx),
                Group(gc.s + gc.ds * step, gc.ds, gc.x + gc.dx * step, gc.dx),
                r1b * inverse, r1l * inverse, r2b * inverse, r2l * inverse,
            )  # fmt: skip
        if abs(g) > 10.0 * COARSE * work or abs(r1) <= FINE * k2:  # else Λ is too coarse to be sure of the sign
            if g < 0.0:
                low = b
            else:
                high = b
        # Newton, unless it leaves the bracket or swings to and fro across a bend.
        if inverse > 0.0 and low < b + step < high and (step * last > 0.0 or abs(step) <= 0.5 * abs(last)):
            multiplier += follow
        else:
            step = 0.5 * (low + high) - b
        last = step
        b += step
        values = functions(p, b, start.temperature + start.heating * (b - start.b))
    return _failed(start)
