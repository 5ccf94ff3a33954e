"""Checks of springs that are pressed: solid length, gaps, stress at the working lengths and at solid, buckling."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, isfinite

import numpy as np

from coilset.meshes.springs.ends import touching_pitch
from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.tools.checks.check import Check
from coilset.model.tools.checks.permissible import COMPUTED, ONE, TWO, Permitted, hot_block_stress
from coilset.model.tools.checks.subject import Subject
from coilset.model.tools.sheet.rows import SHORT
from coilset.model.tools.standards.buckling import buckling_travel, seating_of


def compressed(one: Subject) -> Iterator[Check]:
    """All checks of a compression spring."""
    yield from _solid_length(one)
    yield from _gaps(one)
    yield from _working_stress(one)
    yield _solid_stress(one)
    yield _buckling(one)


def _shortest(one: Subject) -> float | None:
    return min((state.length for state in one.states), default=None)


def _solid_length(one: Subject) -> Iterator[Check]:
    """The shortest working length above the solid one: of the standard, which is an upper bound, or of the geometry."""
    shortest, solid = _shortest(one), one.spring.block_height
    if shortest is None:
        return
    if one.made is not None and one.made.block is not None:
        cold = "n_t d_max" if _ground(one) else "(n_t + 1.5) d_max"
        formula = "(n_t − 0.3) d_max, hot" if one.is_hot_coiled else cold
        source, sure, low = f"Lc = {formula}, EN 13906-1", ONE if one.is_hot_coiled else TWO, one.made.block
    else:
        source, sure, low = "block of the geometry; EN 13906-1 has no formula for it", COMPUTED, solid
    yield Check("shortest length", shortest, low=low, unit="mm", source=source, sure=sure)


def _ground(one: Subject) -> bool:
    return one.made is not None and one.made.spring.ends == "closed and ground"


def _gaps(one: Subject) -> Iterator[Check]:
    """The sum of the gaps between the coils at the shortest length."""
    shortest = _shortest(one)
    if shortest is None or one.made is None:  # coils of a cone lie within each other
        return
    hot, made = one.is_hot_coiled, one.made
    source = "Sa = 0.02 n (D + d), EN 13906-1" if hot else "Sa = n (0.0015 D²/d + 0.1 d), EN 13906-1"
    source = source.replace("Sa = n", "Sa = 1.5 n") if made.dynamic else source
    gap = shortest - made.shortest
    yield Check("sum of gaps", gap, low=made.gaps, unit="mm", source=source, sure=ONE if hot else TWO)


def _permitted(one: Subject) -> tuple[Permitted | None, bool, str]:
    """The stress permitted at solid, whether it is that of the corrected stress, and why there is none."""
    if one.is_hot_coiled:
        found = hot_block_stress(one.coil.d)
        return found, False, f"no permissible stress of hot coiled bar of {one.coil.d:g} mm was found"
    if one.wire is not None:
        share = one.wire.entry.block_stress
        try:
            stress = one.wire.block_stress(one.coil.d)
        except InputError as error:
            return None, False, str(error.problem)
        return (
            Permitted(stress, f"{share.at(one.coil.d):g} Rm, EN 13906-1", SHORT[share.sure]),
            share.of == "corrected stress",
            "",
        )
    if one.strength is None:
        return None, False, one.no_strength
    # of cold coiled springs of any wire, as all wires of standards have it
    return Permitted(0.56 * one.strength, "0.56 Rm, EN 13906-1", ONE), False, ""


def _stressed(one: Subject, name: str, stress: float, warm: bool, remark: str = "") -> Check:
    """A nominal stress, MPa; `warm` where it acts at the case's temperature."""
    limit, corrected, because = _permitted(one)
    value = stress * (one.coil.correction if corrected else 1.0)
    symbol = "τk" if corrected else "τ"
    check = Check(f"{symbol} {name}", value, unit="MPa", because=because, remark=remark)
    if limit is not None:
        check = replace(check, high=limit.stress, source=limit.source, sure=limit.sure)
        check = replace(check, because=one.warmth if warm and one.is_warm else "")
    return check


def _working_stress(one: Subject) -> Iterator[Check]:
    """At the greatest working force."""
    if not one.states:
        return
    most = one.states[-1]
    remark = "" if most.by_run else "by the formula of the spring as wound"
    if one.made is None:
        remark = f"8 D F/(π d³) of the widest coil, D = {one.coil.D:.4g} mm"
    yield _stressed(one, most.place, one.coil.stress(most.force), True, remark)


def _solid_stress(one: Subject) -> Check:
    """When the coils close, which they do in manufacture, at 20 °C; of the finished spring by the formula."""
    spring, made = one.spring, one.made
    shorter = (one.free_length - spring.block_height) / (spring.free_length - spring.block_height)
    G = one.elastic.shear_modulus if one.wire is None else one.wire.elastic(one.coil.d).shear_modulus
    if made is None:
        wound, remark = _closing_stress(spring, G), "each coil as it closes, by the formula"
    else:
        elastic = replace(made.elastic, shear_modulus=G)
        wound, remark = one.coil.stress(replace(made, elastic=elastic).force(made.spring.solid)), ""
    stress = wound * shorter
    if round(wound) > round(stress):
        remark = "; ".join(filter(None, (remark, f"as wound {wound:.4g}")))
    return _stressed(one, "at solid", stress, False, remark)


def _closing_stress(spring: Spring, G: float) -> float:
    """The greatest shear stress G d (p − p0)/(π D²) of coils that rise by p over the rise p0 at contact, MPa.

    That of the force at which each closes, see `closing_force` of the case's targets.
    """
    start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    t = np.linspace(start, end, 257)
    d, D = spring.wire_diameter(t), 2.0 * spring.mean_radius(t)
    play = np.maximum(spring.pitch(t) - touching_pitch(d, spring.slope(t), spring.section), 0.0)
    return float((G * d * play / (np.pi * D**2)).max())


def _buckling(one: Subject) -> Check:
    """The greatest travel in service, or of the load program, before that at which it buckles with its own ends."""
    seating, spring = seating_of(one.case), one.spring
    ratio = one.elastic.shear_modulus / one.elastic.young_modulus
    critical = buckling_travel(spring, ratio, seating)
    shortest = _shortest(one)
    travel = one.free_length - (spring.block_height if shortest is None else shortest)
    where = "travel before buckling" + (", to block" if shortest is None else "")
    source = f"Haringx, ν = {seating:g}, EN 13906-1"
    if not isfinite(critical):
        return Check(where, travel, high=inf, unit="mm", source=f"never by {source}", sure=TWO)
    buckled = one.summary.get("buckling_travel_mm")
    remark = f"the run buckled at {buckled:.4g} mm" if buckled is not None else ""
    if buckled is None and one.summary and (one.case.contact.arbor or one.case.contact.sleeve):
        return Check(where, travel, high=inf, unit="mm", source="guided, did not buckle in the run", sure=COMPUTED)
    return Check(where, travel, high=critical, unit="mm", source=source, sure=TWO, remark=remark)
