"""Contact elements in compiled loops: what each of them does to the stations that it hangs on, and its stiffness."""

from typing import NamedTuple

import numpy as np

from coilset.model.core.contact.curve import STENCIL, Curve, point_on_curve, station_weight
from coilset.model.core.contact.gauge import gauge
from coilset.model.core.runtime.kernels import COMPILED, njit

PAIR = 6 * STENCIL  # displacements of the eight stations of a pair
FLAT = STENCIL + 1  # levels of a point's stations and of the seat
Room = tuple[np.ndarray, ...]  # a Contribution's arrays, in the order of its attributes


class Bedding(NamedTuple):
    """What presses the points of a wire apart from another coil.

    Attributes:
        weights: of the points' four stations, shape (points, 4).
        element: of the points, shape (points,).
        element_dofs: degrees of freedom of all elements, shape (elements, 12).
        stiffness: of the points, N/mm, shape (points,).
        onset: distance over which contact sets in, mm.
        outward, table: as in `search.Points`.
    """

    weights: np.ndarray
    element: np.ndarray
    element_dofs: np.ndarray
    stiffness: np.ndarray
    onset: float
    outward: np.ndarray
    table: np.ndarray


class Pressed(NamedTuple):
    """Pairs in contact.

    Attributes:
        pair, where: as in `search.Locations`, shapes (m, 3) and (m, 2).
        offset: by which they are pressed beyond their penetration, shape (m,), mm.
        p: positions of all points, shape (points, 3), mm.
    """

    pair: np.ndarray
    where: np.ndarray
    offset: np.ndarray
    p: np.ndarray


class FlatSeat(NamedTuple):
    """A flat seat that moves along the axis only.

    Attributes:
        stations, weights: of all points, shape (m, 4).
        numbers: degrees of freedom of all points, shape (m, 5).
        side: 1 where the wire is above it, else −1.
        reach, offset, stiffness, onset, tip, tip_spring, slack: of the Seat.
    """

    stations: np.ndarray
    weights: np.ndarray
    numbers: np.ndarray
    side: float
    reach: np.ndarray
    offset: np.ndarray
    stiffness: np.ndarray
    onset: float
    tip: int
    tip_spring: float
    slack: float


@njit(**COMPILED)
def one_sided_at(g: float, c: float, onset: float) -> tuple[float, float]:
    """As `base.one_sided`, of one element."""
    within = min(max(-g, 0.0), 2.0 * onset)
    return c * (within**2 / (4.0 * onset) + max(-g - 2.0 * onset, 0.0)), c * within / (2.0 * onset)


@njit(**COMPILED)
def extent_of_contact(
    pressure: np.ndarray, onset_force: np.ndarray, part: float, penetration: np.ndarray
) -> tuple[int, float]:
    """How many elements press by more than a part of their onset force, and the maximum penetration, at least 0, mm."""
    closed, deepest = 0, 0.0
    for m in range(len(pressure)):
        closed += pressure[m] > part * onset_force[m]
        deepest = max(deepest, penetration[m])
    return closed, deepest


