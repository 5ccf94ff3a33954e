"""The few numbers that answer the question."""

import numpy as np


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
        "steps": len(result.steps),
        "iterations": int(np.sum([step.iterations for step in result.steps], dtype=int)),
        "material": analysis.law.name,
        "ends": analysis.case.ends,
        "elements": len(analysis.turns) - 1,
        "section_rule": analysis.rod.rule.name,
    }
