"""Warnings of a spring maker about working lengths and presetting; see `spring_warnings` for the spring."""

from collections.abc import Sequence
from math import sqrt
from typing import TYPE_CHECKING

from coilset.model.core.base.warning import Warning
from coilset.model.tools.standards import en13906
from coilset.model.tools.standards.goodman import Cycle, Line
from coilset.model.tools.wires.wire import Wire

if TYPE_CHECKING:  # a sheet's file imports the formulas
    from coilset.model.tools.sheet.sheet import Sheet

ROUNDING = 1e-6  # of the travel to block: what a spring sets by less is none
PRESETTING_LEAST = 0.1  # of the travel to block; a rule of thumb without a source


def gap_warnings(made: "Sheet") -> list[Warning]:
    """Working lengths at which the gaps between the coils add up to less than Sa of EN 13906-1."""
    spring = made.spring
    needed = en13906.gap_sum(spring.d, spring.D, spring.n, made.dynamic)
    return [
        Warning(
            "gap",
            "loading",
            f"at {length:.4g} mm the gaps between the coils add up to {length - made.shortest:.3g} mm above the block "
            f"length of {made.shortest:.4g} mm, less than the {needed:.3g} mm of EN 13906-1",
            length - made.shortest,
            needed,
            "mm",
        )
        for length in made.lengths
        if length - made.shortest < needed
    ]


def stress_warnings(made: "Sheet", lengths: Sequence[float], wire: Wire) -> list[Warning]:
    """Lengths, mm, at which the nominal stress exceeds that allowed for the wire at block.

    It is that of the run's force where there is a run, but at block of the formula's, as coils that lie on each other
    carry a part past the wire; and corrected for the wire's curvature where the allowed one is meant so.
    """
    spring = made.spring
    allowed, of = wire.block_stress(spring.d), wire.entry.block_stress.of
    factor = spring.correction if of == "corrected stress" else 1.0
    found = []
    for length in lengths:
        computed = made.found.force_at(length) if made.found and length > spring.solid else None
        force = made.force(length) if computed is None else computed
        stress = factor * en13906.stress(force, spring.of_stress, spring.D)
        if stress > allowed:
            source = "formula" if computed is None else "run"
            found.append(
                Warning(
                    "stress",
                    "loading",
                    f"at {length:.4g} mm the {of} of the {source}'s {force:.4g} N is {stress:.4g} MPa, above the "
                    f"{allowed:.4g} MPa allowed for {wire.name}",
                    stress,
                    allowed,
                    "MPa",
                )
            )
    return found


def strength_warnings(made: "Sheet") -> list[Warning]:
    """Loads under which an extension or torsion spring would have more than its strength by the elastic formulas.

    Nominal bending above Rm, and nominal shear above Rm/√3 (von Mises). How much less the standards permit was found in
    no source.
    """
    strength, spring = made.least_strength, made.spring
    if strength is None or spring.wire:
        return []
    shear = ("Rm/√3", strength / sqrt(3.0))
    found: list[tuple[str, str, float, tuple[str, float]]] = []
    for length in made.lengths if made.pulled else ():
        force, where = abs(made.force(length)), f"at {length:.4g} mm"
        found.append((where, "shear stress of the coils", en13906.stress(force, spring.d, spring.D), shear))
        found.append((where, "bending stress of the hooks", made.hook_stress * force, ("Rm", strength)))
    for turn in made.turns_to:
        found.append((f"at {turn:.4g}°", "bending stress", made.bending_stress(turn), ("Rm", strength)))
    return [
        Warning(
            "strength",
            "loading",
            f"{where} the {name} by the elastic formula is {stress:.4g} MPa, above {symbol} = {limit:.4g} MPa",
            stress,
            limit,
            "MPa",
        )
        for where, name, stress, (symbol, limit) in found
        if stress > limit
    ]


def endurance_warnings(cycle: Cycle, endured: Line) -> list[Warning]:
    """A cycle of corrected stresses whose range exceeds the permissible one above its lower stress."""
    spread, allowed = cycle.upper - cycle.lower, endured.stress_range(cycle.lower)
    if spread <= allowed:
        return []
    return [
        Warning(
            "endurance",
            "loading",
            f"the corrected stress varies by {spread:.4g} MPa over {cycle.lower:.4g} "
            f"MPa; the limit is {allowed:.4g} MPa for {endured.times} cycles, {endured.surface}",
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
