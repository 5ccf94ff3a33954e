"""The local problem of the implicit return mapping, common to the rod and to the three-dimensional law.

Backward Euler for the rate equations of chapter 3: all functions are taken at the end of the plastic part of the increment.
With e the elastic increment of the active deviator over that part (e = c Δε′; c = 2G, but ⅔E for the rod's axial component),
n₀ its value when the part starts, p the plastic strain increment and n = T − B at the end,

    (1 + κζ) p = Λ n + κ ΔT,   ΔT = e − c p,   ΔB = ζ p          (3.1.6, 3.1.8), Λ = 2λΔt

is solved in closed form: with h = 1 + κ(ζ + c), x = 1/h, s = (c + ζ)/h

    n = q / (1 + sΛ),   q = n₀ + x e,   p = (n₀ + e − n) / (c + ζ).

Two scalars are left, the plastic work b* and Λ, and two equations:

    n:n = k²(b*)         (3.1.4)                   b* = b*₀ + n:p        (3.1.7)

For a given b* the root Λ of the first is found by a Newton iteration that cannot fail, since 1/|n| is a concave, growing
function of Λ. What remains is one equation for b*, solved by Newton inside a bracket: k² is steep at b* = 0, so that Newton
alone overshoots there, and the slope of k² jumps at b1*.

A point has two groups of components: `a`, a single one with modulus `ca` (the rod's axial one), and `c`, any number with
modulus `cc`, of which only the inner products enter.
"""

import math
from collections import namedtuple

from numba import njit

from coilset.model.material.functions import functions

MAX_ITERATIONS = 60
PRECISION = 1e-12

# What the increment starts from. na, ea: n₀ and e of group a, with the metric's weight 3/2 to be applied; dea = de/db*, the
# thermal strain's part; nn, ne, ee: inner products of n₀ and e of group c.
Start = namedtuple("Start", "b temperature heating ca na ea dea cc nn ne ee")
# s, x of a group and their derivatives with respect to b*.
Group = namedtuple("Group", "s ds x dx")
# The solution, and the Jacobian of the two equations (r1: n:n − k², r2: b* − b*₀ − n:p) in (b*, Λ).
Local = namedtuple("Local", "iterations b multiplier zeta dzeta a c r1b r1l r2b r2l")


@njit(cache=True)
def yield_crossing(nn, ne, ee, k2):
    """Elastic fraction of an increment that starts inside or on the yield surface and ends outside: |n₀ + β e|² = k².

    The κ term of (3.1.6) belongs to plastic loading only, so it must not see the elastic part.
    """
    root = ne * ne + ee * (k2 - nn)
    if root <= 0.0 or (nn >= k2 and ne >= 0.0):
        return 0.0
    root = math.sqrt(root)
    beta = (k2 - nn) / (ne + root) if ne > 0.0 else (root - ne) / ee
    return min(max(beta, 0.0), 1.0)


@njit(cache=True)
def _group(c, zeta, dzeta, kappa, dkappa):
    x = 1.0 / (1.0 + kappa * (zeta + c))
    dx = -x * x * (dkappa * (zeta + c) + kappa * dzeta)
    return Group((c + zeta) * x, dzeta * x + (c + zeta) * dx, x, dx)


@njit(cache=True)
def _multiplier(qa, sa, qc, sc, k, start):
    """Root Λ of qa/(1 + sa Λ)² + qc/(1 + sc Λ)² = k²; qa, qc are squared norms."""
    multiplier = start
    for _ in range(MAX_ITERATIONS):
        ua = 1.0 / (1.0 + sa * multiplier)
        uc = 1.0 / (1.0 + sc * multiplier)
        ya = qa * ua * ua
        yc = qc * uc * uc
        y = ya + yc
        excess = math.sqrt(y) / k - 1.0
        multiplier += y * excess / (ya * sa * ua + yc * sc * uc)
        if abs(excess) < 1e-8:  # quadratic: the step just made leaves an error of its square
            break
    return multiplier


