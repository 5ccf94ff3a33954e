"""The warping of one section: its strains, Newton's method for it, and its condensation; see `warping`.

Points are lanes of vectors. The warping's components w1, w2, w3 and their slopes are combined at all points from tables
of the polynomials, which all sections share; the wire's curvature and torsion enter point by point, and forces go the
same way back. So do the columns of the stiffness, for points whose tangent is not Hooke's.
"""

import math
from collections import namedtuple

import numpy as np

from coilset.model.core.material.law.loop import PointLaw, flow_points
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit
from coilset.model.core.section.integration import SUMS

# A change of the warping, a strain, that ends the iteration. Its effect on the resultants is added to them, so that
# their error is the next change, which must be below REST: more disturbs the rod's iteration.
TOLERANCE, REST = 1e-9, 1e-12
MAX_ITERATIONS = 40
SHORTEST = 1e-3  # part of a correction
ROUNDING = 1e-13  # of moduli
RIGID = 9  # the section strains ε, γ12, γ13, φ′, κ2, κ3; w2 = y, w3 = z, (w2, w3) = (z, y); then the polynomials
VECTORS = 16  # lengths of loops are multiples of it, where they can be
LANES = 64  # points at a time
SINGLE = np.float32

# Rows of points: forces on w1, w2, w3 and on their slopes along y and along z; stresses or strains, or the forces on
# H_t; y, z, 1/g; w1, w2, w3 over r and their slopes; by how much the tangents differ from Hooke's.
STRESS, PLACE, FIELDS, LOSS = 9, 15, 18, 27
ROWS = LOSS + 36

# Of all sections: each one's number of its geometry, shape (cells, sections); by that number radius, curvature and
# torsion of the wire and where the points are; points, polynomials and weights, first of the whole wire and then of
# each ground section.
Tables = namedtuple("Tables", "number wire which y z f w")
# Radius, κ r and τ r of the wire.
Bend = namedtuple("Bend", "R k t")
# A section's geometry: its number; its Bend; y, z of the points on the unit disk, polynomials, their slopes along
# y and along z, one after the other, shape (3 polynomials, points); 1/g and the volumes g dA.
Section = namedtuple("Section", "number bend y z f inverse dA")
# Stiffness of elastic sections of each geometry, as K in `Work` before elimination; Hooke's law.
Elastic = namedtuple("Elastic", "stiffness hooke")
# Work space: increments of section strains and warping; strains of the points, tangents of the law; its iterations,
# then the points whose tangents differ from Hooke's; stiffness of strains and warping, after elimination D and the
# upper factors of D_aa; the lower ones; forces, and these after elimination; number of the geometry whose elastic
# stiffness this is, or −1; the change of the warping, behind six zeros.
Work = namedtuple("Work", "step strain C flow K factors r rest kept change")
Three = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]


@njit(**KERNEL)
def work_space(points: int, n: int) -> Work:
    """Work space for sections of so many points and unknowns of the warping."""
    size, width = 6 + n, (6 + n + VECTORS - 1) // VECTORS * VECTORS
    return Work(
        np.zeros(width),
        np.empty((points, 6)),
        np.empty((points, 6, 6)),
        np.empty(points, np.int64),
        np.zeros((size, width)),
        np.zeros((size, width)),
        np.empty(width),
        np.empty(width),
        np.full(1, -1),
        np.zeros(width),
    )


@njit(**KERNEL)
def find_warping(
    law: PointLaw,
    of: Section,
    elastic: Elastic,
    old: np.ndarray,
    old_a: np.ndarray,
    a: np.ndarray,
    new: np.ndarray,
    w: Work,
    count: np.ndarray,
) -> bool:
    """Newton's method for the warping `a` at the section strain increment in the first six places of the steps.

    Far from the solution a correction may overshoot, since flow makes the section soft. If the work of the residual
    forces, r_a · Δa, is larger in magnitude after it than before, it is shortened to the zero of a straight line
    through both.

    Args:
        law: of the points.
        of, elastic: the section's geometry; elastic sections and points.
        old, old_a: state of its points and its warping at the last equilibrium; not changed.
        a: warping, where the iteration begins; written.
        new: state of the points; written.
        w: work space; at the end with forces and stiffness after elimination.
        count: the local iterations are added to its second entry.

    Returns:
        False if the law had no solution somewhere, or the last change of the warping is not within the tolerance.
    """
    n, change = len(a), w.change[6:]
    before, last, part = math.inf, math.inf, 1.0
    for _ in range(MAX_ITERATIONS):
        for i in range(n):
            w.step[6 + i] = a[i] - old_a[i]
        count[1] += 1
        if not forces(law, of, old, new, w):
            return False
        after = 0.0
        if before < math.inf:
            for i in range(n):
                after -= change[i] * w.r[6 + i]
        if after > before and part > SHORTEST:
            shorter = part * max(before / (before + after), 0.1)
            for i in range(n):
                a[i] += (part - shorter) * change[i]
            part = shorter
            continue
        if not stiffness(of, elastic, w):
            return False
        solve(w)
        largest, before, part = 0.0, 0.0, 1.0
        for i in range(n):
            largest = max(largest, abs(change[i]))
            before += change[i] * w.r[6 + i]
        if not math.isfinite(largest):
            return False
        if largest <= TOLERANCE and largest * largest <= REST * last:
            return True
        for i in range(n):
            a[i] -= change[i]
        last = largest
    return False


