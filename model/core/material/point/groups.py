"""Many points of a rod or a solid, group by group: their elastic response, those that flow, and what these become.

Both have the deviator of stress T, the back stress B and n = T − B; components, weights and moduli differ. The rod has
T = (⅔σ11, τ12, τ13), as σ22 = σ33 = τ23 = 0 (5.2.32), n:m = 3/2 n11 m11 + 2 n12 m12 + 2 n13 m13 (5.2.28), and c = ⅔E of
its axial component. All six stresses come in the order 11, 22, 33, 12, 13, 23, with c = 2G. Stress and back stress hold
the tensor's components, strains engineering shear strains, γ12 = 2ε12. A point's state is a row of σ, B (N/mm²), b*
(N/mm²) and, where each point has its own, the temperature (K); what stands behind stays, or has further back stresses.

The law of six stresses is hypoelastic with the Zaremba-Jaumann rate (3.1.2): it holds in a frame that rotates with the
material's spin. The caller works in such a frame, or rotates the point's state by the increment's rotation first.
"""

import numpy as np

from coilset.model.core.material.law.parts import MOST_TERMS
from coilset.model.core.material.point.local_rows import (
    END,
    ENDED,
    FLOWS,
    FORM,
    GROUP,
    K2,
    PRODUCTS,
    WORK,
    Points,
    harden,
)
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit

Vector = tuple[float, float, float]  # components 11, 12, 13
# Numbers of the components, by which functions are compiled for the rod's three or all six.
Components = tuple[int, ...]
ROD, SOLID = (0, 1, 2), (0, 1, 2, 3, 4, 5)
LARGEST = len(SOLID)
# Rows by component: T, the elastic increment of T; of the tangent the diagonal and, of three dyads, the left and the
# right vectors, the first of which takes the place of n; each back stress.
STRESS, STRAIN, DIAGONAL, LEFT = range(FORM, FORM + 4 * LARGEST, LARGEST)
RIGHT = NORMAL = LEFT + 3 * LARGEST
BACK = RIGHT + 3 * LARGEST
OTHERS = BACK + MOST_TERMS * LARGEST  # rows of the law that the points follow
TANGENT = END  # of three components, in rows that Newton's method no longer needs


@njit(**INLINE)
def inner(a: Vector, b: Vector) -> float:
    """n:m of two deviators of the rod."""
    return 1.5 * a[0] * b[0] + 2.0 * (a[1] * b[1] + a[2] * b[2])


@njit(**INLINE)
def active(s: Vector, b: Vector) -> Vector:
    """n of a stress and a back stress of the rod."""
    return (s[0] / 1.5 - b[0], s[1] - b[1], s[2] - b[2])


