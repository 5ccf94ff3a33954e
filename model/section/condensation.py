"""The warping of one section: its strains, Newton's method for it, and its condensation; see `warping`."""

import math
from collections import namedtuple

import numpy as np

from coilset.model.material.point.choice import solid_points
from coilset.model.runtime.kernels import KERNEL, njit
from coilset.model.section.integration import SUMS

# A change of the warping, a strain, that ends the iteration. Its effect on the resultants is added to them, so that
# their error is the next change, which must be below REST: more disturbs the rod's iteration.
TOLERANCE, REST = 1e-9, 1e-12
MAX_ITERATIONS = 40
SHORTEST = 1e-3  # part of a correction
# A correction below which the stiffness is kept for those that follow, and for the section tangent: it changes by the
# correction over the strain at which the law's slope changes, 1e-5 and more. And how fast corrections must fall.
NEAR, FASTER = 1e-7, 0.1
ROUNDING = 1e-13  # of moduli
WIDTH = 16  # rows are filled up with zeros to a multiple of it, so that all of a row is added in whole vectors

# Of all sections: each one's number of its geometry, shape (cells, sections); by that number radius, curvature and
# torsion of the wire and where the points are; points, polynomials and weights, first of the whole wire and then of
# each ground section.
Tables = namedtuple("Tables", "number wire which y z f w")
# A section's geometry: its number, strain operator, the volumes g dA of its points, elastic stiffness; Hooke's law.
Operator = namedtuple("Operator", "number B dA stiffness hooke")
# Work space: increments of section strains and warping; strains of the points, tangents of the law, and whether they
# differ from Hooke's; of one point, by how much, and this times B; stiffness and forces of strains and warping; factors
# of D_aa, and D_aa⁻¹ D_ae; which rows were exchanged; number of the geometry whose elastic stiffness this is, or −1;
# the change of the warping.
Work = namedtuple("Work", "step strain C flow loss lost K r X rows kept change")


@njit(cache=True)
def strain_operator(
    y: np.ndarray, z: np.ndarray, f: np.ndarray, radius: float, curvature: float, torsion: float, B: np.ndarray
) -> None:
    """Strains of a section's points for unit section strains and unit warping.

    Columns: ε, γ12, γ13, φ′, κ2, κ3; w2 = y, w3 = z, (w2, w3) = (z, y); then the polynomials as w1, w2, w3 in turn.
    Rows of a point: ε11, ε22, ε33, γ12, γ13, γ23.

    Args:
        y, z: on the unit disk, shape (points,).
        f: polynomials and their slopes, shape (3, points, polynomials).
        radius, curvature, torsion: of the wire, mm and 1/mm.
        B: written, shape (points, 6, 9 + 3 polynomials); its zeros are taken to be there.
    """
    kr, tr = curvature * radius, torsion * radius
    n = f.shape[2]
    for p in range(len(y)):
        Y, Z = y[p], z[p]
        i = 1.0 / (1.0 - kr * Y)
        b = B[p]
        b[0, 0] = b[3, 1] = b[4, 2] = i
        b[3, 3], b[4, 3] = -radius * Z * i, radius * Y * i
        b[0, 4], b[0, 5] = radius * Z * i, -radius * Y * i
        # w2 = y: Ω × w = (−κ w2, 0, τ w2), τ (z w,y − y w,z) = τ z along n
        b[0, 6], b[1, 6], b[3, 6], b[4, 6] = -kr * Y * i, 1.0, tr * Z * i, tr * Y * i
        # w3 = z: Ω × w = (0, −τ w3, 0), −τ y along b
        b[2, 7], b[3, 7], b[4, 7] = 1.0, -tr * Z * i, -tr * Y * i
        # (z, y): Ω × w = (−κ z, −τ y, τ z), τ (−y, z) along n and b
        b[0, 8], b[3, 8], b[4, 8], b[5, 8] = -kr * Z * i, -2.0 * tr * Y * i, 2.0 * tr * Z * i, 2.0
        for k in range(n):
            value, fy, fz = f[0, p, k], f[1, p, k], f[2, p, k]
            turned = tr * (Z * fy - Y * fz) * i
            bent, twisted = kr * value * i, tr * value * i
            j = 9 + k
            b[0, j], b[3, j], b[4, j] = turned, bent + fy, fz
            j += n
            b[0, j], b[1, j], b[3, j], b[4, j], b[5, j] = -bent, fy, turned, twisted, fz
            j += n
            b[2, j], b[3, j], b[4, j], b[5, j] = fz, -twisted, turned, fy


@njit(cache=True)
def work_space(points: int, n: int) -> Work:
    """Work space for sections of so many points and unknowns of the warping."""
    size, width = 6 + n, (6 + n + WIDTH - 1) // WIDTH * WIDTH
    return Work(
        np.zeros(width),
        np.empty((points, 6)),
        np.empty((points, 6, 6)),
        np.empty(points, np.int64),
        np.empty((6, 6)),
        np.empty((6, width)),
        np.empty((size, width)),
        np.empty(width),
        np.empty((n, n + 6)),
        np.empty(n, np.int64),
        np.full(1, -1),
        np.empty(n),
    )


