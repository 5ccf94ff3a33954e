"""Stress on the wire's surface: at the inside of the coil, and where it is highest.

The points on the surface follow the section's strains without weight in its integrals (`update_surface` of the
sections), so that their stress is the law's response to the strain there, including their own hardening. Nothing is
extrapolated from the section points, because residual stress is steep there: in a spring of D/d = 8 the residual
shear at the inside is 40 MPa at 0.9 of the radius and 58 MPa on the surface.

They lie at equal angles about the wire's axis, from the section's y axis on. In a section that includes the curvature y
points to the centre of curvature, the inside of the coil, and z along the binormal.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np


def component(state: np.ndarray, components: tuple[str, ...], name: str) -> np.ndarray:
    """One column of a state, such as `t13`; `components` names the columns."""
    return state[..., components.index(name)]


@lru_cache
def directions(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Cosines and sines of the angles at which so many points on the surface lie, shape (points,) each."""
    angle = 2.0 * math.pi * np.arange(points) / points
    return np.cos(angle), np.sin(angle)


def shear(state: np.ndarray, components: tuple[str, ...]) -> np.ndarray:
    """Magnitude of the shear stress in the section, √(τ12² + τ13²), MPa."""
    return np.hypot(*(component(state, components, name) for name in ("t12", "t13")))


def equivalent(state: np.ndarray, components: tuple[str, ...]) -> np.ndarray:
    """Von Mises stress √(3/2 T:T) of all the stresses that the state has, MPa."""

    def stress(name: str) -> np.ndarray | float:
        return component(state, components, name) if name in components else 0.0

    s1, s2, s3 = (stress(name) for name in ("s11", "s22", "s33"))
    shears = sum(stress(name) ** 2 for name in ("t12", "t13", "t23"))
    return np.sqrt(0.5 * ((s1 - s2) ** 2 + (s2 - s3) ** 2 + (s3 - s1) ** 2) + 3.0 * shears)


TIE = 1e-8  # of the maximum value: symmetric springs have it twice, except for rounding; the first location is reported


@dataclass(frozen=True)
class Inside:
    """Where the inside of the coil is on the surface, and how τ13 is counted there.

    Attributes:
        angle: about the wire's axis from the section's y axis, rad.
        sign: makes the shear stress of a compressed spring positive.
    """

    angle: float
    sign: float

    @classmethod
    def of(cls, has_curvature: bool, hand: int) -> "Inside":
        """The inside of a coil of the `hand` +1 or −1.

        A section without curvature has its y axis level: in a right-handed coil it points inwards, in a
        left-handed one outwards, and its z axis points upwards. The binormal does so in a right-handed coil only.
        """
        if has_curvature:
            return cls(0.0, -float(hand))
        return cls(0.0 if hand > 0 else math.pi, -1.0)

    def shear_around(self, state: np.ndarray, components: tuple[str, ...]) -> np.ndarray:
        """Shear stress about the wire's axis at the points on the surface, positive as in a compressed spring.

        Args:
            state: shape (..., surface points, components).
            components: names of the columns.

        Returns:
            Shape (..., surface points), MPa.
        """
        cosine, sine = directions(state.shape[-2])
        t12, t13 = (component(state, components, name) for name in ("t12", "t13"))
        return self.sign * math.cos(self.angle) * (t13 * cosine - t12 * sine)

    def shear(self, state: np.ndarray, components: tuple[str, ...]) -> np.ndarray:
        """Shear stress at the inside, positive as in a compressed spring, shape of `state` without its last two."""
        around = component(state, components, "t13")
        return self.sign * around[..., round(self.angle / (2 * math.pi) * around.shape[-1])]


@dataclass(frozen=True)
class Peak:
    """The maximum value on the surface.

    Attributes:
        value: MPa.
        turn: of the section.
        angle: about the wire's axis from the inside of the coil, towards the section's z axis, degrees, −180 … 180.
    """

    value: float
    turn: float
    angle: float


def peak(values: np.ndarray, turns: np.ndarray, inside: Inside) -> Peak:
    """The largest of the values at the points on the surface.

    Args:
        values: shape (sections, surface points), or (n, 2, surface points).
        turns: of the sections, shape (sections,), or (n, 2).
        inside: where the angles are counted from.

    Returns:
        Peak; between the points a parabola through three of them.
    """
    points = values.shape[-1]
    top = values.max()
    at = np.unravel_index(np.argmax(values >= top - TIE * abs(top)), values.shape)
    before, here, after = (float(values[(*at[:-1], (at[-1] + k) % points)]) for k in (-1, 0, 1))
    bend = before - 2.0 * here + after
    off = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    angle = math.degrees(2.0 * math.pi * (at[-1] + off) / points - inside.angle)
    angle = round((angle + 180.0) % 360.0 - 180.0, 6)  # the location of a flat peak is sensitive to rounding
    return Peak(here - 0.25 * (before - after) * off, float(turns[at[:-1]]), angle)


def beyond_middle(turns: np.ndarray, first: float, last: float) -> np.ndarray:
    """How far turns are outside those that are a turn away from the ends of those between `first` and `last`; negative
    inside.

    With less than two and a half turns, a quarter of a turn on both sides of the middle remains.
    """
    reach = max(0.5 * (last - first) - 1.0, 0.25)
    return np.abs(turns - 0.5 * (first + last)) - reach


def nominal_shear(force: float, mean_diameter: float, wire_diameter: float) -> float:
    """8 F D/(π d³), the shear stress that factors such as Göhner's and Wahl's multiply, MPa."""
    return 8.0 * force * mean_diameter / (math.pi * wire_diameter**3)
