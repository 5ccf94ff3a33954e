"""Hooks and arms: the wire beyond the coil, pieces of straight wire and of circles with a common tangent.

A tail begins where the coil ends, at p with the tangent t away from it; z is the axis away from the coil, n points
to the axis. A piece of length l and radius R turns t towards a direction w across it:

    c(s) = p + R sin(s/R) t + R (1 − cos(s/R)) w.

Hooks, with the mean radius r of the coil and the diameter d of the wire:

- **german**: the wire is bent up from t to z, rises, and forms a loop in the plane through the axis.
- **english**: it runs inwards to the axis on two quarters of a circle of radius r/2; there the loop goes up.
- **side**: the loop continues the coil, rolled about t, so that it stands at the side.

They are pulled at the innermost point of the loop, its top. Arms are held at their end: clamped, or at a point.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from annotated_types import Unit
from pydantic import Field, model_validator

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.strict_entries import Strict

QUARTER = 0.5 * np.pi
STRAIGHT_ON = 1e-6  # sine of the angle to a direction towards which no wire is bent
BEND = 1.5  # radius of a bend over the wire's diameter, if none is given
BEHIND_TOP = {"german": 210.0, "english": 150.0, "side": 150.0}  # degrees of the loop behind the point that is pulled

Millimetres = Annotated[float, Unit("mm"), Field(gt=0, le=1e5, allow_inf_nan=False, strict=True)]


class Hook(Strict):
    """A loop at an end of an extension spring."""

    shape: Annotated[
        Literal["german", "english", "side"],
        Field(description="german: loop over the axis, bent up at the side; english: at the axis; side: at the side"),
    ]
    bend_radius: Annotated[
        Millimetres | None,
        Field(description=f"of a german hook, radius of the wire's axis in the bend, {BEND:g} d if not given"),
    ] = None
    loop_diameter: Annotated[
        Millimetres | None, Field(description="mean diameter of the loop; if not given, that over the axis, or D")
    ] = None
    length: Annotated[
        Millimetres | None,
        Field(description="of a german hook, from the body to the loop's inside; if not given, that of a full loop"),
    ] = None

    @model_validator(mode="after")
    def _belongs(self) -> Self:
        for name in ("bend_radius", "length"):
            if getattr(self, name) is not None and self.shape != "german":
                raise ValueError(f"{name} is for german hooks, not for {self.shape} ones")
        return self


class _Tails(Strict):
    """The wire beyond both ends of a coil, with the entries `bottom` and `top`."""

    def on(self, spring: Spring, place: str) -> Spring:
        """A spring with this wire at its ends; `place` of this entry.

        Raises:
            InputError: as `tail`.
        """
        tails = []
        for end, turn, side in (("bottom", 0.0, -1.0), ("top", spring.turns, 1.0)):
            one = getattr(self, end)
            at = spring.centre_line(turn), side * spring.tangent(turn), np.array([0.0, 0.0, side])
            tails.append(None if one is None else tail(one, *at, float(spring.wire_diameter(turn)), f"{place}.{end}"))
        return replace(spring, tails=(tails[0], tails[1]))


class Hooks(_Tails):
    """Hooks of an extension spring."""

    bottom: Annotated[Hook | None, Field(description="the bottom hook; left out: the wire's tip is clamped")] = None
    top: Annotated[Hook | None, Field(description="the top hook; left out: the wire's tip is clamped")] = None


class Bend(Strict):
    """A bend of an arm, and the straight wire behind it."""

    towards: Annotated[
        Literal["outwards", "inwards", "away", "back"],
        Field(description="outwards from the axis or inwards, along it away from the coil or back over it"),
    ]
    angle: Annotated[
        float, Unit("degrees"), Field(gt=0, lt=180, strict=True, description="by which the wire turns")
    ] = 90.0
    length: Annotated[Millimetres, Field(description="of the straight wire behind the bend")]
    bend_radius: Annotated[
        Millimetres | None, Field(description=f"radius of the wire's axis in the bend, {BEND:g} d if not given")
    ] = None


class Arm(Strict):
    """An arm of a torsion spring, from the coil to the point where it is held."""

    direction: Annotated[
        Literal["tangential", "radial", "axial"],
        Field(description="tangential: straight on; radial: bent outwards; axial: bent along the axis"),
    ] = "tangential"
    length: Annotated[Millimetres, Field(description="of its straight part, up to the first of the bends")]
    bend_radius: Annotated[
        Millimetres | None, Field(description=f"radius of the wire's axis in the bend, {BEND:g} d if not given")
    ] = None
    bends: Annotated[
        list[Bend],
        Field(default_factory=list, strict=False, max_length=20, description="further bends, from the coil outwards"),
    ]
    held: Annotated[
        Literal["clamped", "point"],
        Field(description="clamped in the head, or across a point of it, on which it slides and tilts"),
    ] = "clamped"

    @model_validator(mode="after")
    def _belongs(self) -> Self:
        if self.bend_radius is not None and self.direction == "tangential":
            raise ValueError("a tangential arm has no bend; leave bend_radius out, or give direction: radial")
        return self


class Arms(_Tails):
    """Arms of a torsion spring."""

    bottom: Annotated[Arm | None, Field(description="the bottom arm; left out: the wire ends at the coil")] = None
    top: Annotated[Arm | None, Field(description="the top arm; left out: the wire ends at the coil")] = None


class Piece(NamedTuple):
    """Straight wire, or part of a circle.

    Attributes:
        begin: p, shape (3,), mm.
        tangent, across: t and w, unit vectors, shape (3,).
        length: mm.
        radius: R, mm; infinite of straight wire.
    """

    begin: np.ndarray
    tangent: np.ndarray
    across: np.ndarray
    length: float
    radius: float

    def along(self, s: np.ndarray, order: int) -> np.ndarray:
        """The derivative of an order, 0 to 3, by the length, at lengths s from its beginning, shape (n, 3)."""
        curvature = 1.0 / self.radius
        if not curvature:
            straight = [self.begin + s[:, None] * self.tangent, np.tile(self.tangent, (len(s), 1))]
            return straight[order] if order < len(straight) else np.zeros((len(s), 3))
        sin, cos = np.sin(s * curvature)[:, None], np.cos(s * curvature)[:, None]
        if order == 0:
            return self.begin + self.radius * (sin * self.tangent + (1.0 - cos) * self.across)
        parts = [(cos, sin), (-sin, cos), (-cos, -sin)][order - 1]
        return curvature ** (order - 1) * (parts[0] * self.tangent + parts[1] * self.across)


@dataclass(frozen=True, eq=False)
class Tail:
    """The wire beyond one end of the coil.

    Attributes:
        pieces: from the coil outwards.
        held: number of pieces up to the point that is held or pulled.
        pulled: whether it is a hook.
        on_point: whether it is an arm that a point of the head holds across.
    """

    pieces: tuple[Piece, ...]
    held: int
    pulled: bool
    on_point: bool = False

    @property
    def marks(self) -> np.ndarray:
        """Lengths from the coil to the ends of the pieces, 0 first, mm."""
        return np.cumsum([0.0, *(piece.length for piece in self.pieces)])

    @property
    def reach(self) -> float:
        """Length from the coil to the point that is held, mm."""
        return float(self.marks[self.held])

    def along(self, s: np.ndarray, order: int) -> np.ndarray:
        """The derivative of an order by the length, at lengths s from the coil, shape (n, 3)."""
        found, which = np.empty((len(s), 3)), np.searchsorted(self.marks[1:-1], s, side="right")
        for k in np.unique(which):
            found[which == k] = self.pieces[k].along(s[which == k] - self.marks[k], order)
        return found


class _Wire:
    """Puts a tail together, piece by piece.

    Args:
        point, tangent: end of the coil, and the direction away from it.
        up: the axis, away from the coil.
    """

    def __init__(self, point: np.ndarray, tangent: np.ndarray, up: np.ndarray) -> None:
        self.point, self.tangent, self.up, self.pieces = point, tangent, up, list[Piece]()

    def inwards(self) -> np.ndarray:
        """Unit vector across the axis from the present point to it; the sides are those of the point."""
        across: np.ndarray = -self.point * [1.0, 1.0, 0.0]
        return across / np.linalg.norm(across)

    def _go(self, piece: Piece) -> None:
        end = np.array([piece.length])
        self.pieces.append(piece)
        self.point, self.tangent = piece.along(end, 0)[0], piece.along(end, 1)[0]

    def straight(self, length: float) -> None:
        if length > 0.0:
            self._go(Piece(self.point, self.tangent, self.up, length, np.inf))

    def turn(self, towards: np.ndarray, radius: float, angle: float | None = None) -> None:
        """Turn towards a direction by an angle, rad; without one until it is the tangent."""
        along = float(towards @ self.tangent)
        across = towards - along * self.tangent
        if np.linalg.norm(across) < STRAIGHT_ON:
            raise ValueError
        across /= np.linalg.norm(across)
        angle = float(np.arccos(np.clip(along, -1.0, 1.0))) if angle is None else angle
        self._go(Piece(self.point, self.tangent, across, radius * angle, radius))


def tail(
    entry: Hook | Arm, point: np.ndarray, tangent: np.ndarray, up: np.ndarray, wire_diameter: float, place: str
) -> Tail:
    """The wire beyond one end of the coil.

    Args:
        entry: the entry of a case.
        point, tangent: end of the coil's axis, mm, and the unit vector away from it, shape (3,).
        up: unit vector of the axis, away from the coil.
        wire_diameter: mm.
        place: of the entry.

    Raises:
        InputError: a bend too sharp for the wire, or a hook shorter than its loop.
    """
    made, bend = _Wire(point, tangent, up), _radius(entry, wire_diameter, place)
    if isinstance(entry, Arm):
        if entry.direction != "tangential":
            made.turn(-made.inwards() if entry.direction == "radial" else up, bend)
        made.straight(entry.length)
        for number, one in enumerate(entry.bends):
            _bent(made, one, wire_diameter, f"{place}.bends.{number}")
        return Tail(tuple(made.pieces), len(made.pieces), pulled=False, on_point=entry.held == "point")
    to_top = _HOOKS[entry.shape](made, entry, bend, wire_diameter, place)
    held = len(made.pieces)
    made.turn(_across(made), to_top, np.radians(BEHIND_TOP[entry.shape]))
    return Tail(tuple(made.pieces), held, pulled=True)


def _radius(entry: Hook | Arm | Bend, wire_diameter: float, place: str) -> float:
    """Of a bend of the wire's axis, mm."""
    bend = getattr(entry, "bend_radius", None) or BEND * wire_diameter
    if bend <= 0.5 * wire_diameter:
        raise InputError(f"{bend:g} mm: no wire of {wire_diameter:g} mm is bent so sharply", f"{place}.bend_radius")
    return float(bend)