@njit(**COMPILED)
def coil_elements(curve: Curve, bedding: Bedding, pressed: Pressed, room: Room) -> None:
    """Write what the pairs do to the stations.

    With q = Σ a_m x_m from the other coil to the point, d = |q|, n = q/d, P = (1 − n nᵀ)/d and a′ = ∂a/∂ξ the gap
    g(u, ξ) = d − r_p − r(ξ) has

        g_u = a n,   g_uξ = a′ n − a P c′,   g_ξξ = c′ P c′ − n c″ − r″,   g_uu = a aᵀ P − g_uξ g_uξᵀ / g_ξξ,

    the last with ξ eliminated by g_ξ = 0; at the wire's end ξ stays and the last term falls away. A pressure f with the
    stiffness c gives the forces −f g_u and the stiffness

        c g_u g_uᵀ − f g_uu = a aᵀ (c n nᵀ − f P) + f g_uξ g_uξᵀ / g_ξξ.

    Of wire that is not round, d is its gauge N(q), n = ∇N and P = ∇²N (`coilset.model.core.contact.gauge`).

    Args:
        curve: the centre line.
        bedding: of the points.
        pressed: the pairs.
        room: written, see Contribution.room.
    """
    y, _, first, cubic = curve
    weights, element, element_dofs, stiffness, onset, outward, table = bedding
    pair, where, offset, p = pressed
    dofs, forces, k, pressure, penetration, point, onset_force = room
    count, size, half = len(pair), 2 * STENCIL, 3 * STENCIL
    c, dc, ddc = np.empty(4), np.empty(4), np.empty(4)
    n, a, da, P, Pc, mixed = np.empty(3), np.zeros(size), np.zeros(size), np.empty((3, 3)), np.empty(3), np.empty(PAIR)
    spread = np.empty((3, PAIR))  # rows of aᵀ (c n nᵀ − f P)
    for m in range(count):
        i, e, t = pair[m, 0], pair[m, 1], where[m, 0]
        pressure[m], hardness = one_sided_at(where[m, 1] - offset[m], stiffness[i], onset)
        penetration[m], point[m], onset_force[m] = -where[m, 1], i, stiffness[i] * onset
        for s in range(half):
            dofs[m, s], dofs[m, half + s] = element_dofs[element[i], s], element_dofs[e, s]
        point_on_curve(y, first, cubic, e, t, c, 0)
        point_on_curve(y, first, cubic, e, t, dc, 1)
        point_on_curve(y, first, cubic, e, t, ddc, 2)
        d = np.sqrt((p[i, 0] - c[0]) ** 2 + (p[i, 1] - c[1]) ** 2 + (p[i, 2] - c[2]) ** 2)
        for l in range(3):
            n[l] = (p[i, l] - c[l]) / d
        for s in range(STENCIL):
            a[s] = weights[i, s]
            a[STENCIL + s] = -station_weight(cubic[e, s], t, 0)
            da[STENCIL + s] = -station_weight(cubic[e, s], t, 1)
        second = -ddc[3]
        for l in range(3):
            for o in range(3):
                P[l, o] = ((1.0 if l == o else 0.0) - n[l] * n[o]) / d
        if len(table):
            _, n[0], n[1], n[2], P[0, 0], P[0, 1], P[0, 2], P[1, 1], P[1, 2], P[2, 2] = gauge(
                p[i, 0] - c[0], p[i, 1] - c[1], p[i, 2] - c[2], outward[i, 0], outward[i, 1], table
            )
            P[1, 0], P[2, 0], P[2, 1] = P[0, 1], P[0, 2], P[1, 2]
        for l in range(3):
            Pc[l] = 0.0
            for o in range(3):
                Pc[l] += P[l, o] * dc[o]
            second += dc[l] * Pc[l] - n[l] * ddc[l]
        eliminated = pressure[m] / second if pair[m, 2] and second > 0.0 else 0.0
        for s in range(size):
            for l in range(3):
                forces[m, 3 * s + l] = -pressure[m] * a[s] * n[l]
                mixed[3 * s + l] = da[s] * n[l] - a[s] * Pc[l]
                for o in range(3):
                    spread[o, 3 * s + l] = a[s] * (hardness * n[o] * n[l] - pressure[m] * P[o, l])
        for s in range(size):
            for o in range(3):
                row, from_spread, from_mixed = k[m, 3 * s + o], spread[o], eliminated * mixed[3 * s + o]
                for j in range(PAIR):
                    row[j] = a[s] * from_spread[j] + from_mixed * mixed[j]


@njit(**COMPILED)
def flat_seat_elements(points: np.ndarray, x: np.ndarray, level: float, seat: FlatSeat, room: Room) -> int:
    """The points that press on a flat seat which moves along the axis only, and the tip.

    Args:
        points: numbers of the points that are sought for.
        x: positions of the stations, shape (n, 3), mm.
        level: of the seat, mm.
        seat: the seat.
        room: written for the b points that press, see Contribution.room.

    Returns:
        b.
    """
    stations, weights, numbers, side, reach, offset, stiffness, onset, tip, tip_spring, slack = seat
    dofs, forces, k, pressure, penetration, point, onset_force = room
    grad, e = np.empty(FLAT), 0
    for i in points:
        gap = -level
        for a in range(STENCIL):
            gap += weights[i, a] * x[stations[i, a], 2]
        gap = side * gap - reach[i]
        g = gap - offset[i]
        if g >= 0.0 and i != tip:
            continue
        if i != tip:
            force, c = one_sided_at(g, stiffness[i], onset)
        elif g > 0.0:
            c = tip_spring if g >= slack else 0.0
            force = -c * max(g - slack, 0.0)
        else:
            c = stiffness[i]
            force = -c * g
        point[e], pressure[e], penetration[e], onset_force[e] = i, max(force, 0.0), -gap, stiffness[i] * onset
        for a in range(FLAT):
            dofs[e, a] = numbers[i, a]
            grad[a] = side * (weights[i, a] if a < STENCIL else -1.0)
            forces[e, a] = -force * grad[a]
        for a in range(FLAT):
            for b in range(FLAT):
                k[e, a, b] = c * grad[a] * grad[b]
        e += 1
    return e
