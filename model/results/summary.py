"""The few numbers that answer the question."""

from math import isfinite
from typing import Any

from coilset.model.results.buckling import buckling
from coilset.model.results.record import Result, Setup


def summarise(setup: Setup, result: Result) -> dict[str, Any]:
    """Summary of a run as plain numbers, units in the names; what is not known (no release, no block) is None.

    Args:
        setup: Setup.
        result: Result, complete or not; its snapshots are whole on rank 0 only.
    """
    last = result.snapshots[-1]
    forces = [step.force_N for step in result.steps]
    greatest = max(forces, default=0.0, key=abs)
    released = bool(result.steps) and abs(last.force) <= 1e-6 * abs(greatest)
    before, buckled = setup.spring.free_length, buckling(result.steps, setup.mean_diameter)
    after = setup.outer_length(last.x) if released else None
    return {
        "complete": result.complete,
        "free_length_before_mm": before,
        "free_length_after_mm": after,
        "set_mm": None if after is None else before - after,
        "rate_N_per_mm": result.rate,
        "force_max_N": greatest,
        "block_height_mm": setup.spring.block_height,
        "residual_shear_max_MPa": float(last.shear.max()) if released else None,
        "shear_max_MPa": max(float(shot.shear.max()) for shot in result.snapshots),
        "steps": len(result.steps),
        "iterations": sum(step.iterations for step in result.steps),
        "material": setup.material,
        "ends": setup.ends,
        "unstable_steps": sum(step.negative_pivots > 0 for step in result.steps),
        "buckled": buckled is not None,
        "buckling_travel_mm": buckled and buckled.travel_mm,
        "buckling_force_N": buckled and buckled.force_N,
        "buckling_travel_EN_13906_1_mm": setup.buckling_travel if isfinite(setup.buckling_travel) else None,
        "elements": len(setup.turns) - 1,
        "section_rule": setup.rule.name,
    }
