"""Contact search: the closest points of the other coils for points of the wire, in linear time."""

import math
from typing import NamedTuple

import numpy as np

from coilset.model.core.contact.curve import Curve, element_polynomials, points_on_wire
from coilset.model.core.contact.gauge import gauge
from coilset.model.core.runtime.kernels import njit

LEAST_TURNS_BETWEEN = 0.5  # turns between two points of the wire that may touch
PLACES, TURNS_TO_NEXT = 6, 1.5  # of locations, see `place`; turns up to which a location is on the next coil
MOST_CELLS_PER_STATION = 16  # cells of the grid
LEAST_POST_DISTANCE = 0.5  # distance between the sorted stations, in wire radii
# Of ξ. A step of Newton's method squares the error, so that after one as short as this only rounding is left.
LAST_STEP, ROUNDING = 1e-8, 1e-14

Shape = tuple[float, float, np.ndarray]  # of a point: its direction outwards and the table of `gauge`


@njit(cache=True)
def grid(x: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray, float, np.ndarray, np.ndarray]:
    """Sort stations into cubes: box corner, cubes per axis, cube size, first station of a cube, next of a station."""
    n = len(x)
    low, high = x[0].copy(), x[0].copy()
    for i in range(n):
        for k in range(3):
            low[k], high[k] = min(low[k], x[i, k]), max(high[k], x[i, k])
    count = np.empty(3, np.int64)
    size = max(size, 1e-4 * max(high[0] - low[0], high[1] - low[1], high[2] - low[2]))
    while True:
        for k in range(3):
            count[k] = int((high[k] - low[k]) / size) + 1
        if count[0] * count[1] * count[2] <= MOST_CELLS_PER_STATION * n:
            break
        size *= 1.3
    head, after = np.full(count[0] * count[1] * count[2], -1), np.empty(n, np.int64)
    for i in range(n):
        cube = 0
        for k in range(3):
            cube = cube * count[k] + int((x[i, k] - low[k]) / size)
        after[i], head[cube] = head[cube], i
    return low, count, size, head, after


@njit(cache=True)
def place(turns: float) -> int:
    """Where a location `turns` after a point is: on the coil before it, after it, or beyond these, before or after.

    A point touches coils beyond the next ones where these lie in each other, as those of barrels do at block. There it
    may lie in the groove between two that follow each other: those of even and of odd numbers have a place each.
    """
    side, coil = 1 if turns > 0.0 else 0, int(abs(turns) + 0.5)
    return side + (2 + 2 * (coil % 2) if abs(turns) > TURNS_TO_NEXT else 0)


@njit(cache=True)
def post_stride(widest: float, longest: float) -> int:
    """How many stations the posts are apart, with the wire's largest radius and the longest element, mm."""
    return max(1, int(LEAST_POST_DISTANCE * widest / longest))


@njit(cache=True)
def distance2(p: np.ndarray, x: np.ndarray, j: int) -> float:
    """Square of the distance of the point `p` from station `j`."""
    return (p[0] - x[j, 0]) ** 2 + (p[1] - x[j, 1]) ** 2 + (p[2] - x[j, 2]) ** 2


@njit(cache=True, error_model="numpy")
def slope_and_curvature(p: np.ndarray, curve: np.ndarray, xi: float, shape: Shape) -> tuple[float, float]:
    """First and second derivative by ξ of the gap |p − c(ξ)| − r(ξ) on an element with the polynomials `curve`."""
    if len(shape[2]):
        return gauge_slope_and_curvature(p, curve, xi, shape)
    distance2 = along = speed2 = bend = 0.0
    for k in range(3):
        a, b, c, d = curve[0, k], curve[1, k], curve[2, k], curve[3, k]
        q = p[k] - (a + xi * (b + xi * (c + xi * d)))
        slope, curvature = b + xi * (2.0 * c + xi * 3.0 * d), 2.0 * c + 6.0 * d * xi
        distance2 += q * q
        along += q * slope
        speed2 += slope * slope
        bend += q * curvature
    inverse = 1.0 / math.sqrt(distance2)
    along, bend = along * inverse, bend * inverse
    thinner, faster = curve[1, 3] + xi * (2.0 * curve[2, 3] + xi * 3.0 * curve[3, 3]), 2.0 * curve[2, 3]
    return -along - thinner, (speed2 - along**2) * inverse - bend - (faster + 6.0 * curve[3, 3] * xi)


