"""Wire that is not round bears on faces: the line of contact has a width, and carries a moment about the wire.

A section that has turned about the wire by the slope σ of its lateral direction, outwards, has its material m outwards
from the centre line raised by m σ. Where two outlines touch along a flat from L to U outwards, the bedding is that of
Simpson's points L, (L + U)/2, U with 1/6, 2/3 and 1/6 of its stiffness c: while all of the width w is pressed, the
moment is c w²/12 times the difference of the slopes, as of a bedding spread over the width, and a face that stands
on its edge bears there. Outlines that touch in a point have L = U.

The gap at such a point between the coils u above and l below is

    g = N(q) + m σ_u − (m + a) σ_l,      a = q × ∇N(q) = ρ κ′(α),

with the gauge N of the distance q between the centre lines (gauge.py), and m the arm of the touching point about the
upper one, c × ∇N; about the lower it is m + a. L and U follow from α, as N does. On a seat g = ±(z + m σ − level) − h.

The slope is that of a unit vector s of each station, horizontal at first, which turns by θ in a step,

    σ = s_z + (θ × s)_z + ½ (θ × (θ × s))_z,

so that it does not drift. Of the arms, a changes the direction of the force as the faces tilt; changes of m with α, and
second derivatives of σ and a, are left out. The penetration of an element is the mean over its forces, so that half of
its product with the pressure is the energy.
"""

import numpy as np

from coilset.meshes.sections.boundary import Boundary
from coilset.model.core.contact.base import SEAT_DOFS, Contribution, Memory, TrialPositions, one_sided
from coilset.model.core.contact.coils import Coils, outwards
from coilset.model.core.contact.curve import (
    POINTS_PER_ELEMENT,
    STENCIL,
    Curve,
    WirePoints,
    point_on_curve,
    station_weight,
)
from coilset.model.core.contact.elements import PAIR, Bedding, Pressed, coil_elements, one_sided_at
from coilset.model.core.contact.gauge import gauge
from coilset.model.core.contact.seat import Seat
from coilset.model.core.runtime.kernels import COMPILED, njit

DIRECTIONS = 720  # of half a turn, between which κ is a cubic spline
CORNERS = 16_384  # of the section's polygon from which κ is computed: κ″ of a circle is met within 1e-3
SIMPSON = np.array([1.0, 4.0, 1.0]) / 6.0
LEVEL_OF_HEIGHT = 1e-6  # of half the height: points of an outline at its top to within this make its flat
NARROW = 1e-2  # of half the height: what is narrower is the top of a curve
TURNED = 2 * PAIR  # displacements and rotations of the eight stations of a pair


def gauge_table(section: Boundary) -> np.ndarray:
    """The table of a section for `gauge`, shape (DIRECTIONS, 4).

    Args:
        section: y towards the coil's axis, z upwards, in half the wire's height.
    """
    from scipy.interpolate import CubicSpline  # takes a third of a second, and round wire needs none

    corners = section.difference(CORNERS) * [-1.0, 1.0]
    corners = corners[np.argsort(np.arctan2(corners[:, 1], corners[:, 0]))]
    sides = np.roll(corners, -1, axis=0) - corners
    α = np.pi * np.arange(DIRECTIONS + 1) / DIRECTIONS
    ray, angle = np.stack([np.cos(α), np.sin(α)], axis=1), np.arctan2(corners[:, 1], corners[:, 0])
    k = np.searchsorted(angle, α, side="right") - 1  # the side that the ray crosses
    κ = 2.0 * _cross(ray, sides[k]) / _cross(corners[k], sides[k])
    κ[-1] = κ[0]
    return np.ascontiguousarray(CubicSpline(α, κ, bc_type="periodic").c.T)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


class Tilts:
    """Slopes of a wire's sections about the wire.

    Args:
        points: WirePoints.
        stations: stress-free positions, shape (n, 3), mm.

    Attributes:
        start: lateral unit vectors of the stations, outwards, shape (n, 3).
        first: number of the first rotation among the degrees of freedom.
    """

    def __init__(self, points: WirePoints, stations: np.ndarray) -> None:
        self.start = np.column_stack([outwards(points, stations)[::POINTS_PER_ELEMENT], np.zeros(len(stations))])
        self.first = 3 * len(stations) + 2 * SEAT_DOFS

    @staticmethod
    def at(memory: Memory, trial: TrialPositions) -> tuple[np.ndarray, np.ndarray]:
        """σ of the stations, shape (n,), and ∂σ/∂θ, shape (n, 3); the memory's `side` is turned."""
        s, θ = memory.committed("side"), trial.rotations
        if θ is None:
            raise ValueError("faces need the stations' rotations")
        once = np.cross(θ, s)
        memory["side"] = s + once + 0.5 * np.cross(θ, once)
        slope = 0.5 * (θ[:, 2:] * s - 2.0 * s[:, 2:] * θ)
        slope += np.column_stack([s[:, 1], -s[:, 0], 0.5 * np.sum(θ * s, axis=1)])
        return memory["side"][:, 2], slope