@njit(**INLINE)
def strain_at(bend: Bend, e: Six, p: int, w: np.ndarray) -> Six:
    """Strains ε11, ε22, ε33, γ12, γ13, γ23 of a point from section strains, w/r and its slopes; see `warping`."""
    y, z, inverse = three(w, PLACE, p)
    v, vy, vz = three(w, FIELDS, p), three(w, FIELDS + 3, p), three(w, FIELDS + 6, p)
    R, k, t, ty, tz = bend.R, bend.k, bend.t, bend.t * y, bend.t * z
    h1 = e[0] + R * (e[4] * z - e[5] * y) - k * v[1] + tz * vy[0] - ty * vz[0]
    h2 = e[1] - R * e[3] * z + k * v[0] - t * v[2] + tz * vy[1] - ty * vz[1]
    h3 = e[2] + R * e[3] * y + t * v[1] + tz * vy[2] - ty * vz[2]
    return (h1 * inverse, vy[1], vz[2], h2 * inverse + vy[0], h3 * inverse + vz[0], vz[1] + vy[2])


@njit(**INLINE)
def keep_forces(bend: Bend, s: Six, p: int, w: np.ndarray) -> None:
    """Write the forces of a point's stresses: on H_t, and on w and its slopes."""
    y, z, inverse = w[PLACE, p], w[PLACE + 1, p], w[PLACE + 2, p]
    k, t, ty, tz = bend.k, bend.t, bend.t * y, bend.t * z
    t1, t2, t3 = s[0] * inverse, s[3] * inverse, s[4] * inverse
    keep_three(t1, t2, t3, w, STRESS, p)
    keep_three(k * t2, t * t3 - k * t1, -t * t2, w, 0, p)
    keep_three(tz * t1 + s[3], tz * t2 + s[1], tz * t3 + s[5], w, 3, p)
    keep_three(s[4] - ty * t1, s[5] - ty * t2, s[2] - ty * t3, w, 6, p)


@njit(**INLINE)
def three(w: np.ndarray, row: int, p: int) -> Three:
    """Of three rows."""
    return (w[row, p], w[row + 1, p], w[row + 2, p])


@njit(**INLINE)
def keep_three(a: float, b: float, c: float, w: np.ndarray, row: int, p: int) -> None:
    """Write three rows."""
    w[row, p], w[row + 1, p], w[row + 2, p] = a, b, c


@njit(**INLINE)
def linear(a: Three, size: int, w: np.ndarray) -> None:
    """Write w and its slopes of the linear functions."""
    stretch, width, turn = a
    for p in range(size):
        y, z = w[PLACE, p], w[PLACE + 1, p]
        keep_three(0.0, stretch * y + turn * z, width * z + turn * y, w, FIELDS, p)
        keep_three(0.0, stretch, turn, w, FIELDS + 3, p)
        keep_three(0.0, turn, width, w, FIELDS + 6, p)


@njit(**INLINE)
def places(of: Section, first: int, size: int, w: np.ndarray) -> None:
    """Write where the points of a block are."""
    for p in range(size):
        keep_three(of.y[first + p], of.z[first + p], of.inverse[first + p], w, PLACE, p)