@njit(cache=True)
def _work(g, c, zeta, dzeta, multiplier, qq, dqq, qt, dqt):
    """n:p of a group with its derivatives in b* and Λ, then n:n with its."""
    u = 1.0 / (1.0 + g.s * multiplier)
    du = -u * u * g.ds * multiplier
    lu = -u * u * g.s
    m = 1.0 / (c + zeta)
    nn = qq * u * u
    work = (qt * u - nn) * m
    slope = (qt - 2.0 * qq * u) * m
    work_b = (dqt * u - dqq * u * u) * m - work * dzeta * m + slope * du
    return work, work_b, slope * lu, dqq * u * u + 2.0 * qq * u * du, 2.0 * qq * u * lu


@njit(cache=True)
def solve(p, start):
    """Solve the two local equations.

    Args:
        p: parameter array.
        start: the increment's plastic part, a `Start`.

    Returns:
        A `Local`; its `iterations` are -1 if there was no convergence.
    """
    ca, na, cc = start.ca, start.na, start.cc
    qt_end = start.nn + 2.0 * start.ne + start.ee
    low = start.b
    # max over n of n:(n_trial − n) is |n_trial|²/4; twice that leaves room for thermal strain.
    high = low + 0.5 * (1.5 * (na + start.ea) ** 2 / ca + qt_end / cc)
    b = low
    multiplier = 0.0
    for iteration in range(1, MAX_ITERATIONS):
        k2, dk2, zeta, dzeta, kappa, dkappa = functions(p, b, start.temperature + start.heating * (b - start.b))
        if not k2 > 0.0:
            break
        ga = _group(ca, zeta, dzeta, kappa, dkappa)
        gc = _group(cc, zeta, dzeta, kappa, dkappa)
        ea = start.ea + start.dea * (b - start.b)
        qa = na + ga.x * ea
        dqa = ga.dx * ea + ga.x * start.dea
        qqc = start.nn + gc.x * (2.0 * start.ne + gc.x * start.ee)
        k = math.sqrt(k2)
        multiplier = _multiplier(1.5 * qa * qa, ga.s, qqc, gc.s, k, multiplier)
        wa, wab, wal, r1ab, r1al = _work(ga, ca, zeta, dzeta, multiplier, 1.5 * qa * qa, 3.0 * qa * dqa,
                                         1.5 * qa * (na + ea), 1.5 * (dqa * (na + ea) + qa * start.dea))  # fmt: skip
        wc, wcb, wcl, r1cb, r1cl = _work(gc, cc, zeta, dzeta, multiplier, qqc, 2.0 * gc.dx * (start.ne + gc.x * start.ee),
                                         start.nn + start.ne + gc.x * (start.ne + start.ee),
                                         gc.dx * (start.ne + start.ee))  # fmt: skip
        r1b = r1ab + r1cb - dk2
        r1l = r1al + r1cl
        r2b = 1.0 - wab - wcb
        r2l = -wal - wcl
        work = wa + wc
        g = b - start.b - work
        # Rounding of b* and of n:(n_trial − n) limits what can be asked for.
        if abs(g) <= PRECISION * work + 1e-15 * (b + k2 / cc) or high - low <= 1e-15 * high:
            return Local(iteration, b, multiplier, zeta, dzeta, ga, gc, r1b, r1l, r2b, r2l)
        if g < 0.0:
            low = b
        else:
            high = b
        slope = r2b - r2l * r1b / r1l
        step = -g / slope if slope > 0.0 else math.inf
        if low < b + step < high:
            # Λ follows along its own curve, so that the next inner iteration starts close.
            multiplier = max(multiplier - step * r1b / r1l, 0.0)
            b += step
        else:
            b = 0.5 * (low + high)
    nothing = Group(0.0, 0.0, 0.0, 0.0)
    return Local(-1, b, 0.0, 0.0, 0.0, nothing, nothing, 0.0, 0.0, 0.0, 0.0)