@njit(cache=True, error_model="numpy")
def gauge_slope_and_curvature(p: np.ndarray, curve: np.ndarray, xi: float, shape: Shape) -> tuple[float, float]:
    """As `slope_and_curvature`, of the gap N(p − c(ξ)) − r(ξ) of a wire that is not round."""
    q, d, dd = np.empty(3), np.empty(4), np.empty(4)
    for k in range(4):
        a, b, c, e = curve[0, k], curve[1, k], curve[2, k], curve[3, k]
        d[k], dd[k] = b + xi * (2.0 * c + xi * 3.0 * e), 2.0 * c + 6.0 * e * xi
        if k < 3:
            q[k] = p[k] - (a + xi * (b + xi * (c + xi * e)))
    _, nx, ny, nz, xx, xy, xz, yy, yz, zz = gauge(q[0], q[1], q[2], *shape)
    squares = xx * d[0] * d[0] + yy * d[1] * d[1] + zz * d[2] * d[2]
    squares += 2.0 * (xy * d[0] * d[1] + xz * d[0] * d[2] + yz * d[1] * d[2])
    slope, bend = nx * d[0] + ny * d[1] + nz * d[2], nx * dd[0] + ny * dd[1] + nz * dd[2]
    return -slope - d[3], squares - bend - dd[3]


@njit(cache=True, error_model="numpy")
def gap_at(p: np.ndarray, curve: np.ndarray, xi: float, shape: Shape) -> float:
    """|p − c(ξ)| − r(ξ) on an element, or N(p − c(ξ)) − r(ξ) of a wire that is not round."""
    if len(shape[2]):
        q = np.empty(3)
        for k in range(3):
            q[k] = p[k] - (curve[0, k] + xi * (curve[1, k] + xi * (curve[2, k] + xi * curve[3, k])))
        radius = curve[0, 3] + xi * (curve[1, 3] + xi * (curve[2, 3] + xi * curve[3, 3]))
        return gauge(q[0], q[1], q[2], *shape)[0] - radius
    square = 0.0
    for k in range(3):
        square += (p[k] - (curve[0, k] + xi * (curve[1, k] + xi * (curve[2, k] + xi * curve[3, k])))) ** 2
    return math.sqrt(square) - (curve[0, 3] + xi * (curve[1, 3] + xi * (curve[2, 3] + xi * curve[3, 3])))


@njit(cache=True, error_model="numpy")
def station_slope(p: np.ndarray, curves: np.ndarray, j: int, shape: Shape) -> float:
    """First derivative by ξ of the gap at station `j`; `curves` are the polynomials of all elements."""
    e = min(j, len(curves) - 1)
    return slope_and_curvature(p, curves[e], float(j - e), shape)[0]


@njit(cache=True, error_model="numpy")
def closest(p: np.ndarray, curves: np.ndarray, j: int, begin: int, end: int, shape: Shape) -> tuple[int, float, bool]:
    """Closest point to `p` along the wire, sought from station `j` between the stations `begin` and `end`.

    Returns:
        Element, ξ, and whether it is inside the wire; element −1 if it is beyond `begin` or `end`, inside the wire.
    """
    last, slope = len(curves), station_slope(p, curves, j, shape)
    direction = -1 if slope > 0.0 else 1
    near, stride, ahead = j, 1, slope
    while True:  # in growing steps until the gap no longer decreases
        far = min(max(near + direction * stride, begin), end)
        if far == near:
            if 0 < near < last:
                return -1, 0.0, False
            return (0, 0.0, False) if near == 0 else (last - 1, 1.0, False)
        ahead = station_slope(p, curves, far, shape)
        if ahead * direction >= 0.0:
            break
        near, slope, stride = far, ahead, 2 * stride
    while abs(far - near) > 1:
        middle = (near + far) // 2
        found = station_slope(p, curves, middle, shape)
        if found * direction < 0.0:
            near, slope = middle, found
        else:
            far, ahead = middle, found
    # from where a straight line through both stations' slopes vanishes
    share = slope / (slope - ahead) if slope != ahead else 0.5
    return min(near, far), root(p, curves[min(near, far)], share if near < far else 1.0 - share, shape), True


@njit(cache=True, error_model="numpy")
def root(p: np.ndarray, curve: np.ndarray, xi: float, shape: Shape) -> float:
    """Where the slope of the gap changes its sign on an element: Newton's method from `xi`, within a bracket."""
    low, high = 0.0, 1.0
    for _ in range(60):
        slope, curvature = slope_and_curvature(p, curve, xi, shape)
        if slope > 0.0:
            high = xi
        else:
            low = xi
        newton = xi - slope / curvature if curvature > 0.0 else math.inf
        inside = low <= newton <= high
        new = newton if inside else 0.5 * (low + high)
        moved, xi = abs(new - xi), new
        if moved < (LAST_STEP if inside else ROUNDING):
            break
    return xi