@njit(**KERNEL)
def strains(of: Section, step: np.ndarray, strain: np.ndarray) -> None:
    """Strains of all points for a step of section strains and warping.

    Args:
        of: the section's geometry.
        step: shape (9 + 3 polynomials,): the section strains, the linear functions, then the polynomials as w1, w2, w3
            in turn.
        strain: written, shape (points, 6).
    """
    w, f, n = np.empty((LOSS, LANES)), of.f, len(of.f) // 3
    e = (step[0], step[1], step[2], step[3], step[4], step[5])
    for block in range(0, len(strain), LANES):
        first = max(block, 0)  # so that numba tests no index for its sign
        size = min(LANES, len(strain) - first)
        places(of, first, size, w)
        linear((step[6], step[7], step[8]), size, w)
        for k in range(0, n, 2):
            other, both = min(k + 1, n - 1), 1.0 if k + 1 < n else 0.0
            a1, a2, a3 = step[RIGID + k], step[RIGID + n + k], step[RIGID + 2 * n + k]
            b1, b2, b3 = step[RIGID + other], step[RIGID + n + other], step[RIGID + 2 * n + other]
            b1, b2, b3 = both * b1, both * b2, both * b3
            for d in range(3):
                row = FIELDS + 3 * d
                for p in range(size):
                    a, b = f[d * n + k, first + p], f[d * n + other, first + p]
                    w[row, p] += a1 * a + b1 * b
                    w[row + 1, p] += a2 * a + b2 * b
                    w[row + 2, p] += a3 * a + b3 * b
        for p in range(size):
            found = strain_at(of.bend, e, p, w)
            for i in range(6):
                w[STRESS + i, p] = found[i]
        for p in range(size):
            for i in range(6):
                strain[first + p, i] = w[STRESS + i, p]


@njit(**SUMS)
def project(R: float, f: np.ndarray, first: int, size: int, w: np.ndarray, r: np.ndarray) -> None:
    """Add the forces of a block of points to those of section strains and warping.

    Args:
        R: radius of the wire.
        f: polynomials, their slopes along y and along z, one after the other, shape (3 polynomials, points).
        first, size: the block.
        w: its forces, as `keep_forces` writes them.
        r: shape (9 + 3 polynomials,) or longer.
    """
    n, zero = len(f) // 3, w.dtype.type(0.0)
    r0 = r1 = r2 = r3 = r4 = r5 = r6 = r7 = r8 = zero
    for p in range(size):
        y, z = w[PLACE, p], w[PLACE + 1, p]
        t1, t2, t3 = w[STRESS, p], w[STRESS + 1, p], w[STRESS + 2, p]
        r0, r1, r2 = r0 + t1, r1 + t2, r2 + t3
        r3, r4, r5 = r3 + y * t3 - z * t2, r4 + z * t1, r5 - y * t1
        r6 += y * w[1, p] + w[4, p]
        r7 += z * w[2, p] + w[8, p]
        r8 += z * w[1, p] + w[7, p] + y * w[2, p] + w[5, p]
    r[0], r[1], r[2] = r[0] + r0, r[1] + r1, r[2] + r2
    r[3], r[4], r[5] = r[3] + R * r3, r[4] + R * r4, r[5] + R * r5
    r[6], r[7], r[8] = r[6] + r6, r[7] + r7, r[8] + r8
    for k in range(0, n, 2):
        other = min(k + 1, n - 1)
        a1 = a2 = a3 = b1 = b2 = b3 = zero
        for p in range(size):
            q = first + p
            a, ay, az = f[k, q], f[n + k, q], f[2 * n + k, q]
            b, by, bz = f[other, q], f[n + other, q], f[2 * n + other, q]
            a1 += a * w[0, p] + ay * w[3, p] + az * w[6, p]
            a2 += a * w[1, p] + ay * w[4, p] + az * w[7, p]
            a3 += a * w[2, p] + ay * w[5, p] + az * w[8, p]
            b1 += b * w[0, p] + by * w[3, p] + bz * w[6, p]
            b2 += b * w[1, p] + by * w[4, p] + bz * w[7, p]
            b3 += b * w[2, p] + by * w[5, p] + bz * w[8, p]
        i, j = RIGID + k, RIGID + other
        r[i], r[n + i], r[2 * n + i] = r[i] + a1, r[n + i] + a2, r[2 * n + i] + a3
        if other > k:
            r[j], r[n + j], r[2 * n + j] = r[j] + b1, r[n + j] + b2, r[2 * n + j] + b3


@njit(**KERNEL)
def forces(law: PointLaw, of: Section, old: np.ndarray, new: np.ndarray, w: Work) -> bool:
    """Stresses of all points for the step of strains and warping, r = ∫ Bᵀ σ g dA; False if the law has no solution."""
    strains(of, w.step, w.strain)
    if not flow_points(law, 6, old, w.strain, new, w.C.reshape((-1, 36)), True, w.flow):
        return False
    integrate(of, new, w.r)
    return True


