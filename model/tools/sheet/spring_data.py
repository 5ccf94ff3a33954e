"""The data of a spring that a drawing or an order requires."""

from collections.abc import Iterator

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.material.law.steel import STEEL, Elastic
from coilset.model.tools.standards import en13906
from coilset.model.tools.standards.buckling import buckling_travel
from coilset.model.tools.standards.rate import WireNumbers, torsion_rate

SAME = 1e-9  # maximum relative change of coil and wire diameter along a cylinder
Row = tuple[str, str, str]
"""Label, text and unit."""


def spring_data(spring: Spring, material: Elastic = STEEL, turned: bool = False) -> Iterator[Row]:
    """The data of a spring, for a table; where they change along it, from the least to the greatest.

    Args:
        turned: whether it is known to be turned, as any spring with arms is.
    """
    t = spring.breaks
    d, D, mass = spring.wire_diameter(t), 2 * spring.mean_radius(t), spring.volume * material.density
    is_pulled = spring.has_tails or spring.wound_solid  # not pressed between seats
    yield "turns", f"{spring.turns:g}", ""
    yield "active turns", f"{spring.active_turns:g}", ""
    yield "hand", "right" if spring.hand > 0 else "left", ""
    yield "wire diameter d", _span(d), "mm"
    yield "mean diameter D", _span(D), "mm"
    yield "outer diameter", f"{(D + spring.width * d).max():.4g}", "mm"
    yield "inner diameter", f"{(D - spring.width * d).min():.4g}", "mm"
    yield "pitch", _span(spring.pitch(t)), "mm"
    yield "free length", f"{spring.free_length:.5g}", "mm"
    if is_pulled:
        yield "length of the body", f"{spring.body_length:.5g}", "mm"
    else:
        yield "block length", f"{spring.block_height:.5g}", "mm"
        yield "travel to block", f"{spring.free_length - spring.block_height:.5g}", "mm"
    yield "wire length", f"{spring.wire_length:.5g}", "mm"
    yield "mass", *((f"{mass:.4g}", "kg") if mass >= 1.0 else (f"{mass * 1e3:.4g}", "g"))
    yield "spring index D/d", _span(D / d), ""
    if not is_pulled:
        travel = buckling_travel(spring, material.shear_modulus / material.young_modulus)
        yield "slenderness L0/D", f"{spring.free_length / D.min():.3g}", ""
        buckles = (f"{travel:.4g}", "mm") if np.isfinite(travel) else ("never", "")
        yield "travel to buckling, parallel seats", *buckles
    yield _rate(spring, material, is_pulled, turned)
    if (axis := spring.measured_axis) is not None:
        yield "offset of the measured axis from z", f"{axis.offset:.3f}", "mm"
        yield "tilt of the measured axis", f"{axis.tilt:.3f}", "degrees"


def _span(values: np.ndarray) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:.4g}" if high - low < 5e-4 * high else f"{low:.4g} to {high:.4g}"


def _rate(spring: Spring, material: Elastic, is_pulled: bool, turned: bool) -> Row:
    """Of a spring that is turned E I over the length of its wire, else by the torsion of the wire."""
    t = spring.breaks
    d, D = spring.wire_diameter(t), 2 * spring.mean_radius(t)
    arms = any(tail is not None and not tail.pulled for tail in spring.tails)
    if turned or arms:
        second = np.pi * d.min() ** 4 / 64.0
        if spring.section is not None:
            second = WireNumbers.of(spring.section, float(d.min()), float(D.mean())).in_plane
        rate = np.radians(material.young_modulus * second / spring.wire_length)
        label = "rate E I/l, EN 13906-3" + " with the arms' wire" * arms
        return label, f"{rate:.5g}", "N mm/°"
    is_cylinder = all(np.ptp(values) < SAME * values.max() for values in (d, D))  # to which EN 13906-1 applies
    if spring.section is not None and is_cylinder:
        of_rate = WireNumbers.of(spring.section, float(d.mean()), float(D.mean())).of_rate
        rate = en13906.rate(material.shear_modulus, of_rate, float(D.mean()), spring.active_turns)
        return "rate 4 G J c/(π D³ n)", f"{rate:.5g}", "N/mm"
    if spring.section is not None:
        formula = "rate by torsion, G/(2 π ∫ r³/J dn)"
    elif is_cylinder:
        formula = f"rate G d⁴/(8 D³ n), EN {'13906-2, of the body' if is_pulled else '13906-1'}"
    else:
        formula = "rate by torsion, G/(64 ∫ r³/d⁴ dn)"
    return formula, f"{torsion_rate(spring, material.shear_modulus):.5g}", "N/mm"