@njit(cache=True)
def find_posts(elements: np.ndarray, last: int, stride: int) -> tuple[np.ndarray, np.ndarray]:
    """Every so manieth station along the wire, of those where the curve's slope is known.

    Args:
        elements: ranges of elements whose four stations are known, shape (k, 2).
        last: number of elements.
        stride: distance of the posts, in stations.

    Returns:
        Numbers of the posts, ascending, and first and last station of the range in which each lies, shape (posts, 2).
    """
    most = 0
    for part in range(len(elements)):
        most += (elements[part, 1] - elements[part, 0]) // stride + 2
    posts, ranges, count = np.empty(most, np.int64), np.empty((most, 2), np.int64), 0
    for part in range(len(elements)):
        begin, stop = elements[part, 0], elements[part, 1]
        end = last if stop == last else stop - 1  # the slope at station `stop` is that of the element behind it
        for k in range(-(-begin // stride), (last - 1) // stride + 2):
            post = min(k * stride, last)
            if post > end:
                break
            posts[count], ranges[count, 0], ranges[count, 1] = post, begin, end
            count += 1
    return posts[:count], ranges[:count]


@njit(cache=True)
def longest_element(y: np.ndarray) -> float:
    """Greatest distance of neighbouring stations, mm; `y` of shape (n, 3 or more)."""
    longest = 0.0
    for i in range(1, len(y)):
        longest = max(longest, distance2(y[i], y, i - 1))
    return math.sqrt(longest)


class Points(NamedTuple):
    """Points of the wire.

    Attributes:
        weights, stations: shape (m, 4).
        radius, turns: shape (m,), radius in mm.
        overlap: what counts as touching though the bodies overlap, at each `place`, shape (m, PLACES), mm.
        outward: horizontal unit vectors away from the coil's axis, shape (m, 2); table: of `gauge`, empty if round.
    """

    weights: np.ndarray
    stations: np.ndarray
    radius: np.ndarray
    turns: np.ndarray
    overlap: np.ndarray
    outward: np.ndarray
    table: np.ndarray


class Searched(NamedTuple):
    """The part of a wire in which is sought.

    Attributes:
        elements: its ranges, shape (k, 2).
        widest, longest: largest radius and distance of neighbouring stations along the wire, mm.
    """

    elements: np.ndarray
    widest: float
    longest: float


class Locations(NamedTuple):
    """Locations where points of the wire are near another coil.

    Attributes:
        p: positions of the points that are sought for, shape (m, 3), mm.
        pair: point, element and whether the location is inside the wire, shape (capacity, 3).
        where: ξ and gap, shape (capacity, 2).
    """

    p: np.ndarray
    pair: np.ndarray
    where: np.ndarray


@njit(cache=True, error_model="numpy")
def near_locations(
    active: np.ndarray, points: Points, curve: Curve, margin: float, searched: Searched, out: Locations
) -> int:
    """All locations where a point of the wire and another coil are closer than `margin`.

    Args:
        active: numbers of the points that are sought for, ascending.
        points: all points.
        curve: the centre line.
        margin: maximum gap, mm.
        searched: the part of the wire in which is sought.
        out: written.

    Returns:
        Number of locations; more than the capacity of `out` if its arrays were too short.
    """
    weights, stations, radius, turns, overlap, outward, table = points
    y, station_turns, first, cubic = curve
    elements, widest, longest = searched
    p, pair, where = out
    # if elements are much shorter than the wire diameter, only every so many stations are sorted: the posts
    stride = post_stride(widest, longest)
    posts, ranges = find_posts(elements, len(first), stride)
    if not len(posts):
        return 0
    points_on_wire(active, weights, stations, y, p)
    x = y[posts]
    # the post nearest to a location is at most half a stride from it
    reach = 2.0 * widest + margin + 0.6 * stride * longest
    low, count, size, head, after = grid(x[:, :3], reach)
    curves, cube, found = element_polynomials(y, first, cubic, elements), np.empty(3, np.int64), 0
    for i in active:
        shape = outward[i, 0], outward[i, 1], table
        for k in range(3):
            cube[k] = math.floor((p[i, k] - low[k]) / size)
        for a in range(max(cube[0] - 1, 0), min(cube[0] + 2, count[0])):
            for b in range(max(cube[1] - 1, 0), min(cube[1] + 2, count[1])):
                for c in range(max(cube[2] - 1, 0), min(cube[2] + 2, count[2])):
                    j = head[(a * count[1] + b) * count[2] + c]
                    while j >= 0:
                        here, now = distance2(p[i], x, j), j
                        j = after[j]
                        if here > reach**2 or abs(station_turns[posts[now]] - turns[i]) < LEAST_TURNS_BETWEEN:
                            continue
                        begin, end = ranges[now, 0], ranges[now, 1]
                        if now > 0 and posts[now - 1] >= begin and distance2(p[i], x, now - 1) < here:
                            continue
                        if now + 1 < len(posts) and posts[now + 1] <= end and distance2(p[i], x, now + 1) <= here:
                            continue
                        e, xi, inside = closest(p[i], curves, posts[now], begin, end, shape)
                        if e < 0:
                            continue
                        turn = station_turns[e] + xi * (station_turns[e + 1] - station_turns[e])
                        if abs(turn - turns[i]) < LEAST_TURNS_BETWEEN:
                            continue
                        gap = gap_at(p[i], curves[e], xi, shape) - radius[i] - overlap[i, place(turn - turns[i])]
                        if gap >= margin:
                            continue
                        if found < len(pair):
                            pair[found, 0], pair[found, 1], pair[found, 2] = i, e, inside
                            where[found, 0], where[found, 1] = xi, gap
                        found += 1
    return found
