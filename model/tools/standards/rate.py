"""The torsion of the wire: the rate of a spring by it alone, and the round wires that stand for one that is not round.

EN 13906-1 reads the factors of rectangular wire off diagrams. Here they are computed for any section: its torsion
constant J and section modulus W of a straight wire (Saint-Venant); the rate of a coil, without pitch, over that by J
alone, c; and the greatest shear on its surface over F D/(2 W). With d⁴ = 32 c J/π, d³ = 16 W/π and d² = 4 A/π the
formulas of round wire hold. Of round wire c is 1/(1 − 3/(16 w²)) but for terms in 1/w⁴ (Ancker and Goodier), which
the standard leaves out; of a flat rectangle in a tight coil it is some per cent.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import pi
from typing import Literal, NamedTuple

import numpy as np

from coilset.meshes.sections.boundary import Boundary
from coilset.meshes.springs import functions
from coilset.meshes.springs.geometry import Spring
from coilset.model.physics.outlines.outlined_section import Outlined, Section
from coilset.model.tools.standards.en13906 import bending_correction

AROUND = 720  # points on the surface at which the greatest shear is sought, and of the coils, for their moment
STRAIGHT = 1e-9  # curvature of straight wire, 1/mm
VERTICAL = 1e-6  # sine of the angle to the axis below which an arm is axial


@dataclass(frozen=True)
class WireNumbers:
    """Of a wire that is not round; lengths in mm.

    Attributes:
        width: across the coil's axis.
        torsion: J, mm⁴.
        modulus: W, torque over the greatest shear stress of a straight wire, mm³.
        area: A, mm².
        curved: c, rate of the coil, with its curvature and the direct shear, over 4 G J/(π D³ n).
        correction: greatest shear stress in the coil over F D/(2 W).
        out_of_plane, in_plane: second moments of area ∫ z² dA and ∫ y² dA about the middle, mm⁴.
    """

    width: float
    torsion: float
    modulus: float
    area: float
    curved: float
    correction: float
    out_of_plane: float
    in_plane: float

    @classmethod
    @lru_cache(maxsize=64)  # of one sheet, its warnings and each working length
    def of(cls, boundary: Boundary, height: float, mean_diameter: float) -> "WireNumbers":
        """Of a section in half its height, a height and a mean diameter of the coil, mm."""
        section, r = Outlined(boundary), 0.5 * height
        places, weights = section.fine
        second = pi * r**4 * weights @ (places - weights @ places / weights.sum()) ** 2
        bend = height / mean_diameter
        twisted, coiled = _under(section, 0.0), _under(section, bend)
        straight, most = (_greatest(section, boundary, one) for one in (twisted, coiled))
        return cls(
            width=r * float(np.ptp(boundary.polygon[:, 0])),
            torsion=section.warping().torsion * r**4,
            modulus=r**3 / straight,
            area=r**2 * boundary.area,
            curved=twisted.work / coiled.work,
            correction=most / straight,
            out_of_plane=float(second[1]),
            in_plane=float(second[0]),
        )

    @property
    def of_rate(self) -> float:
        """Diameter of the round wire whose formula gives the rate of the coil, mm."""
        return float((32.0 * self.curved * self.torsion / pi) ** 0.25)

    @property
    def of_stress(self) -> float:
        """That of the same stress by a torque, mm."""
        return float((16.0 * self.modulus / pi) ** (1.0 / 3.0))

    @property
    def of_mass(self) -> float:
        """That of the same area, mm."""
        return float((4.0 * self.area / pi) ** 0.5)

    def buckling_ratios(self, modulus_ratio: float) -> tuple[float, float]:
        """G J/(2 E I) of bending across and in the plane of the coil, each G/E of round wire; see `critical_travel`."""
        half = 0.5 * modulus_ratio * self.torsion
        return half / self.out_of_plane, half / self.in_plane


class _Loaded(NamedTuple):
    """A section of curvature `bend` under the torque r of a force 1/R along the axis, with r = 1, and their work."""

    bend: float
    strain: np.ndarray
    work: float


def _under(section: Section, bend: float) -> _Loaded:
    """Shear Q3 = F = Mt/R beside the torque Mt = 1; none of a straight wire."""
    load = np.array([0.0, bend, 1.0])
    strain = np.linalg.solve(pi * section.warping(bend).stiffness, load)
    return _Loaded(bend, strain, float(load @ strain))


def _greatest(section: Section, boundary: Boundary, loaded: _Loaded) -> float:
    """Greatest shear on the surface."""
    places = boundary.points(AROUND)
    shear = np.einsum("ijp,j->ip", section.warping(loaded.bend).shear(places), loaded.strain)
    return float(np.hypot(*(shear / (1.0 - loaded.bend * places[:, 0]))).max())


def torsion_rate(spring: Spring, shear_modulus: float) -> float:
    """Initial rate for torsion of the wire alone and small pitch, N/mm.

    Castigliano's `1/R = 64/G ∫ r³/d⁴ dt` over the active turns: R = G d⁴/(8 D³ n) of EN 13906-1 for a cylinder, and
    R = G d⁴/(2 n (D1 + D2)(D1² + D2²)) for a cone (Wahl, Mechanical Springs, chapter on conical springs). Of wire that
    is not round π d⁴/32 is its torsion constant. G is in MPa.
    """
    start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    breaks = np.concatenate([[start], spring.breaks[(spring.breaks > start) & (spring.breaks < end)], [end]])
    compliance = functions.integral(lambda t: spring.mean_radius(t) ** 3 / spring.wire_diameter(t) ** 4, breaks).sum()
    rate = float(shear_modulus / (64 * compliance))
    if spring.section is None:
        return rate
    return rate * Outlined(spring.section).warping().torsion / (0.5 * np.pi)  # J of a disk of radius 1


def tails_compliance(spring: Spring, young_modulus: float, shear_modulus: float, turned: bool) -> float:
    """Compliance of hooks and arms: mm/N along the axis at their held points, or rad/(N mm) about it.

    Castigliano's energy with the moment m = (x_h − x) × e of a pull e along the axis at the held point x_h, or m = e of
    a torque, where the spring is `turned`; E and G are in MPa.
    """
    if not spring.has_tails:
        return 0.0
    axis, corners = np.array([0.0, 0.0, 1.0]), spring.corners

    def moment(t: np.ndarray) -> np.ndarray:
        held = spring.centre_line(np.where(t < 0.0, *spring.held))
        return np.broadcast_to(axis, held.shape) if turned else np.cross(held - spring.centre_line(t), axis)

    first, last = spring.held
    parts = [corners[(corners >= first) & (corners <= 0.0)], corners[(corners >= spring.turns) & (corners <= last)]]
    return sum(_compliance(spring, young_modulus, shear_modulus, moment, part) for part in parts)


def _compliance(
    spring: Spring, E: float, G: float, moment: Callable[[np.ndarray], np.ndarray], part: np.ndarray
) -> float:
    """Castigliano's ∫ (Mt²/(G J) + Mb²/(E I)) ds of round wire between the turns `part`; I = π d⁴/64, J = 2 I."""

    def density(t: np.ndarray) -> np.ndarray:
        m = moment(t)
        torque = np.sum(m * spring.tangent(t), axis=-1)
        bending = np.sum(m**2, axis=-1) - torque**2
        inertia = pi * spring.wire_diameter(t) ** 4 / 64.0
        return (torque**2 / (2.0 * G) + bending / E) / inertia * spring.speed(t)

    return float(functions.integral(density, part).sum())