def _bent(made: _Wire, bend: Bend, wire_diameter: float, place: str) -> None:
    """A bend of an arm, and the straight wire behind it."""
    directions = {"outwards": -made.inwards(), "inwards": made.inwards(), "away": made.up, "back": -made.up}
    try:
        made.turn(directions[bend.towards], _radius(bend, wire_diameter, place), np.radians(bend.angle))
    except ValueError:
        raise InputError(f"the wire runs {bend.towards} already; bend it another way", f"{place}.towards") from None
    made.straight(bend.length)


def _across(made: _Wire) -> np.ndarray:
    """Direction in which the last circle goes on."""
    piece = made.pieces[-1]
    angle = piece.length / piece.radius
    return -np.sin(angle) * piece.tangent + np.cos(angle) * piece.across


def _german(made: _Wire, entry: Hook, bend: float, wire_diameter: float, place: str) -> float:
    """The wire to the top of its loop, whose radius is returned, mm."""
    foot = float(made.point @ made.up)
    made.turn(made.up, bend)
    radius = _loop(entry, float(np.hypot(*made.point[:2])), wire_diameter, place)
    height = radius + wire_diameter if entry.length is None else entry.length + wire_diameter - radius
    rise = height - (float(made.point @ made.up) - foot)
    if entry.length is not None and rise < 0.0:
        raise InputError(
            f"{entry.length:g} mm are too short for bend and loop, which need {entry.length - rise:.4g} mm",
            f"{place}.length",
        )
    made.straight(rise)
    made.turn(made.inwards(), radius, QUARTER)
    return radius