@njit(**KERNEL)
def integrate(of: Section, stress: np.ndarray, r: np.ndarray) -> None:
    """Write the forces ∫ Bᵀ σ g dA of the stresses in the first six columns."""
    w = np.empty((LOSS, LANES))
    for i in range(len(r)):
        r[i] = 0.0
    for block in range(0, len(of.dA), LANES):
        first = max(block, 0)
        size = min(LANES, len(of.dA) - first)
        places(of, first, size, w)
        for k in range(size):
            for i in range(6):
                w[STRESS + i, k] = of.dA[first + k] * stress[first + k, i]
        for k in range(size):
            s0, s1, s2 = three(w, STRESS, k)
            s3, s4, s5 = three(w, STRESS + 3, k)
            keep_forces(of.bend, (s0, s1, s2, s3, s4, s5), k, w)
        project(of.bend.R, of.f, first, size, w, r)


@njit(**KERNEL)
def stiffness(of: Section, elastic: Elastic, w: Work) -> bool:
    """K = ∫ Bᵀ C B g dA: the elastic one, and what the tangents of points differ from Hooke's, with its factors.

    The elastic one is kept for sections of the same geometry that follow. False if D_aa is singular.
    """
    flows = 0
    for k in range(len(of.dA)):
        if _differs(w.C[k], elastic.hooke):
            w.flow[flows] = k
            flows += 1
    if flows == 0 and w.kept[0] == of.number:
        return True
    w.kept[0] = -1 if flows > 0 else of.number
    for i in range(w.K.shape[0]):
        for j in range(w.K.shape[1]):
            w.K[i, j] = elastic.stiffness[of.number, i, j]
    add_loss(of, w.flow[:flows], w.C, elastic.hooke, w.K)
    return factorise(w)


@njit(**KERNEL)
def _differs(C: np.ndarray, hooke: np.ndarray) -> bool:
    """Whether a tangent is another than Hooke's, by one modulus across and one in shear."""
    across, shear = abs(C[0, 0] - hooke[0, 0]), abs(C[3, 3] - hooke[3, 3])
    return across > ROUNDING * hooke[0, 0] or shear > ROUNDING * hooke[3, 3]


@njit(**KERNEL)
def add_loss(of: Section, which: np.ndarray, C: np.ndarray, hooke: np.ndarray, K: np.ndarray) -> None:
    """Add ∫ Bᵀ (C − Hooke's law) B g dA over some of the points, in single precision, which is 1e-8 of D.

    Args:
        of: the section's geometry.
        which: numbers of the points.
        C: of all points, shape (points, 6, 6).
        hooke: shape (6, 6).
        K: shape (9 + 3 polynomials, as many or more).
    """
    f, size, n = of.f, len(K), len(of.f) // 3
    w, polynomials, unit = np.empty((ROWS, LANES), SINGLE), np.empty((3 * n, LANES), SINGLE), np.empty(RIGID, SINGLE)
    bend, column = Bend(SINGLE(of.bend.R), SINGLE(of.bend.k), SINGLE(of.bend.t)), np.empty(size)
    for first in range(0, len(which), LANES):
        last = min(LANES, len(which) - first) - 1
        whole = (last + VECTORS) // VECTORS * VECTORS  # the last one is repeated, without weight
        for p in range(whole):
            k = which[first + min(p, last)]
            area = of.dA[k] if p <= last else 0.0
            keep_three(of.y[k], of.z[k], of.inverse[k], w, PLACE, p)
            for i in range(6):
                for j in range(6):
                    w[LOSS + 6 * i + j, p] = area * (C[k, i, j] - hooke[i, j])
            for i in range(3 * n):
                polynomials[i, p] = f[i, k]
        for j in range(size):
            c, k = (j - RIGID) // n, (j - RIGID) % n
            if j <= RIGID:
                for i in range(RIGID):
                    unit[i] = 1.0 if i == j else 0.0
                linear((unit[6], unit[7], unit[8]), whole, w)
            if j >= RIGID:
                for d in range(3):
                    row = FIELDS + 3 * d + c
                    if k == 0 and c > 0:
                        w[row - 1, :whole] = 0.0
                    for p in range(whole):
                        w[row, p] = polynomials[d * n + k, p]
            e = (unit[0], unit[1], unit[2], unit[3], unit[4], unit[5])
            for p in range(whole):
                s = strain_at(bend, e, p, w)
                s0, s1, s2 = lost(w, 0, s, p), lost(w, 1, s, p), lost(w, 2, s, p)
                s3, s4, s5 = lost(w, 3, s, p), lost(w, 4, s, p), lost(w, 5, s, p)
                keep_forces(bend, (s0, s1, s2, s3, s4, s5), p, w)
            for i in range(size):
                column[i] = 0.0
            project(bend.R, polynomials, 0, whole, w, column)
            for i in range(size):
                K[i, j] += column[i]