@njit(cache=True)
def find_warping(
    p: np.ndarray,
    of: Operator,
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
        p: parameters of the material law, or Parts.
        of: the section's geometry.
        old, old_a: state of its points and its warping at the last equilibrium; not changed.
        a: warping, where the iteration begins; written.
        new: state of the points; written.
        w: work space; at the end with stiffness, forces, D_aa⁻¹ D_ae and D_aa⁻¹ r_a.
        count: the local iterations are added to its second entry.

    Returns:
        False if the law had no solution somewhere, or the last change of the warping is not within the tolerance.
    """
    n, stiff = len(a), True
    before, last, part = math.inf, math.inf, 1.0
    for _ in range(MAX_ITERATIONS):
        for i in range(n):
            w.step[6 + i] = a[i] - old_a[i]
        count[1] += 1
        if not forces(p, of, old, new, w):
            return False
        after = 0.0
        if before < math.inf:
            for i in range(n):
                after -= w.change[i] * w.r[6 + i]
        if after > before and part > SHORTEST:
            shorter = part * max(before / (before + after), 0.1)
            for i in range(n):
                a[i] += (part - shorter) * w.change[i]
            part = shorter
            continue
        if stiff and not stiffness(of, w):
            return False
        solve(w)
        largest, before, part = 0.0, 0.0, 1.0
        for i in range(n):
            largest = max(largest, abs(w.change[i]))
            before += w.change[i] * w.r[6 + i]
        if not math.isfinite(largest):
            return False
        if largest <= TOLERANCE and largest * largest <= REST * last:
            return True
        for i in range(n):
            a[i] -= w.change[i]
        stiff, last = largest > NEAR or largest > FASTER * last, largest
    return False


@njit(**SUMS)
def strains(B: np.ndarray, w: Work) -> None:
    """Write the points' strains for the step of strains and warping."""
    step, strain = w.step, w.strain
    for k in range(len(B)):
        for i in range(6):
            value = 0.0
            for j in range(len(step)):
                value += B[k, i, j] * step[j]
            strain[k, i] = value


@njit(**KERNEL)
def forces(p: np.ndarray, of: Operator, old: np.ndarray, new: np.ndarray, w: Work) -> bool:
    """Stresses of all points for the step of strains and warping, r = ∫ Bᵀ σ g dA; False if the law has no solution."""
    strains(of.B, w)
    if not solid_points(p, old, w.strain, new, w.C, w.flow):
        return False
    r = w.r
    r[:] = 0.0
    for k in range(len(of.dA)):
        b, area = of.B[k], of.dA[k]
        s0, s1, s2 = area * new[k, 0], area * new[k, 1], area * new[k, 2]
        s3, s4, s5 = area * new[k, 3], area * new[k, 4], area * new[k, 5]
        for j in range(len(r)):
            r[j] += b[0, j] * s0 + b[1, j] * s1 + b[2, j] * s2 + b[3, j] * s3 + b[4, j] * s4 + b[5, j] * s5
    return True


@njit(**KERNEL)
def stiffness(of: Operator, w: Work) -> bool:
    """K = ∫ Bᵀ C B g dA: the elastic one, and what the tangents of points differ from Hooke's, with its factors.

    The elastic one is kept for sections of the same geometry that follow. False if D_aa is singular.
    """
    flows = False
    for k in range(len(of.dA)):
        w.flow[k] = _differs(w.C[k], of.hooke)
        flows = flows or w.flow[k] != 0
    if not flows and w.kept[0] == of.number:
        return True
    w.kept[0] = -1 if flows else of.number
    w.K[:] = of.stiffness
    for k in range(len(of.dA)):
        if w.flow[k] != 0:
            for i in range(6):
                for j in range(6):
                    w.loss[i, j] = of.dA[k] * (w.C[k, i, j] - of.hooke[i, j])
            add_stiffness(of.B[k], w.loss, w.lost, w.K)
    return factorise(w)


@njit(**KERNEL)
def _differs(C: np.ndarray, hooke: np.ndarray) -> int:
    """Whether a tangent is another than Hooke's, by one modulus across and one in shear."""
    across, shear = abs(C[0, 0] - hooke[0, 0]), abs(C[3, 3] - hooke[3, 3])
    return 1 if across > ROUNDING * hooke[0, 0] or shear > ROUNDING * hooke[3, 3] else 0


@njit(**KERNEL)
def add_stiffness(b: np.ndarray, C: np.ndarray, CB: np.ndarray, K: np.ndarray) -> None:
    """Add Bᵀ C B of a point; `CB` is work space."""
    size, width = K.shape
    n = (size - 9) // 3
    for i in range(6):
        c0, c1, c2, c3, c4, c5 = C[i, 0], C[i, 1], C[i, 2], C[i, 3], C[i, 4], C[i, 5]
        for j in range(width):
            CB[i, j] = c0 * b[0, j] + c1 * b[1, j] + c2 * b[2, j] + c3 * b[3, j] + c4 * b[4, j] + c5 * b[5, j]
    for i in range(9):
        b0, b1, b2, b3, b4, b5 = b[0, i], b[1, i], b[2, i], b[3, i], b[4, i], b[5, i]
        for j in range(width):
            K[i, j] += b0 * CB[0, j] + b1 * CB[1, j] + b2 * CB[2, j] + b3 * CB[3, j] + b4 * CB[4, j] + b5 * CB[5, j]
    for i in range(9, 9 + n):  # w1 strains ε11, γ12, γ13 only
        b0, b3, b4 = b[0, i], b[3, i], b[4, i]
        for j in range(width):
            K[i, j] += b0 * CB[0, j] + b3 * CB[3, j] + b4 * CB[4, j]
    for i in range(9 + n, 9 + 2 * n):  # w2 all but ε33
        b0, b1, b3, b4, b5 = b[0, i], b[1, i], b[3, i], b[4, i], b[5, i]
        for j in range(width):
            K[i, j] += b0 * CB[0, j] + b1 * CB[1, j] + b3 * CB[3, j] + b4 * CB[4, j] + b5 * CB[5, j]
    for i in range(9 + 2 * n, size):  # w3 all but ε11 and ε22
        b2, b3, b4, b5 = b[2, i], b[3, i], b[4, i], b[5, i]
        for j in range(width):
            K[i, j] += b2 * CB[2, j] + b3 * CB[3, j] + b4 * CB[4, j] + b5 * CB[5, j]


@njit(**KERNEL)
def factorise(w: Work) -> bool:
    """D_aa = L U by Gaussian elimination with partial pivoting, and D_aa⁻¹ D_ae; False if it is singular."""
    X, (n, columns) = w.X, w.X.shape
    for i in range(n):
        for j in range(n):
            X[i, j] = w.K[6 + i, 6 + j]
        for j in range(6):
            X[i, n + j] = w.K[6 + i, j]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(X[i, k]) > abs(X[best, k]):
                best = i
        if not abs(X[best, k]) > 0.0:
            return False
        w.rows[k] = best
        if best != k:
            for j in range(columns):
                X[k, j], X[best, j] = X[best, j], X[k, j]
        inverse = 1.0 / X[k, k]
        for i in range(k + 1, n):
            factor = X[i, k] * inverse
            X[i, k] = factor
            for j in range(k + 1, columns):
                X[i, j] -= factor * X[k, j]
    for k in range(n - 1, -1, -1):
        inverse = 1.0 / X[k, k]
        for j in range(n, columns):
            X[k, j] *= inverse
        for i in range(k):
            factor = X[i, k]
            for j in range(n, columns):
                X[i, j] -= factor * X[k, j]
    return True


@njit(**KERNEL)
def solve(w: Work) -> None:
    """Write the change D_aa⁻¹ r_a by the factors of D_aa."""
    X, x, n = w.X, w.change, len(w.change)
    for i in range(n):
        x[i] = w.r[6 + i]
    for k in range(n):
        x[k], x[w.rows[k]] = x[w.rows[k]], x[k]
    for k in range(n):
        for i in range(k + 1, n):
            x[i] -= X[i, k] * x[k]
    for k in range(n - 1, -1, -1):
        x[k] /= X[k, k]
        for i in range(k):
            x[i] -= X[i, k] * x[k]


@njit(**KERNEL)
def condense(w: Work, s: np.ndarray, D: np.ndarray) -> None:
    """s = r_e − D_ea D_aa⁻¹ r_a, D = D_ee − D_ea D_aa⁻¹ D_ae, as `find_warping` leaves them."""
    K, X, n = w.K, w.X, len(w.change)
    for i in range(6):
        s[i] = w.r[i]
        for j in range(6):
            D[i, j] = K[i, j]
        for k in range(n):
            along = K[i, 6 + k]
            s[i] -= along * w.change[k]
            for j in range(6):
                D[i, j] -= along * X[k, n + j]


@njit(**KERNEL)
def elastic_stiffness(hooke: np.ndarray, at: Tables) -> np.ndarray:
    """K = ∫ Bᵀ C B g dA of elastic sections of each geometry, shape (geometries, size, width)."""
    points, n = at.w.shape[1], 3 + 3 * at.f.shape[3]
    work = work_space(points, n)
    all_of_them = np.zeros((len(at.which), *work.K.shape))
    B, dA = np.zeros((points, 6, len(work.step))), np.empty(points)
    for number in range(len(at.which)):
        place(at, number, B, dA)
        for k in range(points):
            add_stiffness(B[k], dA[k] * hooke, work.lost, all_of_them[number])
    return all_of_them


@njit(**KERNEL)
def place(at: Tables, number: int, B: np.ndarray, dA: np.ndarray) -> None:
    """Write strain operator and volumes of the points of a geometry."""
    (R, curvature, torsion), i = at.wire[number], at.which[number]
    strain_operator(at.y[i], at.z[i], at.f[i], R, curvature, torsion, B)
    for k in range(len(dA)):
        dA[k] = math.pi * R * R * at.w[i, k] * (1.0 - curvature * R * at.y[i, k])