@njit(**INLINE)
def add(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@njit(**INLINE)
def scaled(a: Vector, f: float) -> Vector:
    """f a."""
    return (f * a[0], f * a[1], f * a[2])


@njit(**INLINE)
def is_axial(n: int, j: int) -> bool:
    """Whether a component of n is the rod's axial one."""
    return (n == 3) & (j == 0)


@njit(**INLINE)
def is_normal(n: int, j: int) -> bool:
    """Whether a component is one of the normal ones of six."""
    return (n > 3) & (j < 3)


@njit(**INLINE)
def weight(n: int, j: int) -> float:
    """Of a component in a:b."""
    return 1.5 if is_axial(n, j) else 1.0 if is_normal(n, j) else 2.0


@njit(**INLINE)
def modulus(of: Points, n: int, j: int) -> float:
    """c of a component of T."""
    return of.E / 1.5 if is_axial(n, j) else 2.0 * of.G


@njit(**INLINE)
def share(n: int, j: int) -> float:
    """Part of an engineering strain in the component of its tensor."""
    return 1.0 if is_axial(n, j) or is_normal(n, j) else 0.5


@njit(**INLINE)
def of_stress(n: int, j: int) -> float:
    """A component of stress, less its mean, over that of T."""
    return 1.5 if is_axial(n, j) else 1.0


@njit(**INLINE)
def _bulk(E: float, G: float) -> float:
    """Bulk modulus."""
    return E * G / (3.0 * (3.0 * G - E))


@njit(**INLINE)
def elastic_modulus(E: float, G: float, n: int, i: int, j: int) -> float:
    """An entry of the elastic tangent."""
    both = _bulk(E, G) - 2.0 / 3.0 * G if is_normal(n, i) and is_normal(n, j) else 0.0
    own = E if is_axial(n, i) else 2.0 * G * share(n, i)
    return both + (own if i == j else 0.0)


@njit(**INLINE)
def respond(
    p: np.ndarray,
    of: Points,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    place: np.ndarray,
    w: np.ndarray,
) -> tuple[int, int]:
    """Write the elastic response of the points of a group; move those that flow to the front of the rows.

    Args:
        p: parameter array of the law.
        of: the group.
        components: ROD or SOLID.
        old, de, new, tangent, with_tangent: as `return_map.flow_points`.
        place: written, the places of those that flow, shape (GROUP,).
        w: the rows.

    Returns:
        How many flow, and how many these are in whole vectors; the last is repeated up to there.
    """
    n = len(components)
    _trial(p, of, components, old, de, w)
    _elastic(of, components, old, de, new, tangent, with_tangent)
    flow = 0
    for k in range(of.size):
        if w[FLOWS, k] != 0.0:
            place[flow] = k
            flow += 1
    whole = min((flow + 7) // 8 * 8, GROUP)
    if flow > 0:
        _move(WORK, PRODUCTS, flow, of.size, whole, place, w)
        for row in (STRESS, STRAIN, NORMAL, BACK):
            _move(row, row + n, flow, of.size, whole, place, w)
    return flow, whole


@njit(**INLINE)
def _move(first: int, last: int, flow: int, size: int, whole: int, place: np.ndarray, w: np.ndarray) -> None:
    if flow < size:
        for j in range(flow):
            for i in range(first, last):
                w[i, j] = w[i, place[j]]
    for i in range(first, last):
        for j in range(flow, whole):
            w[i, j] = w[i, flow - 1]


@njit(**INLINE)
def _trial(p: np.ndarray, of: Points, components: Components, old: np.ndarray, de: np.ndarray, w: np.ndarray) -> None:
    """T and its elastic increment, k² and which points flow."""
    n = len(components)
    for k in range(of.size):
        at, mean, grown = of.first + k, 0.0, 0.0
        if n > 3:
            mean, grown = (old[at, 0] + old[at, 1] + old[at, 2]) / 3.0, (de[0, at] + de[1, at] + de[2, at]) / 3.0
        for j in range(n):
            normal = 1.0 if is_normal(n, j) else 0.0
            w[STRESS + j, k] = old[at, j] / 1.5 if is_axial(n, j) else old[at, j] - normal * mean
            w[STRAIN + j, k] = modulus(of, n, j) * share(n, j) * (de[j, at] - normal * grown)
            w[BACK + j, k] = old[at, n + j]
            w[NORMAL + j, k] = w[STRESS + j, k] - w[BACK + j, k]
        w[WORK, k] = old[at, 2 * n]
    harden(p, of, of.size, WORK, K2, w)
    for k in range(of.size):
        square = 0.0
        for j in range(n):
            trial = w[NORMAL + j, k] + w[STRAIN + j, k]
            square += weight(n, j) * trial * trial
        w[FLOWS, k] = 0.0 if square <= w[K2, k] * (1.0 + 1e-12) else 1.0


@njit(**INLINE)
def products(components: Components, w: np.ndarray, k: int) -> tuple[float, float, float, float, float]:
    """n and e of the axial component (0 of six), then n:n, n:e, e:e of the others; e: the elastic increment of T."""
    n, na, ea = len(components), 0.0, 0.0
    nn = ne = ee = 0.0
    for j in range(n):
        normal, e = w[NORMAL + j, k], w[STRAIN + j, k]
        if is_axial(n, j):
            na, ea = normal, e
        else:
            nn += weight(n, j) * normal * normal
            ne += weight(n, j) * normal * e
            ee += weight(n, j) * e * e
    return na, ea, nn, ne, ee


@njit(**INLINE)
def _elastic(
    of: Points,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
) -> None:
    """Write the elastic response of a group."""
    n, first = len(components), of.first
    if with_tangent and n == 3:
        for i in range(n * n):
            value = elastic_modulus(of.E, of.G, n, i // n, i % n)
            for k in range(of.size):
                tangent[i, first + k] = value
    elif with_tangent:
        for k in range(of.size):
            for i in range(n * n):
                tangent[i, first + k] = elastic_modulus(of.E, of.G, n, i // n, i % n)
    lame = elastic_modulus(of.E, of.G, n, 0, 1)
    for k in range(of.size):
        at, volume = first + k, 0.0
        if n > 3:
            volume = lame * (de[0, at] + de[1, at] + de[2, at])
        for j in range(n):
            own = modulus(of, n, j) * of_stress(n, j) * share(n, j)
            new[at, j] = old[at, j] + own * de[j, at] + (volume if is_normal(n, j) else 0.0)
        for j in range(n, 2 * n + 1):
            new[at, j] = old[at, j]
        for j in range(2 * n + 1, old.shape[1]):
            new[at, j] = old[at, j]


@njit(**INLINE)
def keep(
    of: Points,
    components: Components,
    terms: int,
    flow: int,
    with_tangent: bool,
    place: np.ndarray,
    w: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    count: np.ndarray,
) -> bool:
    """Write states, tangents and counts of the points that flow to their places; whether all have found a solution."""
    n, last, good = len(components), terms - 1, True
    further, bulk = new.shape[1] - n * last, _bulk(of.E, of.G)
    right = np.empty((3, n))
    for j in range(flow if with_tangent and n == 3 else 0):
        for i in range(n):
            a, b, c = w[LEFT + i, j], w[LEFT + LARGEST + i, j], w[LEFT + 2 * LARGEST + i, j]
            for m in range(n):
                dyads = a * w[RIGHT + m, j] + b * w[RIGHT + LARGEST + m, j] + c * w[RIGHT + 2 * LARGEST + m, j]
                w[TANGENT + n * i + m, j] = dyads + (w[DIAGONAL + i, j] * share(n, i) if i == m else 0.0)
    for j in range(flow):
        k, mean = np.uint64(of.first) + place[j], 0.0
        count[k] = int(w[ENDED, j])
        if not w[ENDED, j] > 0.0:
            good = False
            continue
        if n > 3:
            mean = (new[k, 0] + new[k, 1] + new[k, 2]) / 3.0  # of the elastic response
        for i in range(n):
            new[k, i] = w[STRESS + i, j] * of_stress(n, i) + (mean if is_normal(n, i) else 0.0)
            total = w[BACK + n * last + i, j]
            for term in range(last):
                total += w[BACK + n * term + i, j]
                new[k, further + n * term + i] = w[BACK + n * term + i, j]
            new[k, n + i] = total
        new[k, 2 * n] = w[WORK, j]
        if with_tangent and n == 3:
            for i in range(n * n):
                tangent[i, k] = w[TANGENT + i, j]
        elif with_tangent:
            for r in range(3):
                for m in range(n):
                    right[r, m] = w[RIGHT + LARGEST * r + m, j]
            for i in range(n):
                a, b, c, d = w[LEFT + i, j], w[LEFT + LARGEST + i, j], w[LEFT + 2 * LARGEST + i, j], w[DIAGONAL + i, j]
                for m in range(n):
                    tangent[n * i + m, k] = a * right[0, m] + b * right[1, m] + c * right[2, m]
                for m in range(3 if is_normal(n, i) else 0):
                    tangent[n * i + m, k] += bulk - d / 3.0
                tangent[n * i + i, k] += d * share(n, i)
    return good


@njit(**KERNEL)
def hooke(E: float, G: float, C: np.ndarray) -> None:
    """Write Hooke's law of six stresses, shape (6, 6), N/mm²."""
    for i in range(6):
        for j in range(6):
            C[i, j] = elastic_modulus(E, G, 6, i, j)