def _english(made: _Wire, entry: Hook, bend: float, wire_diameter: float, place: str) -> float:
    inwards, tangent = made.inwards(), made.tangent * [1.0, 1.0, 0.0]
    r = float(np.hypot(*made.point[:2]))
    made.turn(inwards, 0.5 * r)
    made.turn(-tangent / np.linalg.norm(tangent), 0.5 * r)
    radius = _loop(entry, r, wire_diameter, place)
    made.turn(made.up, radius, 2.0 * QUARTER)
    return radius


def _side(made: _Wire, entry: Hook, bend: float, wire_diameter: float, place: str) -> float:
    radius = _loop(entry, float(np.hypot(*made.point[:2])), wire_diameter, place)
    made.turn(made.up, radius, 2.0 * QUARTER)
    return radius


def _loop(entry: Hook, usual: float, wire_diameter: float, place: str) -> float:
    """Radius of the loop, mm."""
    radius = usual if entry.loop_diameter is None else 0.5 * entry.loop_diameter
    if radius <= wire_diameter:
        raise InputError(f"a loop of {2 * radius:.4g} mm has no room inside", f"{place}.loop_diameter")
    return radius


_HOOKS: dict[str, Callable[[_Wire, Hook, float, float, str], float]] = {
    "german": _german,
    "english": _english,
    "side": _side,
}
