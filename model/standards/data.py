"""The data of a spring that a drawing or an order requires."""

from dataclasses import dataclass

import numpy as np

from coilset.meshes.springs.axis import Axis
from coilset.meshes.springs.geometry import Spring
from coilset.model.standards.buckling import buckling_travel
from coilset.model.standards.rate import WireNumbers, torsion_rate
from coilset.model.standards.wires.steel import STEEL, Elastic


@dataclass(frozen=True)
class SpringData:
    """Data of a spring in mm, N and kg; ranges are pairs of minimum and maximum.

    Attributes:
        body_length: of a spring that is not pressed between seats: with hooks or arms, or wound solid; else None.
        turn_rate: of a spring with arms, N mm/°: E I over the length of its wire; else None.
        is_round: whether its wire is.
    """

    turns: float
    active_turns: float
    hand: str
    wire_diameter: tuple[float, float]
    mean_diameter: tuple[float, float]
    outer_diameter: float
    inner_diameter: float
    pitch: tuple[float, float]
    free_length: float
    block_length: float
    wire_length: float
    mass: float
    index: tuple[float, float]
    slenderness: float
    buckling_travel: float
    rate: float
    axis: Axis | None = None
    body_length: float | None = None
    turn_rate: float | None = None
    is_round: bool = True

    @property
    def is_cylinder(self) -> bool:
        """Whether coil and wire diameter are constant, so that the rate is that of EN 13906-1."""
        return all(high - low < 1e-9 * high for low, high in (self.wire_diameter, self.mean_diameter))

    def rows(self) -> list[tuple[str, str, str]]:
        """Label, text and unit of every entry, for a table."""

        def span(pair: tuple[float, float]) -> str:
            low, high = pair
            return f"{low:.4g}" if high - low < 5e-4 * high else f"{low:.4g} to {high:.4g}"

        return [
            ("turns", f"{self.turns:g}", ""),
            ("active turns", f"{self.active_turns:g}", ""),
            ("hand", self.hand, ""),
            ("wire diameter d", span(self.wire_diameter), "mm"),
            ("mean diameter D", span(self.mean_diameter), "mm"),
            ("outer diameter", f"{self.outer_diameter:.4g}", "mm"),
            ("inner diameter", f"{self.inner_diameter:.4g}", "mm"),
            ("pitch", span(self.pitch), "mm"),
            ("free length", f"{self.free_length:.5g}", "mm"),
            *self._lengths(),
            ("wire length", f"{self.wire_length:.5g}", "mm"),
            ("mass", *((f"{self.mass:.4g}", "kg") if self.mass >= 1.0 else (f"{self.mass * 1e3:.4g}", "g"))),
            ("spring index D/d", span(self.index), ""),
            *self._buckling(),
            self._rate(),
            *self._axis_rows(),
        ]

    def _lengths(self) -> list[tuple[str, str, str]]:
        if self.body_length is not None:
            return [("length of the body", f"{self.body_length:.5g}", "mm")]
        return [
            ("block length", f"{self.block_length:.5g}", "mm"),
            ("travel to block", f"{self.free_length - self.block_length:.5g}", "mm"),
        ]

    def _buckling(self) -> list[tuple[str, str, str]]:
        if self.body_length is not None:
            return []
        travel = f"{self.buckling_travel:.4g}" if np.isfinite(self.buckling_travel) else "never"
        return [
            ("slenderness L0/D", f"{self.slenderness:.3g}", ""),
            ("travel to buckling, parallel seats", travel, "mm" if np.isfinite(self.buckling_travel) else ""),
        ]

    def _rate(self) -> tuple[str, str, str]:
        if self.turn_rate is not None:
            return "rate E I/l, EN 13906-3 with the arms' wire", f"{self.turn_rate:.5g}", "N mm/°"
        if self.is_round:
            formula = "rate G d⁴/(8 D³ n), EN 13906-1" if self.is_cylinder else "rate by torsion, G/(64 ∫ r³/d⁴ dn)"
        else:
            formula = "rate 4 G J/(π D³ n)" if self.is_cylinder else "rate by torsion, G/(2 π ∫ r³/J dn)"
        if self.body_length is not None:
            formula = formula.replace("13906-1", "13906-2, of the body")
        return formula, f"{self.rate:.5g}", "N/mm"

    def _axis_rows(self) -> list[tuple[str, str, str]]:
        if self.axis is None:
            return []
        return [
            ("offset of the measured axis from z", f"{self.axis.offset:.3f}", "mm"),
            ("tilt of the measured axis", f"{self.axis.tilt:.3f}", "degrees"),
        ]


def spring_data(spring: Spring, material: Elastic = STEEL) -> SpringData:
    """The data of a spring.

    Args:
        spring: `Spring`.
        material: with `shear_modulus` and `young_modulus` in MPa and `density` in kg/mm³; spring steel if not given.

    Returns:
        `SpringData`.
    """
    t = spring.breaks
    d, D = spring.wire_diameter(t), 2 * spring.mean_radius(t)

    def span(values: np.ndarray) -> tuple[float, float]:
        return float(values.min()), float(values.max())

    has_arms = any(tail is not None and not tail.pulled for tail in spring.tails)
    is_solid = spring.body_length < spring.block_height * (1.0 + 1e-9)
    height = float(d.min())
    second = np.pi * height**4 / 64.0
    if spring.section is not None:
        second = WireNumbers.of(spring.section, height, float(D.mean())).in_plane
    return SpringData(
        turns=spring.turns,
        active_turns=spring.active_turns,
        hand="right" if spring.hand > 0 else "left",
        wire_diameter=span(d),
        mean_diameter=span(D),
        outer_diameter=float((D + spring.width * d).max()),
        inner_diameter=float((D - spring.width * d).min()),
        pitch=span(spring.pitch(t)),
        free_length=spring.free_length,
        block_length=spring.block_height,
        wire_length=spring.wire_length,
        mass=spring.volume * material.density,
        index=span(D / d),
        slenderness=spring.free_length / float(D.min()),
        buckling_travel=buckling_travel(spring, material.shear_modulus / material.young_modulus),
        rate=torsion_rate(spring, material.shear_modulus),
        axis=spring.measured_axis,
        body_length=spring.body_length if spring.has_tails or is_solid else None,
        turn_rate=float(np.radians(material.young_modulus * second / spring.wire_length)) if has_arms else None,
        is_round=spring.section is None,
    )
