"""Checks of springs that are turned: bending of coils and legs, the arbor that the coils close on."""

from collections.abc import Iterator

from coilset.model.tools.checks.check import Check
from coilset.model.tools.checks.permissible import turned_bending_stress
from coilset.model.tools.checks.subject import Subject
from coilset.model.tools.standards import en13906


def turned(one: Subject) -> Iterator[Check]:
    """All checks of a torsion spring."""
    yield _coils(one)
    yield from _legs(one)


def largest_turn(one: Subject) -> float | None:
    """The rotation of largest size, degrees, positive in the winding direction; None where a torque is given alone."""
    turns = one.made.turns_to if one.made is not None else ()
    if turns:
        return max(turns, key=abs)
    most: float | None = one.summary.get("turn_max_deg")
    return None if most is None else most * one.spring.hand


def _coils(one: Subject) -> Check:
    """Nominal bending stress in the winding direction, else with the stress factor q of the inside."""
    turn, torque = largest_turn(one), one.summary.get("torque_max_Nmm")
    value = None
    if torque is not None and one.spring.section is None:
        spread = one.made.on_point.greatest if one.made is not None and one.made.on_point else 1.0
        value = spread * en13906.bending_stress(abs(torque), one.coil.d)
    elif one.made is not None and turn is not None and one.spring.section is None:
        value = one.made.bending_stress(turn)
    opening = turn is not None and turn < 0.0
    if value is not None and opening:
        value *= en13906.bending_correction(one.coil.D / one.coil.d)
    at = "" if turn is None else f" at {abs(turn):.4g}°{' against its winding' * opening}"
    name = f"{'σq' if opening else 'σ'} of the coils{at}"
    if one.strength is None:
        return Check(name, value, unit="MPa", because=one.no_strength)
    limit = turned_bending_stress(one.strength)
    because = one.warmth if one.is_warm else ""
    if value is None:
        because = "no rotation is given" if one.spring.section is None else "EN 13906-3 is for round wire"
    inside = one.summary.get("max_bending_inside_MPa")
    remark = "" if inside is None else f"at the inside by the run {abs(inside):.0f} MPa"
    return Check(
        name, value, high=limit.stress, unit="MPa", source=limit.source, sure=limit.sure, because=because, remark=remark
    )


def _legs(one: Subject) -> Iterator[Check]:
    """The greatest stress along the wire of the legs, of the run."""
    if not any(tail is not None and not tail.pulled for tail in one.spring.tails):
        return
    run, name = one.summary.get("tail_stress_max_MPa"), "σ of the legs"
    if run is None:
        yield Check(name, None, unit="MPa", because="a run computes it: coilset solve, then --results")
        return
    if one.strength is None:
        yield Check(name, abs(run), unit="MPa", because=one.no_strength)
        return
    limit, because = turned_bending_stress(one.strength), one.warmth if one.is_warm else ""
    turn = one.summary.get("tail_stress_max_turn")
    remark = f"by the run, at turn {turn:.2f}" if turn is not None else "by the run"
    yield Check(
        name,
        abs(run),
        high=limit.stress,
        unit="MPa",
        source=limit.source,
        sure=limit.sure,
        because=because,
        remark=remark,
    )
