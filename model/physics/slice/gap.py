"""Gap between a coil and the next one, compiled, with its first and second derivatives.

Both coils are the same surface, which a screw about the axis maps onto itself: it is given by its curve in a half
plane through the axis, m(X) = (r, z − κθ) of its points X = (r cos θ, r sin θ, z), κ = h̄/λ. The next coil's curve is
this one raised by the pitch 2πκ. With q = m(P) − m(C(s)) − 2πκ e_ζ from the closest point C(s) of the next coil to a
point P of this one, n the outward normal of the next coil there and τ its tangent,

    g = n·q,   g_a = n·q_a,   s_a = (q_a·C′ + g n·C′_a)/(|C′|² − g n·C″),
    g_ab = n·q_ab − (τ·q_a) n·(C′_b + C″ s_b)/|C′| − n·C′_a s_b.
"""

import math
from typing import NamedTuple

import numpy as np

from coilset.model.core.runtime.kernels import njit

SAMPLES = 4  # intervals of an edge in the search for the closest point
ITERATIONS = 12


class Sides(NamedTuple):
    """The sides of a coil that may touch.

    Attributes:
        edges, polynomials: of `Boundary`.
        above, below: indices of its edges on the upper and on the lower side.
    """

    edges: np.ndarray
    polynomials: np.ndarray
    above: np.ndarray
    below: np.ndarray


class Gaps(NamedTuple):
    """Gaps of Gauss points on the upper side to the next coil, and derivatives of those below a limit.

    Attributes:
        gap: shape (edges above, points), mm.
        where: of gaps below the limit, edge above, point and edge below, shape (edges above × points, 3).
        gradient, hessian: of the same gaps, by the nodes of the edge above, of the edge below, and by κ.
    """

    gap: np.ndarray
    where: np.ndarray
    gradient: np.ndarray
    hessian: np.ndarray


class Point(NamedTuple):
    """Work arrays for a point of an edge.

    Attributes:
        N: shape functions and their first and second derivatives, shape (3, nodes).
        X: position and its derivatives along the edge, shape (3, 3).
        m, D, H: m(X), its first and second derivatives, shapes (2,), (2, 3) and (2, 3, 3).
        turned: θ with its derivatives, shape (4,).
        C: C, C′ and C″, shape (3, 2).
    """

    N: np.ndarray
    X: np.ndarray
    m: np.ndarray
    D: np.ndarray
    H: np.ndarray
    turned: np.ndarray
    C: np.ndarray


@njit(cache=True)
def shape(polynomials: np.ndarray, t: float, N: np.ndarray) -> None:
    """Write the shape functions of an edge at t and their first and second derivatives, shape (3, nodes)."""
    n = len(polynomials)
    for a in range(n):
        N[0, a] = N[1, a] = N[2, a] = 0.0
        for m in range(n):
            c = polynomials[a, m]
            N[0, a] += c * t**m
            N[1, a] += c * m * t ** (m - 1) if m > 0 else 0.0
            N[2, a] += c * m * (m - 1) * t ** (m - 2) if m > 1 else 0.0


@njit(cache=True)
def place(x: np.ndarray, edge: np.ndarray, N: np.ndarray, X: np.ndarray) -> None:
    """Write position and its derivatives along the edge, shape (3, 3)."""
    for k in range(3):
        for i in range(3):
            X[k, i] = 0.0
            for a in range(len(edge)):
                X[k, i] += N[k, a] * x[edge[a], i]


@njit(cache=True)
def meridian(κ: float, point: Point) -> None:
    """Write m(X), its first and second derivatives, and θ with its derivatives."""
    _, X, m, D, H, turned, _ = point
    x, y = X[0, 0], X[0, 1]
    r2 = x * x + y * y
    r, θ = math.sqrt(r2), math.atan2(y, x)
    turned[0], turned[1], turned[2], turned[3] = θ, -y / r2, x / r2, 0.0
    m[0], m[1] = r, X[0, 2] - κ * θ
    D[0, 0], D[0, 1], D[0, 2] = x / r, y / r, 0.0
    D[1, 0], D[1, 1], D[1, 2] = κ * y / r2, -κ * x / r2, 1.0
    H[:] = 0.0
    H[0, 0, 0], H[0, 1, 1], H[0, 0, 1] = y * y / r**3, x * x / r**3, -x * y / r**3
    H[1, 0, 0], H[1, 1, 1], H[1, 0, 1] = -κ * 2 * x * y / r2**2, κ * 2 * x * y / r2**2, -κ * (y * y - x * x) / r2**2
    H[0, 1, 0], H[1, 1, 0] = H[0, 0, 1], H[1, 0, 1]