def flat(section: Boundary, normal: np.ndarray) -> np.ndarray:
    """How far the flat that faces `normal` reaches across it, L and U about the centre line; a point of no flat.

    Args:
        section: outwards and upwards, any unit.
        normal: unit vector, shape (2,); the flat is measured along (n_z, −n_o).
    """
    depth, along = section.polygon @ normal, section.polygon @ np.array([normal[1], -normal[0]])
    top = along[depth > depth.max() - LEVEL_OF_HEIGHT]
    low, high = top.min(), top.max()
    return np.array([low, high]) if high - low > NARROW else np.full(2, 0.5 * (low + high))


def arms_table(section: Boundary) -> np.ndarray:
    """L and U on the directions of a `gauge_table`, in half the wire's height, shape (DIRECTIONS + 1, 2).

    Args:
        section: as in `gauge_table`.
    """
    table, own = gauge_table(section), section.scaled(-1.0, 1.0)
    arms = np.empty((DIRECTIONS + 1, 2))
    for k, α in enumerate(np.pi * np.arange(DIRECTIONS + 1) / DIRECTIONS):
        κ, slope = (table[k, 3], table[k, 2]) if k < DIRECTIONS else (table[0, 3], table[0, 2])
        ray = np.array([np.cos(α), np.sin(α)])
        gradient = κ * ray + slope * np.array([-ray[1], ray[0]])
        size = np.hypot(*gradient)
        n = gradient / size
        upper, lower = -flat(own, -n)[::-1], flat(own, n)
        shift = 2.0 / κ * (ray @ np.array([n[1], -n[0]]))
        low, high = max(upper[0], lower[0] - shift), min(upper[1], lower[1] - shift)
        arms[k] = size * (np.array([low, high]) if low < high else 0.5 * (low + high))
    return arms


def seat_arms(section: Boundary, distance: np.ndarray, radius: np.ndarray, side: float) -> np.ndarray:
    """Simpson's points of the flat on a seat at each point of the wire, outwards, shape (m, 3), mm.

    Args:
        section: as in `gauge_table`.
        distance, radius: from the centre line to the surface that meets the seat, and half the wire's height, mm.
        side: 1 of the bottom seat, −1 of the top.
    """
    own, down, found = section.scaled(-1.0, 1.0), np.array([0.0, -side]), np.empty((len(radius), 2))
    whole = flat(own, down)
    for i, level in enumerate(distance / radius):
        left = own.cut(float(level), -down)
        found[i] = whole if left is own else flat(left, down)
    low, high = (-side * found * radius[:, None]).T
    return np.column_stack([low, 0.5 * (low + high), high])


