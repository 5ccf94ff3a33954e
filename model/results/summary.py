"""The few numbers that answer the question."""

import numpy as np

from coilset.model.section import surface


def summarise(analysis, result):
    """Summary of a run as plain numbers; what is not known (no release, no block) is None.

    Args:
        analysis: Analysis.
        result: Result, complete or not; its snapshots are whole on rank 0 only.

    Returns:
        dict, units in the names.
    """
    last = result.snapshots[-1]
    forces = [step.force_N for step in result.steps]
    greatest = max(forces, default=0.0, key=abs)
    released = bool(result.steps) and abs(last.force) <= 1e-6 * abs(greatest)
    before = analysis.spring.free_length
    after = analysis.outer_length(last.x) if released else None
    return {
        "complete": result.complete,
        "free_length_before_mm": before,
        "free_length_after_mm": after,
        "set_mm": None if after is None else before - after,
        "rate_N_per_mm": result.rate,
        "force_max_N": greatest,
        "block_height_mm": analysis.spring.block_height,
        "residual_shear_max_MPa": float(last.shear.max()) if released else None,
        "shear_max_MPa": max(float(shot.shear.max()) for shot in result.snapshots),
        "residual_shear_inside_MPa": shear_inside(analysis, last) if released else None,
        "shear_inside_max_MPa": max(shear_inside(analysis, shot) for shot in result.snapshots),
        **peaks(analysis, "residual_", [last] if released else []),
        **peaks(analysis, "", result.snapshots),
        "steps": len(result.steps),
        "iterations": int(np.sum([step.iterations for step in result.steps], dtype=int)),
        "material": analysis.law.name,
        "ends": analysis.case.ends,
        "elements": len(analysis.turns) - 1,
        "section_kind": analysis.case.mesh.section.kind,
        "section_rule": analysis.rod.rule.name,
    }


def shear_inside(analysis, snapshot):
    """Shear stress on the wire's surface at the inside of the coil, MPa, positive as in a compressed spring.

    That of greatest magnitude in the middle turns: half a turn from the tips, or from the end coils of closed ends.
    """
    spring = analysis.spring
    first, last = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    stress = analysis.inside.shear(snapshot.surface, snapshot.components)
    middle = stress[surface.is_middle(analysis.section_turns, first, last)]
    return float(middle[np.argmax(np.abs(middle))])


def peaks(analysis, prefix, snapshots):
    """The greatest shear and equivalent stress on the surface in the snapshots, MPa, and where: turn, and angle from
    the inside of the coil, degrees; None without snapshots."""
    found = {}
    for name, stress in (("shear", surface.shear), ("equivalent", surface.equivalent)):
        tops = [surface.peak(stress(shot.surface, shot.components), analysis.section_turns, analysis.inside)
                for shot in snapshots]  # fmt: skip
        top = max(tops, key=lambda one: one.value, default=None)
        for unit, value in (("MPa", "value"), ("turn", "turn"), ("angle_deg", "angle")):
            found[f"{prefix}{name}_surface_max_{unit}"] = getattr(top, value) if top else None
    return found