@njit(cache=True)
def curve(x: np.ndarray, edge: np.ndarray, polynomials: np.ndarray, κ: float, t: float, point: Point) -> None:
    """Write C, C′ and C″ of an edge of the next coil, raised by its pitch, and what leads to them."""
    N, X, m, D, H, _, C = point
    shape(polynomials, t, N)
    place(x, edge, N, X)
    meridian(κ, point)
    for k in range(2):
        C[0, k], C[1, k], C[2, k] = m[k], 0.0, 0.0
        for i in range(3):
            C[1, k] += D[k, i] * X[1, i]
            C[2, k] += D[k, i] * X[2, i]
            for l in range(3):
                C[2, k] += H[k, i, l] * X[1, i] * X[1, l]
    C[0, 1] += 2.0 * math.pi * κ


@njit(cache=True)
def closest(
    x: np.ndarray, sides: Sides, κ: float, p: np.ndarray, start: np.ndarray, point: Point
) -> tuple[int, float, bool]:
    """Edge (an index into `below`) and t of the point on the next coil's lower side closest to p in the half plane.

    Args:
        x, sides, κ: as in `gaps`.
        p: r and z − κθ of the point, shape (2,), mm.
        start: positions of the samples on every edge, shape (edges of `below`, SAMPLES + 1, 2).
        point: written.

    Returns:
        Index into `below`, t, and whether the point is inside its edge.
    """
    edges, polynomials, _, below = sides
    C = point.C
    best, number, t = math.inf, 0, 0.0
    for e in range(len(below)):
        for k in range(SAMPLES + 1):
            d = (start[e, k, 0] - p[0]) ** 2 + (start[e, k, 1] - p[1]) ** 2
            if d < best:
                best, number, t = d, e, k / SAMPLES
    inside = True
    for attempt in range(2):
        edge = edges[below[number]]
        for _ in range(ITERATIONS):
            curve(x, edge, polynomials, κ, t, point)
            q0, q1 = p[0] - C[0, 0], p[1] - C[0, 1]
            slope = -(q0 * C[1, 0] + q1 * C[1, 1])
            length = C[1, 0] ** 2 + C[1, 1] ** 2
            second = length - q0 * C[2, 0] - q1 * C[2, 1]
            step = -slope / (second if second > 0.0 else length)
            new = min(max(t + step, 0.0), 1.0)
            inside = 0.0 < new < 1.0
            moved, t = abs(new - t), new
            if moved < 1e-15:
                break
        if inside or attempt == 1:
            break
        # at an end: the point may lie beyond it, on an edge that begins or ends there
        meets = edge[0] if t == 0.0 else edge[-1]
        found = -1
        for e in range(len(below)):
            if e != number and (edges[below[e]][0] == meets or edges[below[e]][-1] == meets):
                found = e
        if found < 0:
            break
        number, t = found, 0.5
    return number, t, inside


@njit(cache=True)
def room(nodes: int) -> Point:
    """Work arrays for edges of so many nodes, not yet written."""
    return Point(
        np.empty((3, nodes)),
        np.empty((3, 3)),
        np.empty(2),
        np.empty((2, 3)),
        np.empty((2, 3, 3)),
        np.empty(4),
        np.empty((3, 2)),
    )