def hook_stress(spring: Spring) -> float:
    """Greatest stress along the wire of hooks by a pull of 1 N, MPa; 0 without hooks.

    q · 32 M/(π d³) + 4 N/(π d²) of round wire, with the bending moment and the pull along the wire of
    `tails_compliance`, and q of a curved wire for bending in its plane. The torsion where a hook begins is left out.
    """
    axis, corners, greatest = np.array([0.0, 0.0, 1.0]), spring.corners, 0.0
    first, last = spring.held
    pieces = (corners[(corners >= first) & (corners <= 0.0)], corners[(corners >= spring.turns) & (corners <= last)])
    for tail, held, piece in zip(spring.tails, spring.held, pieces, strict=True):
        if tail is None or not tail.pulled:
            continue
        inner = (np.linspace(a, b, AROUND)[1:-1] for a, b in itertools.pairwise(piece))  # bends end at the corners
        t = np.concatenate(list(inner))
        tangent, d, bend = spring.tangent(t), spring.wire_diameter(t), spring.curvature_vector(t)
        moment = np.cross(np.cross(spring.centre_line(np.array([held])) - spring.centre_line(t), axis), tangent)
        curvature = np.maximum(np.linalg.norm(bend, axis=-1), STRAIGHT)
        within = np.sum(moment * bend, axis=-1) / curvature
        across = np.sqrt(np.maximum(np.sum(moment**2, axis=-1) - within**2, 0.0))
        q = np.array([bending_correction(index) for index in (2.0 / (curvature * d)).tolist()])
        bent = 32.0 * np.hypot(q * within, across) / (pi * d**3)
        greatest = max(greatest, float((bent + 4.0 * np.abs(tangent @ axis) / (pi * d**2)).max()))
    return greatest