@njit(**INLINE)
def lost(w: np.ndarray, i: int, s: Six, p: int) -> float:
    """A row of the rows LOSS times strains."""
    at = LOSS + 6 * i
    first = w[at, p] * s[0] + w[at + 1, p] * s[1] + w[at + 2, p] * s[2]
    return first + w[at + 3, p] * s[3] + w[at + 4, p] * s[4] + w[at + 5, p] * s[5]


@njit(**KERNEL)
def factorise(w: Work) -> bool:
    """Eliminate the warping from K, the last unknown first; False if D_aa is singular.

    D_aa is as good as symmetric and positive definite, so that the order is free.
    """
    K, size = w.K, len(w.K)
    for k in range(size - 1, 5, -1):
        if not abs(K[k, k]) > 0.0:
            return False
        inverse, whole = 1.0 / K[k, k], (k + VECTORS - 1) // VECTORS * VECTORS
        for i in range(k):
            factor = K[i, k] * inverse
            w.factors[k, i] = factor
            for j in range(whole):
                K[i, j] -= factor * K[k, j]
    return True


@njit(**SUMS)
def solve(w: Work) -> None:
    """Write the forces after elimination, and the change D_aa⁻¹ r_a."""
    K, rest, x = w.K, w.rest, w.change
    for i in range(len(x)):
        rest[i], x[i] = w.r[i], 0.0
    for k in range(len(K) - 1, 5, -1):
        whole, value = (k + VECTORS - 1) // VECTORS * VECTORS, rest[k]
        for i in range(whole):
            rest[i] -= w.factors[k, i] * value
    for k in range(6, len(K)):
        value, whole = rest[k], (k + VECTORS - 1) // VECTORS * VECTORS
        for j in range(whole):
            value -= K[k, j] * x[j]
        x[k] = value / K[k, k]


@njit(**KERNEL)
def slopes(w: Work, slope: np.ndarray) -> None:
    """Write da/de = −D_aa⁻¹ D_ae."""
    K = w.K
    for k in range(6, len(K)):
        s0, s1, s2, s3, s4, s5 = K[k, 0], K[k, 1], K[k, 2], K[k, 3], K[k, 4], K[k, 5]
        for j in range(6, k):
            f, b = K[k, j], slope[j - 6]
            s0, s1, s2 = s0 + f * b[0], s1 + f * b[1], s2 + f * b[2]
            s3, s4, s5 = s3 + f * b[3], s4 + f * b[4], s5 + f * b[5]
        b, f = slope[k - 6], -1.0 / K[k, k]
        b[0], b[1], b[2], b[3], b[4], b[5] = f * s0, f * s1, f * s2, f * s3, f * s4, f * s5


@njit(**KERNEL)
def elastic_stiffness(hooke: np.ndarray, at: Tables) -> np.ndarray:
    """K = ∫ Bᵀ C B g dA of elastic sections of each geometry, shape (geometries, size, width)."""
    points, n = at.w.shape[1], 3 + at.f.shape[1]
    w, inverse, dA, stress = work_space(points, n), np.empty(points), np.empty(points), np.empty((points, 6))
    found = np.zeros((len(at.which), *w.K.shape))
    for number in range(len(at.which)):
        of = place(at, number, inverse, dA)
        for j in range(6 + n):
            w.step[j] = 1.0
            strains(of, w.step, w.strain)
            w.step[j] = 0.0
            for p in range(points):
                for i in range(6):
                    stress[p, i] = 0.0
                    for k in range(6):
                        stress[p, i] += hooke[i, k] * w.strain[p, k]
            integrate(of, stress, w.r)
            for i in range(6 + n):
                found[number, i, j] = w.r[i]
    return found


@njit(**KERNEL)
def place(at: Tables, number: int, inverse: np.ndarray, dA: np.ndarray) -> Section:
    """A section's geometry; writes 1/g and the volumes g dA of its points."""
    (R, curvature, torsion), i = at.wire[number], at.which[number]
    y, weights = at.y[i], at.w[i]
    for p in range(len(dA)):
        g = 1.0 - curvature * R * y[p]
        inverse[p], dA[p] = 1.0 / g, math.pi * R * R * weights[p] * g
    return Section(number, Bend(R, curvature * R, torsion * R), y, at.z[i], at.f[i], inverse, dA)