class FacedCoils(Coils):
    """Coils that bear on faces; arguments as in `Coils`."""

    needs_rotations = True

    def __init__(
        self, points: WirePoints, stations: np.ndarray, bedding: float, onset: float, section: Boundary
    ) -> None:
        super().__init__(points, stations, bedding, onset, gauge_table(section))
        self._tilts, arms = Tilts(points, stations), arms_table(section)
        self._arms, self._longest = arms, float(np.abs(arms).max() + 2.0) * float(points.line.radius.max())
        first = points.stations[:, 0]
        rows = {"multiplier_offset": first, "side": np.arange(len(stations))}
        self.memory = Memory(rows, multiplier_offset=np.zeros_like(self.overlap), side=self._tilts.start)
        self.multiplier_offset = self.memory["multiplier_offset"]

    @property
    def reach(self) -> float:
        """See Contact."""
        return super().reach + self._skin

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Forces along the connection of closest points, and moments, where faces touch."""
        σ, slope = Tilts.at(self.memory, trial)
        lift = min(2.0 * self._longest * float(np.abs(σ).max()), self._skin)
        pressed = self.search(trial, lift)
        self._last = trial, pressed
        count = len(pressed.pair)
        flat = Contribution.room(count, PAIR)
        room = Contribution.room(count, TURNED)
        coil_elements(self._curve, self._bedding, pressed, flat)
        faced_elements(self._curve, self._bedding, pressed, (σ, slope, self._arms, self._tilts.first), flat, room)
        return Contribution(*room)


class FacedSeat(Seat):
    """A flat seat that moves along the axis only, on which the wire bears on a face; arguments as in `Seat`.

    Args:
        arms: of `seat_arms`.
    """

    needs_rotations = True

    def __init__(
        self,
        end: str,
        points: WirePoints,
        distance: np.ndarray,
        stations: np.ndarray,
        seats: np.ndarray,
        bedding: float,
        onset: float,
        arms: np.ndarray,
        stepped: float = 0.0,
    ) -> None:
        super().__init__(end, points, distance, stations, seats, bedding, onset, 0.0, stepped)
        self._tilts, self._arms = Tilts(points, stations), self.side * arms
        rows = {"multiplier_offset": points.stations[:, 0], "side": np.arange(len(stations))}
        self.memory = Memory(rows, multiplier_offset=np.zeros(len(points)), side=self._tilts.start)
        self.multiplier_offset = self.memory["multiplier_offset"]
        rotations = 3 * points.stations[:, :, None] + np.arange(3) + self._tilts.first
        self.dofs = np.hstack([self.dofs[:, :STENCIL], rotations.reshape(len(points), -1), self.dofs[:, STENCIL:]])

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """See Contact: at Simpson's points of each face that touches, and at the tip on its spring."""
        σ, slope = Tilts.at(self.memory, trial)
        points = trial.points(self.points)
        p, offset = self.points.at(trial.x, points), self.multiplier_offset[points]
        gap = self.gaps(p, trial.seats, points)
        g = (gap - offset)[:, None] + self._arms[points] * self.points.at(σ, points)[:, None]
        found = np.flatnonzero((g.min(axis=1) < 0.0) | (points == self.tip))
        i, g, gap = points[found], g[found], gap[found]
        share = self.stiffness[i][:, None] * SIMPSON
        f, c = one_sided(g, share, self.onset)
        tip = i == self.tip  # bears from the first touch
        f[tip], c[tip] = -share[tip] * np.minimum(g[tip], 0.0), share[tip] * (g[tip] < 0.0)
        pressure, arms = f.sum(axis=1), self._arms[i]
        force, hardness = pressure.copy(), c.sum(axis=1)
        taut = tip & (pressure <= 0.0)
        away = (gap - self.multiplier_offset[i])[taut] - self.slack
        force[taut], hardness[taut] = -self.tip_spring * np.maximum(away, 0.0), self.tip_spring * (away >= 0.0)
        weights, m = self.points.weights[i], len(i)
        J = np.zeros((m, 2, self.dofs.shape[1]))  # of the gap and the slope
        J[:, 0, :STENCIL], J[:, 0, -1] = self.side * weights, -self.side
        turning = weights[:, :, None] * slope[self.points.stations[i]]
        J[:, 1, STENCIL:-1] = turning.reshape(m, -1)
        moment, mixed, bending = (f * arms).sum(axis=1), (c * arms).sum(axis=1), (c * arms**2).sum(axis=1)
        k = np.stack([hardness, mixed, mixed, bending], axis=1).reshape(m, 2, 2)
        forces = -np.einsum("mk,mkv->mv", np.stack([force, moment], axis=1), J)
        onset_force, deep = self.stiffness[i] * self.onset, -(g + self.multiplier_offset[i][:, None])
        weighed = (f * deep).sum(axis=1) / np.where(pressure > 0.0, pressure, 1.0)
        penetration = np.where(pressure > 0.0, weighed, -gap)
        return Contribution(self.dofs[i], forces, np.swapaxes(J, 1, 2) @ k @ J, pressure, penetration, i, onset_force)


