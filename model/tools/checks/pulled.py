"""Checks of springs that are pulled: stress of the coils and the hooks, initial tension that coiling reaches."""

from collections.abc import Iterator

from coilset.model.tools.checks.check import Check
from coilset.model.tools.checks.permissible import ONE, hook_bending_stress, initial_tension, pulled_coil_stress
from coilset.model.tools.checks.subject import Subject
from coilset.model.tools.standards.rate import hook_stress


def pulled(one: Subject) -> Iterator[Check]:
    """All checks of an extension spring."""
    force, where = _greatest(one)
    yield _coils(one, force, where)
    yield from _hooks(one, force, where)
    yield from _tension(one)


def _greatest(one: Subject) -> tuple[float | None, str]:
    """The greatest pull, N, positive: of working states, of the run, or of the load program."""
    found = [(abs(state.force), state.place) for state in one.states]
    most = one.summary.get("force_max_N")
    if most is not None:
        found.append((abs(most), f"at {abs(most):.4g} N"))
    else:
        targets = (phase.goal(one.spring.free_length, one.spring.block_height) for phase in one.case.targets)
        found += [(abs(value), f"at {abs(value):.4g} N") for kind, value in targets if kind == "force" and value]
    return max(found, default=(None, ""))


def _coils(one: Subject, force: float | None, where: str) -> Check:
    value = None if force is None else one.coil.stress(force)
    if one.strength is None:
        return Check(f"τ of the coils {where}", value, unit="MPa", because=one.no_strength)
    limit = pulled_coil_stress(one.strength)
    because = one.warmth if one.is_warm else "" if force is not None else "no load is given; give loading or working"
    name = f"τ of the coils {where}".rstrip()
    return Check(name, value, high=limit.stress, unit="MPa", source=limit.source, sure=limit.sure, because=because)


def _hooks(one: Subject, force: float | None, where: str) -> Iterator[Check]:
    """The greatest stress along the wire of the hooks: of the run under its greatest load, else by the formula."""
    if not any(tail is not None and tail.pulled for tail in one.spring.tails):
        return
    run, most = one.summary.get("tail_stress_max_MPa"), one.summary.get("force_max_N")
    value, remark = None, ""
    if run is not None and most:
        value = abs(run) if force is None else abs(run) * max(force / abs(most), 1.0)
        turn = one.summary.get("tail_stress_max_turn")
        remark = f"by the run, at turn {turn:.2f}" if turn is not None else "by the run"
        where = f"at {abs(most):.4g} N" if force is None or force <= abs(most) else where
    elif force is not None and one.spring.section is None:
        value, remark = hook_stress(one.spring) * force, "by the formula"
    name = f"σ of the hooks {where}".rstrip()
    if one.strength is None:
        yield Check(name, value, unit="MPa", because=one.no_strength, remark=remark)
        return
    limit = hook_bending_stress(one.strength)
    because = one.warmth if one.is_warm else "" if value is not None else "no load is given; give loading or working"
    source = f"{limit.source}; 0.70 and 0.75"
    yield Check(
        name, value, high=limit.stress, unit="MPa", source=source, sure=limit.sure, because=because, remark=remark
    )


def _tension(one: Subject) -> Iterator[Check]:
    """Stress of the initial tension, against what coiling reaches."""
    tension = getattr(one.case.spring, "initial_tension", None)
    if not tension:
        return
    if one.spring.section is not None:
        yield Check("τ0 of F0", None, unit="MPa", because="what is coiled of wire that is not round was found nowhere")
        return
    stress = one.coil.stress(tension)
    ready, request = initial_tension(one.coil.D / one.coil.d)
    remark = f"readily coiled up to {ready:.0f} MPa, of two sources" if stress > ready else ""
    source = "coiled on request, ODOP"
    yield Check("τ0 of the initial tension", stress, high=request, unit="MPa", source=source, sure=ONE, remark=remark)