@njit(cache=True)
def gaps(x: np.ndarray, κ: float, sides: Sides, gauss: np.ndarray, limit: float, out: Gaps) -> int:
    """Gaps of Gauss points on the upper side to the next coil, and derivatives of those below a limit.

    Args:
        x: positions of the nodes, shape (blocks, 3), mm.
        κ: h̄/λ, mm/rad.
        sides: of the coil.
        gauss: t of the Gauss points on the edges above, shape (points,).
        limit: gap below which derivatives are computed, mm.
        out: written.

    Returns:
        Number of gaps with derivatives.
    """
    (edges, polynomials, above, below), (gap, where, gradient, hessian) = sides, out
    n = edges.shape[1]
    size, count = 6 * n + 1, 0
    there, here = room(n), room(n)  # on the next coil, and on this one
    _, X, _, D, H, turned, C = there
    N, (M, Y, p, Dp, Hp, turned_p, _) = there.N, here
    start = np.empty((len(below), SAMPLES + 1, 2))
    for e in range(len(below)):
        for k in range(SAMPLES + 1):
            curve(x, edges[below[e]], polynomials, κ, k / SAMPLES, there)
            start[e, k] = C[0]
    q, dC, s = np.empty((size, 2)), np.empty((size, 2)), np.empty(size)
    for a in range(len(above)):
        for k in range(len(gauss)):
            shape(polynomials, gauss[k], M)
            place(x, edges[above[a]], M, Y)
            meridian(κ, here)
            number, t, inside = closest(x, sides, κ, p, start, there)
            curve(x, edges[below[number]], polynomials, κ, t, there)
            length = math.hypot(C[1, 0], C[1, 1])
            τ0, τ1 = C[1, 0] / length, C[1, 1] / length
            n0, n1 = τ1, -τ0
            g = n0 * (p[0] - C[0, 0]) + n1 * (p[1] - C[0, 1])
            gap[a, k] = g
            if not g < limit:
                continue
            dC[:] = 0.0
            for b in range(n):
                for i in range(3):
                    for l in range(2):
                        q[3 * b + i, l] = Dp[l, i] * M[0, b]
                        q[3 * (n + b) + i, l] = -D[l, i] * N[0, b]
                        dC[3 * (n + b) + i, l] = D[l, i] * N[1, b]
                        for j in range(3):
                            dC[3 * (n + b) + i, l] += H[l, i, j] * X[1, j] * N[0, b]
            q[size - 1, 0], q[size - 1, 1] = 0.0, turned[0] - turned_p[0] - 2.0 * math.pi
            dC[size - 1, 1] = -(turned[1] * X[1, 0] + turned[2] * X[1, 1])
            bend = n0 * C[2, 0] + n1 * C[2, 1]
            for b in range(size):
                gradient[count, b] = n0 * q[b, 0] + n1 * q[b, 1]
                s[b] = 0.0
                if inside:
                    across = n0 * dC[b, 0] + n1 * dC[b, 1]
                    s[b] = (q[b, 0] * C[1, 0] + q[b, 1] * C[1, 1] + g * across) / (length**2 - g * bend)
            for b in range(size):
                along = (τ0 * q[b, 0] + τ1 * q[b, 1]) / length
                across = n0 * dC[b, 0] + n1 * dC[b, 1]
                for c in range(size):
                    turning = n0 * dC[c, 0] + n1 * dC[c, 1] + bend * s[c]
                    hessian[count, b, c] = -along * turning - across * s[c]
            for b in range(n):
                for i in range(3):
                    for c in range(n):
                        for j in range(3):
                            own = n0 * Hp[0, i, j] + n1 * Hp[1, i, j]
                            other = n0 * H[0, i, j] + n1 * H[1, i, j]
                            hessian[count, 3 * b + i, 3 * c + j] += own * M[0, b] * M[0, c]
                            hessian[count, 3 * (n + b) + i, 3 * (n + c) + j] -= other * N[0, b] * N[0, c]
                    for at, value in (
                        (3 * b + i, -n1 * turned_p[1 + i] * M[0, b]),
                        (3 * (n + b) + i, n1 * turned[1 + i] * N[0, b]),
                    ):
                        hessian[count, at, size - 1] += value
                        hessian[count, size - 1, at] += value
            where[count, 0], where[count, 1], where[count, 2] = a, k, number
            count += 1
    return count
