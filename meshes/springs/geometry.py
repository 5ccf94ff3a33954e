"""The geometry of a spring as functions of the turn."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from coilset.meshes.springs import functions
from coilset.meshes.springs.block import TOUCH, block_height
from coilset.meshes.springs.ends import OPEN, EndCoils
from coilset.meshes.springs.piecewise import PiecewisePolynomial
from coilset.meshes.springs.stations import ElementsPerTurn, stations
from coilset.model.core.base.errors import InputError

INTERVALS_PER_TURN = 64
SAME = 1e-9  # relative difference of a height from a bound that is rounding
STRAIGHT = 1e-9  # |c′ × c″| over |c′|² below which a wire has no normal


@dataclass(frozen=True, eq=False)
class Spring:
    """A wire wound round the z axis: mean radius, height and wire diameter as functions of the turn.

    The diameter of a wire that is not round is its height along the spring.

    The turn t counts from the bottom end, and the seats are the planes z = 0 and z = free length. The centre line is
    `c(t) = (r cos θ + x, r sin θ + y, z)` with `θ = phase + hand 2π t` and the offsets x, y of a curved axis. All
    lengths are in mm. Hooks and arms go on beyond the coil, below turn 0 and above the last turn, with the speed ds/dt
    of its ends.

    Args:
        radius: mean radius over the turn, a `PiecewisePolynomial` from 0 to the number of turns.
        height: height of the centre line over the turn, from any level.
        wire: wire diameter over the turn.
        hand: +1 right, −1 left.
        bottom: `EndCoils` at turn 0.
        top: `EndCoils` at the last turn.
        phase: polar angle of the first point, rad.
        measured_axis: fitted Axis of a measured spring in the coordinates of its file; None of a drawn one.
        section: Boundary of a wire that is not round, in half its height, y towards the coil's axis and z upwards;
            None of a round one.
        axis: offsets x and y of the coil's centre over the turn, or None.
        tails: the wire below turn 0 and above the last turn, a `Tail` or None each.
    """

    radius: PiecewisePolynomial
    height: PiecewisePolynomial
    wire: PiecewisePolynomial
    hand: int = 1
    bottom: EndCoils = OPEN
    top: EndCoils = OPEN
    phase: float = 0.0
    measured_axis: Any = None
    section: Any = None
    axis: tuple[PiecewisePolynomial, PiecewisePolynomial] | None = None
    tails: tuple[Any, Any] = (None, None)

    @property
    def turns(self) -> float:
        """Number of turns, end turns included."""
        return float(self.height.x[-1])

    @cached_property
    def slope(self) -> PiecewisePolynomial:
        """Slope of the mean radius, mm per turn."""
        return self.radius.derivative()

    @cached_property
    def _pitch(self) -> PiecewisePolynomial:
        return self.height.derivative()

    @cached_property
    def _planes(self) -> tuple[float, float]:
        """Levels of the seats in the coordinate of `height`: touching the outermost wire, or the ground surface."""
        t = self.breaks
        z, d = self.height(t), self.wire(t)
        bottom, top = self.bottom.tip_thickness, self.top.tip_thickness
        return (
            z[0] - (bottom - 0.5) * d[0] if bottom < 1 else np.min(z - 0.5 * d),
            z[-1] + (top - 0.5) * d[-1] if top < 1 else np.max(z + 0.5 * d),
        )

    @cached_property
    def breaks(self) -> np.ndarray:
        """Turns between which functions of the coil are single polynomials, at least `INTERVALS_PER_TURN` per turn."""
        even = np.linspace(0.0, self.turns, int(np.ceil(INTERVALS_PER_TURN * self.turns)) + 1)
        own = [self.radius.x, self.height.x, self.wire.x, *(() if self.axis is None else (one.x for one in self.axis))]
        t = np.unique(np.concatenate([even, *own]))
        return t[np.concatenate([[True], np.diff(t) > 1e-9])]

    @cached_property
    def _along_wire(self) -> np.ndarray:
        """The breaks, and those of hooks and arms."""
        return np.unique(np.concatenate([self.breaks, self.corners])) if self.has_tails else self.breaks

    @property
    def has_tails(self) -> bool:
        """Whether hooks or arms go on beyond the coil."""
        return self.tails != (None, None)

    @cached_property
    def _speeds(self) -> tuple[float, float]:
        """ds/dt at both ends of the coil, which is that of the tails, mm."""
        first, last = self._coil_speed(np.array([0.0, self.turns])).tolist()
        return first, last

    @cached_property
    def corners(self) -> np.ndarray:
        """Turns where the coil or a piece of a hook or arm ends."""
        bottom, top = (
            np.zeros(1) if tail is None else tail.marks / speed
            for tail, speed in zip(self.tails, self._speeds, strict=True)
        )
        return np.concatenate([-bottom[::-1], self.turns + top])

    @cached_property
    def held(self) -> tuple[float, float]:
        """Turns of the points at which the ends are held or pulled."""
        bottom, top = (
            0.0 if tail is None else tail.reach / speed for tail, speed in zip(self.tails, self._speeds, strict=True)
        )
        return -bottom, self.turns + top

    def _with_tails(
        self, turn: np.ndarray | float, order: int, of_coil: Callable[[np.ndarray], np.ndarray]
    ) -> np.ndarray:
        """A derivative of the centre line by the turn: `of_coil` with the axis, and that of hooks or arms beyond it."""
        t = np.asarray(turn, dtype=float)
        within = np.clip(t, 0.0, self.turns) if self.has_tails else t
        found = of_coil(within)
        if self.axis is not None:
            found[..., :2] += self._axis_at(within, order)
        if not self.has_tails:
            return found
        for tail, speed, side, beyond in zip(self.tails, self._speeds, (-1.0, 1.0), (-t, t - self.turns), strict=True):
            out = beyond > 0.0
            if tail is not None and out.any():
                found[out] = (side * speed) ** order * tail.along(speed * beyond[out], order)
        return found

    def mean_radius(self, turn: np.ndarray | float) -> np.ndarray:
        """Mean coil radius at the turns, mm, in their shape; beyond the coil that of its end."""
        return self.radius(np.clip(turn, 0.0, self.turns))

    def wire_diameter(self, turn: np.ndarray | float) -> np.ndarray:
        """Wire diameter at the turns, mm, in their shape."""
        return self.wire(np.clip(turn, 0.0, self.turns))

    def pitch(self, turn: np.ndarray | float) -> np.ndarray:
        """Rise of the centre line at the turns, mm per turn, in their shape."""
        return self._pitch(turn)

    def centre_line(self, turn: np.ndarray | float) -> np.ndarray:
        """Points of the wire's centre line, mm, shape (..., 3); the bottom seat is z = 0."""

        def of_coil(t: np.ndarray) -> np.ndarray:
            θ = self.angle(t)
            r, z = self.radius(t), self.height(t) - self._planes[0]
            return np.stack([r * np.cos(θ), r * np.sin(θ), z], axis=-1)

        return self._with_tails(turn, 0, of_coil)

    def _axis_at(self, turn: np.ndarray | float, order: int) -> np.ndarray:
        """A derivative of the axis's offsets, shape (..., 2), mm."""
        assert self.axis is not None
        return np.stack([one.derivative(order)(turn) if order else one(turn) for one in self.axis], axis=-1)

    def aside(self, low: np.ndarray | float, up: np.ndarray | float) -> np.ndarray:
        """By how much the coil at turns `up` is farther from the axis than that at `low` on the same side, mm."""
        away: np.ndarray = self.mean_radius(up) - self.mean_radius(low)
        if self.axis is None:
            return away
        shift, θ = self._axis_at(up, 0) - self._axis_at(low, 0), self.angle(low)
        return away + shift[..., 0] * np.cos(θ) + shift[..., 1] * np.sin(θ)

    def angle(self, turn: np.ndarray | float) -> np.ndarray:
        """Polar angle of the centre line at the turns, rad, in their shape."""
        return self.phase + self.hand * 2 * np.pi * np.asarray(turn, dtype=float)

    def velocity(self, turn: np.ndarray | float) -> np.ndarray:
        """First derivative of the centre line with respect to the turn, mm, shape (..., 3)."""

        def of_coil(t: np.ndarray) -> np.ndarray:
            return _in_plane(self.angle(t), self.slope(t), self.radius(t) * self.hand * 2 * np.pi, self._pitch(t))

        return self._with_tails(turn, 1, of_coil)

    def acceleration(self, turn: np.ndarray | float) -> np.ndarray:
        """Second derivative of the centre line with respect to the turn, mm, shape (..., 3)."""

        def of_coil(t: np.ndarray) -> np.ndarray:
            r, dr, ddr, dθ = self.radius(t), self.slope(t), self.slope.derivative()(t), self.hand * 2 * np.pi
            return _in_plane(self.angle(t), ddr - r * dθ**2, 2 * dr * dθ, self._pitch.derivative()(t))

        return self._with_tails(turn, 2, of_coil)

    def jerk(self, turn: np.ndarray | float) -> np.ndarray:
        """Third derivative with respect to the turn, mm, shape (..., 3); it jumps where two polynomials meet."""

        def of_coil(t: np.ndarray) -> np.ndarray:
            r, dr, dθ = self.radius(t), self.slope(t), self.hand * 2 * np.pi
            ddr, dddr = self.slope.derivative()(t), self.slope.derivative(2)(t)
            return _in_plane(
                self.angle(t), dddr - 3 * dr * dθ**2, 3 * ddr * dθ - r * dθ**3, self._pitch.derivative(2)(t)
            )

        return self._with_tails(turn, 3, of_coil)

    def speed(self, turn: np.ndarray | float) -> np.ndarray:
        """Length of wire per turn at the turns, ds/dt, mm, in their shape."""
        return self._coil_speed(np.clip(turn, 0.0, self.turns))

    def _coil_speed(self, turn: np.ndarray | float) -> np.ndarray:
        if self.axis is not None:
            θ, r, dθ = self.angle(turn), self.radius(turn), self.hand * 2 * np.pi
            along = _in_plane(θ, self.slope(turn), r * dθ, self._pitch(turn))
            along[..., :2] += self._axis_at(turn, 1)
            return np.asarray(np.linalg.norm(along, axis=-1))
        return np.sqrt(self.slope(turn) ** 2 + (2 * np.pi * self.radius(turn)) ** 2 + self._pitch(turn) ** 2)

    def tangent(self, turn: np.ndarray | float) -> np.ndarray:
        """Unit tangents of the centre line, shape (..., 3)."""
        return self.velocity(turn) / self.speed(turn)[..., None]

    def curvature(self, turn: np.ndarray | float) -> np.ndarray:
        """Curvature of the centre line at the turns, κ = |c′ × c″| / |c′|³, 1/mm, in their shape."""
        return np.linalg.norm(np.cross(self.velocity(turn), self.acceleration(turn)), axis=-1) / self.speed(turn) ** 3

    def curvature_vector(self, turn: np.ndarray | float) -> np.ndarray:
        """κ n at the turns, 1/mm, shape (..., 3): towards the centre of curvature; zero where the wire is straight."""
        t, speed = self.tangent(turn), self.speed(turn)[..., None]
        acceleration = self.acceleration(turn)
        return (acceleration - np.sum(acceleration * t, axis=-1, keepdims=True) * t) / speed**2

    def torsion(self, turn: np.ndarray | float) -> np.ndarray:
        """Torsion of the centre line, τ = (c′ × c″) · c‴ / |c′ × c″|², 1/mm; 0 where the wire is straight.

        A helix of radius R that rises by h per radian has τ = h/(R² + h²), negative if it is left-handed. Pieces of
        hooks and arms are plane.
        """
        t = np.asarray(turn)
        binormal = np.cross(self.velocity(turn), self.acceleration(turn))
        square = np.sum(binormal**2, axis=-1)
        straight = (square < (STRAIGHT * self.speed(turn) ** 2) ** 2) | (t < 0.0) | (t > self.turns)
        return np.sum(binormal * self.jerk(turn), axis=-1) / np.where(straight, np.inf, square)

    @cached_property
    def _lengths(self) -> np.ndarray:
        """Arc length at the breaks, mm, from the first one on."""
        return np.concatenate([[0.0], np.cumsum(functions.integral(self.speed, self._along_wire))])

    def arc_length(self, turn: np.ndarray | float) -> np.ndarray:
        """Length of the centre line from the bottom tip to the turns, mm, in their shape."""
        t = np.asarray(turn, dtype=float)
        breaks = self._along_wire
        i = np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(breaks) - 2)
        ξ, w = functions.gauss(6)
        half = 0.5 * (t - breaks[i])
        inside = self.speed((breaks[i] + half)[..., None] + half[..., None] * ξ) @ w
        return self._lengths[i] + half * inside

    @property
    def wire_length(self) -> float:
        """Length of the wire's centre line, mm."""
        return float(self._lengths[-1])

    @property
    def volume(self) -> float:
        """Volume of the wire before grinding, mm³."""
        share = 1.0 if self.section is None else self.section.area / np.pi
        area = functions.integral(lambda t: 0.25 * np.pi * self.wire_diameter(t) ** 2 * self.speed(t), self._along_wire)
        return float(area.sum()) * share

    @property
    def width(self) -> float:
        """Greatest width of the wire across the coil's axis over its diameter or height; 1 of round wire."""
        return 1.0 if self.section is None else 0.5 * float(self.section.high[0] - self.section.low[0])

    @cached_property
    def levels(self) -> tuple[float, float]:
        """Heights of the seats that touch the unloaded coil, and with hooks of their insides, mm."""
        ends = [self.centre_line(t)[2] for t in self.held]
        low, high = (
            float(end + side * 0.5 * self.wire_diameter(t)) if tail is not None and tail.pulled else plane
            for end, side, t, tail, plane in zip(
                ends, (1.0, -1.0), self.held, self.tails, (0.0, self.body_length), strict=True
            )
        )
        return low, high

    @property
    def free_length(self) -> float:
        """Distance between the seats that touch the unloaded coil, mm; with hooks that between their insides."""
        return self.levels[1] - self.levels[0]

    @property
    def body_length(self) -> float:
        """Distance between two planes that touch the unloaded coil or its ground ends, mm."""
        return float(self._planes[1] - self._planes[0])

    @cached_property
    def block_height(self) -> float:
        """Distance between the seats at which the spring is solid, mm; see `coilset.meshes.springs.block`."""
        return block_height(self)

    @cached_property
    def wound_solid(self) -> bool:
        """Whether its coils lie on each other before any load, so that it is pulled or turned, not pressed."""
        play = self.body_length - self.block_height
        return bool(play <= TOUCH * np.max(self.wire_diameter(self.breaks)))

    @property
    def active_turns(self) -> float:
        """Active turns: all but the end turns of closed ends."""
        return self.turns - self.bottom.end_turns - self.top.end_turns

    def seat_distance(self, turn: np.ndarray | float, end: str) -> np.ndarray:
        """Distance from the centre line to the wire's surface that faces a seat, mm, in the shape of `turn`.

        Half the wire diameter, or less where the end is ground.

        Args:
            turn: turns, any shape.
            end: ``bottom`` or ``top``.
        """
        return np.minimum(0.5 * self.wire(turn), self.seat_level_distance(turn, end))

    def seat_level_distance(self, turn: np.ndarray | float, end: str) -> np.ndarray:
        """Distance of the centre line from the plane of the `bottom` or `top` seat, mm, in the shape of `turn`."""
        height = self.height(turn)
        return height - self._planes[0] if end == "bottom" else self._planes[1] - height

    def flat_turns(self, end: str) -> float:
        """Number of turns from the `bottom` or `top` tip over which the wire is ground; 0 where it is not ground."""
        along = self.breaks if end == "bottom" else self.breaks[::-1]
        cut = 0.5 * self.wire(along) - self.seat_distance(along, end)
        i = int(np.argmax(cut < 1e-9))
        if i == 0:
            return 0.0
        level = self._planes[0] if end == "bottom" else self._planes[1]
        rest = np.abs(self.height(along[i - 1 : i + 1]) - level) - 0.5 * self.wire(along[i - 1 : i + 1])
        last = along[i - 1] - rest[0] * (along[i] - along[i - 1]) / (rest[1] - rest[0])
        return float(abs(last - along[0]))

    def at_height(self, height: float) -> "Spring":
        """The spring between seats at a height, mm: every pitch p becomes p − λ (p − d), with one λ for all turns.

        Coils that lie on each other remain so, and the wire keeps its radius, which in truth grows a little.

        Raises:
            InputError: a height that is not between block and the free length.
        """
        low, high = self.block_height, self.free_length
        if not low * (1.0 - SAME) <= height <= high * (1.0 + SAME):
            raise InputError(
                f"{height:g} mm is impossible; must be between the block height {low:.5g} and the free length "
                f"{high:.5g} mm",
                "height",
            )
        closing = self.height - self.wire.antiderivative()  # play of all turns below a turn
        solid = replace(self, height=self.height - closing).free_length
        return replace(self, height=self.height - closing * ((high - height) / (high - solid)))

    def stations(self, elements_per_turn: ElementsPerTurn = 16, sagitta: float | None = None) -> np.ndarray:
        """Increasing turns of the nodes of a line mesh, see `coilset.meshes.springs.stations.stations`."""
        return stations(self, elements_per_turn, sagitta)


def _in_plane(angle: np.ndarray, radial: np.ndarray, circumferential: np.ndarray, axial: np.ndarray) -> np.ndarray:
    """A vector given in polar components, in Cartesian ones."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([radial * cos - circumferential * sin, radial * sin + circumferential * cos, axial], axis=-1)
