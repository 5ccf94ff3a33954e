"""The data of a spring that a drawing or an order requires."""

from dataclasses import dataclass

import numpy as np

from coilset.meshes.springs.axis import Axis
from coilset.meshes.springs.geometry import Spring
from coilset.model.standards.buckling import buckling_travel
from coilset.model.standards.rate import torsion_rate
from coilset.model.standards.wires.steel import STEEL, Elastic


@dataclass(frozen=True)
class SpringData:
    """Data of a spring in mm, N and kg; ranges are pairs of minimum and maximum."""

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

    @property
    def is_cylinder(self) -> bool:
        """Whether coil and wire diameter are constant, so that the rate is that of EN 13906-1."""
        return all(high - low < 1e-9 * high for low, high in (self.wire_diameter, self.mean_diameter))

    def rows(self) -> list[tuple[str, str, str]]:
        """Label, text and unit of every entry, for a table."""

        def span(pair: tuple[float, float]) -> str:
            low, high = pair
            return f"{low:.4g}" if high - low < 5e-4 * high else f"{low:.4g} to {high:.4g}"

        rate = "rate G d⁴/(8 D³ n), EN 13906-1" if self.is_cylinder else "rate by torsion, G/(64 ∫ r³/d⁴ dn)"
        buckling = f"{self.buckling_travel:.4g}" if np.isfinite(self.buckling_travel) else "never"
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
            ("block length", f"{self.block_length:.5g}", "mm"),
            ("travel to block", f"{self.free_length - self.block_length:.5g}", "mm"),
            ("wire length", f"{self.wire_length:.5g}", "mm"),
            ("mass", *((f"{self.mass:.4g}", "kg") if self.mass >= 1.0 else (f"{self.mass * 1e3:.4g}", "g"))),
            ("spring index D/d", span(self.index), ""),
            ("slenderness L0/D", f"{self.slenderness:.3g}", ""),
            ("travel to buckling, parallel seats", buckling, "mm" if np.isfinite(self.buckling_travel) else ""),
            (rate, f"{self.rate:.5g}", "N/mm"),
            *self._axis_rows(),
        ]

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
    )
