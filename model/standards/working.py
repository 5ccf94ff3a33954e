"""What a spring maker would warn about at the working lengths and in presetting; see `warnings` for the spring."""

from collections.abc import Sequence

from coilset.model.base.warning import Warning
from coilset.model.standards import en13906
from coilset.model.standards.cylinder import Cylinder
from coilset.model.standards.goodman import Cycle, Line
from coilset.model.standards.wires.wire import Wire

ROUNDING = 1e-6  # of the travel to block: what a spring sets by less is none
PRESETTING_LEAST = 0.1  # of the travel to block; a rule of thumb without a source


def gap_warnings(spring: Cylinder, lengths: Sequence[float], dynamic: bool = False) -> list[Warning]:
    """Working lengths, mm, at which the gaps between the coils add up to less than Sa of EN 13906-1."""
    needed = en13906.gap_sum(spring.d, spring.D, spring.n, dynamic)
    return [
        Warning(
            "gap",
            "loading",
            f"at {length:.4g} mm the gaps between the coils add up to "
            f"{length - spring.solid:.3g} mm, less than the {needed:.3g} mm of EN 13906-1",
            length - spring.solid,
            needed,
            "mm",
        )
        for length in lengths
        if length - spring.solid < needed
    ]


def stress_warnings(spring: Cylinder, shear_modulus: float, lengths: Sequence[float], wire: Wire) -> list[Warning]:
    """Lengths, mm, at which the nominal stress exceeds that allowed for the wire at block.

    It is corrected for the wire's curvature where the allowed one is meant so.
    """
    allowed, of = wire.block_stress(spring.d), wire.entry.block_stress.of
    rate = en13906.rate(shear_modulus, spring.d, spring.D, spring.n)
    factor = en13906.stress_correction(spring.index) if of == "corrected stress" else 1.0
    found = []
    for length in lengths:
        stress = factor * en13906.stress(rate * (spring.length - length), spring.d, spring.D)
        if stress > allowed:
            found.append(
                Warning(
                    "stress",
                    "loading",
                    f"at {length:.4g} mm the nominal {of} is {stress:.4g} N/mm², above the "
                    f"{allowed:.4g} N/mm² allowed for {wire.name}",
                    stress,
                    allowed,
                    "MPa",
                )
            )
    return found


def endurance_warnings(cycle: Cycle, endured: Line) -> list[Warning]:
    """A cycle of corrected stresses whose range exceeds what the wire endures above its lower stress."""
    spread, allowed = cycle.upper - cycle.lower, endured.stress_range(cycle.lower)
    if spread <= allowed:
        return []
    return [
        Warning(
            "endurance",
            "loading",
            f"the corrected stress varies by {spread:.4g} N/mm² over {cycle.lower:.4g} "
            f"N/mm²; the limit is {allowed:.4g} N/mm² for {endured.times} cycles, {endured.surface}",
            spread,
            allowed,
            "MPa",
        )
    ]


def presetting_warning(set_mm: float, travel: float) -> Warning | None:
    """Presetting that takes less than a tenth of the travel to block.

    Such a spring continues to set in service. The bound is a rule of thumb for which no source was found.

    Args:
        set_mm: shortening of the free spring by presetting, mm.
        travel: from the free length before presetting to block, mm.
    """
    if set_mm >= PRESETTING_LEAST * travel:
        return None
    share = set_mm / travel if abs(set_mm) > ROUNDING * travel else 0.0
    part = f"{abs(share) * travel:.3g} mm, {100 * abs(share):.2g} % of the travel to block"
    message = (
        f"presetting {'leaves the spring longer by' if share < 0.0 else 'takes'} {part}; "
        f"a set of {100 * PRESETTING_LEAST:g} % or more is usual"
    )
    return Warning("presetting", "loading", message, set_mm, PRESETTING_LEAST * travel, "mm")
