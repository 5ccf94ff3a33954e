"""The geometry of a spring as functions of the turn."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from coilset.meshes.boundary import Boundary
from coilset.meshes.springs import functions
from coilset.meshes.springs.axis import Axis
from coilset.meshes.springs.block import block_height
from coilset.meshes.springs.ends import OPEN, EndCoils
from coilset.meshes.springs.piecewise import PiecewisePolynomial
from coilset.meshes.springs.stations import ElementsPerTurn, stations
from coilset.model.base.errors import InputError

INTERVALS_PER_TURN = 64
SAME = 1e-9  # relative difference of a height from a bound that is rounding
STRAIGHT = 1e-9  # |c′ × c″| over |c′|² below which a wire has no normal


@dataclass(frozen=True, eq=False)
class Spring:
    """A wire wound round the z axis: mean radius, height and wire diameter as functions of the turn.

    The diameter of a wire that is not round is its height along the spring.

    The turn t counts from the bottom end, and the seats are the planes z = 0 and z = free length. The centre line is
    `c(t) = (r cos θ, r sin θ, z)` with `θ = phase + hand 2π t`. All lengths are in mm.

    Args:
        radius: mean radius over the turn, a `PiecewisePolynomial` from 0 to the number of turns.
        height: height of the centre line over the turn, from any level.
        wire: wire diameter over the turn.
        hand: +1 right, −1 left.
        bottom: `EndCoils` at turn 0.
        top: `EndCoils` at the last turn.
        phase: polar angle of the first point, rad.
        measured_axis: fitted axis of a measured spring in the coordinates of its file; None of a drawn one.
        section: boundary of a wire that is not round, in half its height, y towards the coil's axis and z upwards;
            None of a round one.
    """

    radius: PiecewisePolynomial
    height: PiecewisePolynomial
    wire: PiecewisePolynomial
    hand: int = 1
    bottom: EndCoils = OPEN
    top: EndCoils = OPEN
    phase: float = 0.0
    measured_axis: Axis | None = None
    section: Boundary | None = None

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
        """Turns between which every function is a single polynomial, at least `INTERVALS_PER_TURN` per turn."""
        even = np.linspace(0.0, self.turns, int(np.ceil(INTERVALS_PER_TURN * self.turns)) + 1)
        t = np.unique(np.concatenate([even, self.radius.x, self.height.x, self.wire.x]))
        return t[np.concatenate([[True], np.diff(t) > 1e-9])]

    def mean_radius(self, turn: np.ndarray | float) -> np.ndarray:
        """Mean coil radius at the turns, mm, in their shape."""
        return self.radius(turn)

    def wire_diameter(self, turn: np.ndarray | float) -> np.ndarray:
        """Wire diameter at the turns, mm, in their shape."""
        return self.wire(turn)

    def pitch(self, turn: np.ndarray | float) -> np.ndarray:
        """Rise of the centre line at the turns, mm per turn, in their shape."""
        return self._pitch(turn)

    def centre_line(self, turn: np.ndarray | float) -> np.ndarray:
        """Points of the wire's centre line, mm, shape (..., 3); the bottom seat is z = 0."""
        θ = self.angle(turn)
        r, z = self.radius(turn), self.height(turn) - self._planes[0]
        return np.stack([r * np.cos(θ), r * np.sin(θ), z], axis=-1)

    def angle(self, turn: np.ndarray | float) -> np.ndarray:
        """Polar angle of the centre line at the turns, rad, in their shape."""
        return self.phase + self.hand * 2 * np.pi * np.asarray(turn, dtype=float)

    def velocity(self, turn: np.ndarray | float) -> np.ndarray:
        """First derivative of the centre line with respect to the turn, mm, shape (..., 3)."""
        θ = self.angle(turn)
        r, dr, dθ = self.radius(turn), self.slope(turn), self.hand * 2 * np.pi
        return _in_plane(θ, dr, r * dθ, self._pitch(turn))

    def acceleration(self, turn: np.ndarray | float) -> np.ndarray:
        """Second derivative of the centre line with respect to the turn, mm, shape (..., 3)."""
        θ = self.angle(turn)
        r, dr, ddr, dθ = self.radius(turn), self.slope(turn), self.slope.derivative()(turn), self.hand * 2 * np.pi
        return _in_plane(θ, ddr - r * dθ**2, 2 * dr * dθ, self._pitch.derivative()(turn))

    def jerk(self, turn: np.ndarray | float) -> np.ndarray:
        """Third derivative with respect to the turn, mm, shape (..., 3); it jumps where two polynomials meet."""
        θ = self.angle(turn)
        r, dr, dθ = self.radius(turn), self.slope(turn), self.hand * 2 * np.pi
        ddr, dddr = self.slope.derivative()(turn), self.slope.derivative(2)(turn)
        return _in_plane(θ, dddr - 3 * dr * dθ**2, 3 * ddr * dθ - r * dθ**3, self._pitch.derivative(2)(turn))

    def speed(self, turn: np.ndarray | float) -> np.ndarray:
        """Length of wire per turn at the turns, ds/dt, mm, in their shape."""
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

        A helix of radius R that rises by h per radian has τ = h/(R² + h²), negative if it is left-handed.
        """
        binormal = np.cross(self.velocity(turn), self.acceleration(turn))
        square = np.sum(binormal**2, axis=-1)
        straight = square < (STRAIGHT * self.speed(turn) ** 2) ** 2
        return np.sum(binormal * self.jerk(turn), axis=-1) / np.where(straight, np.inf, square)

    @cached_property
    def _lengths(self) -> np.ndarray:
        """Arc length at the breaks, mm."""
        return np.concatenate([[0.0], np.cumsum(functions.integral(self.speed, self.breaks))])

    def arc_length(self, turn: np.ndarray | float) -> np.ndarray:
        """Length of the centre line from the bottom end to the turns, mm, in their shape."""
        t = np.asarray(turn, dtype=float)
        i = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.breaks) - 2)
        ξ, w = functions.gauss(6)
        half = 0.5 * (t - self.breaks[i])
        inside = self.speed((self.breaks[i] + half)[..., None] + half[..., None] * ξ) @ w
        return self._lengths[i] + half * inside

    @property
    def wire_length(self) -> float:
        """Length of the wire's centre line, mm."""
        return float(self._lengths[-1])

    @property
    def volume(self) -> float:
        """Volume of the wire before grinding, mm³."""
        share = 1.0 if self.section is None else self.section.area / np.pi
        parts = functions.integral(lambda t: 0.25 * np.pi * self.wire(t) ** 2 * self.speed(t), self.breaks)
        return float(parts.sum()) * share

    @property
    def width(self) -> float:
        """Greatest width of the wire across the coil's axis over its diameter or height; 1 of round wire."""
        return 1.0 if self.section is None else 0.5 * float(self.section.high[0] - self.section.low[0])

    @property
    def free_length(self) -> float:
        """Distance between the seats that touch the unloaded spring, mm."""
        return float(self._planes[1] - self._planes[0])

    @cached_property
    def block_height(self) -> float:
        """Distance between the seats at which the spring is solid, mm; see `coilset.meshes.springs.block`."""
        return block_height(self)

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