@dataclass(frozen=True)
class OnPoint:
    """A torsion spring one of whose arms is held across by a point of its head.

    The point's force F lies across the arm and the axis. With the torque M = F h about the axis the wire has the moment
    (x_p − x) × F everywhere: none at the point, and up to (1 + D/(2 h)) M where the coil is farthest from the force.

    Attributes:
        lever: h, of the force about the axis, mm.
        compliance: rotation by a torque, of the whole wire, rad/(N mm).
        greatest: greatest moment of the coils about the axis over the torque.
    """

    lever: float
    compliance: float
    greatest: float

    @classmethod
    def of(cls, spring: Spring, young_modulus: float, shear_modulus: float) -> "OnPoint | None":
        """None if no arm of the spring is on a point; E and G in MPa."""
        held = [t for t, tail in zip(spring.held, spring.tails, strict=True) if tail is not None and tail.on_point]
        if not held:
            return None
        point, along = (line(np.array(held))[0] for line in (spring.centre_line, spring.tangent))
        across = np.cross([0.0, 0.0, 1.0], along)
        if np.linalg.norm(across) < VERTICAL:  # an axial arm: across it and its radius
            across = np.cross([0.0, 0.0, 1.0], point)
        across /= np.linalg.norm(across)
        lever = float(np.cross(point, across)[2])

        def moment(t: np.ndarray) -> np.ndarray:
            return np.cross(point - spring.centre_line(t), across / lever)

        breaks = np.unique(np.concatenate([spring.corners, spring.breaks]))
        compliance = _compliance(spring, young_modulus, shear_modulus, moment, breaks)
        coil = np.linspace(0.0, spring.turns, AROUND)
        return cls(abs(lever), compliance, float(np.abs(moment(coil)[..., 2]).max()))


def pitch_compliance(angle: float, nu: float, ends: Literal["turning", "held"] = "turning") -> float:
    """Compliance of a cylindrical spring over that of R = G d⁴/(8 D³ n), due to the wire's pitch angle.

    An axial force F on a helix of radius r and pitch angle α twists the wire by F r cos α and bends it by F r sin α,
    over the length 2π r n/cos α. With EI = (1 + ν) G Ip of round wire, Castigliano gives for ends that may turn

        cos α (1 + tan²α/(1 + ν)) = 1 + tan²α (1 − ν)/(2 (1 + ν)) + O(α⁴).

    Fixed ends add a couple T about the axis, which makes the rotation zero; the moments are F r cos α + T sin α
    and F r sin α − T cos α, and the result is 1/[cos α (cos²α + (1 + ν) sin²α)] = 1 + tan²α (½ − ν) + O(α⁴).

    Args:
        angle: pitch angle α, rad; tan α = pitch/(π D).
        nu: Poisson's ratio; of wire that is not round E I/(G J) − 1, I of bending in the plane of the coil.
        ends: whether the ends may turn about the axis.
    """
    s, c = np.sin(angle), np.cos(angle)
    if ends == "turning":
        return float(c + s**2 / ((1 + nu) * c))
    return float(1 / (c * (c**2 + (1 + nu) * s**2)))