@njit(**COMPILED)
def faced_elements(
    curve: Curve,
    bedding: Bedding,
    pressed: Pressed,
    tilts: tuple[np.ndarray, np.ndarray, np.ndarray, int],
    flat: tuple[np.ndarray, ...],
    room: tuple[np.ndarray, ...],
) -> None:
    """Write what the pairs do to the stations, with their faces.

    Args:
        curve, bedding, pressed: as in `coil_elements`.
        tilts: σ and ∂σ/∂θ of the stations, the table of arms, and the number of the first rotation.
        flat: what `coil_elements` has written of the pairs.
        room: written, see Contribution.room.
    """
    y, _, first, cubic = curve
    weights, element, element_dofs, stiffness, onset, outward, table = bedding
    pair, where, offset, p = pressed
    σ, slope, arms, first_rotation = tilts
    dofs, forces, k, pressure, penetration, point, onset_force = room
    c, half, size = np.empty(4), PAIR // 2, len(table)
    G, row, part = np.zeros((3, 5)), np.empty(TURNED, np.int64), np.empty(TURNED)
    f, stiff, force, local = np.empty(3), np.empty(3), np.empty(5), np.empty((5, 5))
    for m in range(len(pair)):
        i, e, t = pair[m, 0], pair[m, 1], where[m, 0]
        point[m], onset_force[m] = flat[5][m], flat[6][m]
        point_on_curve(y, first, cubic, e, t, c, 0)
        ox, oy = outward[i, 0], outward[i, 1]
        qx, qy, qz = p[i, 0] - c[0], p[i, 1] - c[1], p[i, 2] - c[2]
        up = 1.0 if qz >= 0.0 else -1.0  # whether the point is on the upper coil
        r, z = up * (qx * ox + qy * oy), up * qz
        ρ, α = np.hypot(r, z), np.arctan2(z, r)
        s = min(int(α * size / np.pi), size - 1)
        u = α - s * np.pi / size
        bend, sag, κ1 = table[s, 0], table[s, 1], table[s, 2]
        κ1, κ2 = κ1 + u * (2.0 * sag + 3.0 * bend * u), 2.0 * sag + 6.0 * bend * u
        share, unit = u * size / np.pi, y[first[e], 3]
        low = unit * (arms[s, 0] + share * (arms[s + 1, 0] - arms[s, 0]))
        high = unit * (arms[s, 1] + share * (arms[s + 1, 1] - arms[s, 1]))
        aside = ρ * κ1
        ar, az = κ1 * r / ρ - κ2 * z / ρ, κ1 * z / ρ + κ2 * r / ρ  # ∇(ρ κ')
        N = gauge(qx, qy, qz, ox, oy, table)
        own = other = 0.0
        for a in range(STENCIL):
            w, v = weights[i, a], station_weight(cubic[e, a], t, 0)
            at, there = element_dofs[element[i], 3 * a] // 3, element_dofs[e, 3 * a] // 3
            own, other = own + w * σ[at], other + v * σ[there]
            for l in range(3):
                d, b = 3 * a + l, half + 3 * a + l
                row[d], part[d], row[b], part[b] = l, w, l, -v
                row[PAIR + d], part[PAIR + d] = 3, w * slope[at, l]
                row[PAIR + b], part[PAIR + b] = 4, v * slope[there, l]
        upper, lower = (own, other) if up > 0.0 else (other, own)
        force[:], local[:] = 0.0, 0.0
        pressure[m] = work = 0.0
        for j in range(3):
            arm = 0.5 * (j * high + (2 - j) * low)
            g = where[m, 1] - offset[m] + arm * upper - (arm + aside) * lower
            f[j], stiff[j] = one_sided_at(g, SIMPSON[j] * stiffness[i], onset)
            G[j, 0] = N[1] - up * lower * ar * ox
            G[j, 1] = N[2] - up * lower * ar * oy
            G[j, 2] = N[3] - up * lower * az
            G[j, 3], G[j, 4] = (arm, -arm - aside) if up > 0.0 else (-arm - aside, arm)
            pressure[m], work = pressure[m] + f[j], work - f[j] * (g + offset[m])
            for a in range(5):
                force[a] -= f[j] * G[j, a]
                for b in range(5):
                    local[a, b] += stiff[j] * G[j, a] * G[j, b]
        penetration[m] = work / pressure[m] if pressure[m] > 0.0 else flat[4][m]
        before, hardness = one_sided_at(where[m, 1] - offset[m], stiffness[i], onset)
        for a in range(3):  # what the pair without faces has
            force[a] += before * N[1 + a]
            for b in range(3):
                local[a, b] -= hardness * N[1 + a] * N[1 + b]
        for a in range(PAIR):
            dofs[m, a] = flat[0][m, a]
            dofs[m, PAIR + a] = first_rotation + flat[0][m, a]
        for a in range(TURNED):
            forces[m, a] = part[a] * force[row[a]] + (flat[1][m, a] if a < PAIR else 0.0)
            for b in range(TURNED):
                k[m, a, b] = part[a] * part[b] * local[row[a], row[b]]
        for a in range(PAIR):
            for b in range(PAIR):
                k[m, a, b] += flat[2][m, a, b]
