"""The main numbers of a slice's run, under the names used for a spring's run, and some more."""

from dataclasses import asdict

import numpy as np

from coilset.model.compose.run_warnings import beyond_validity
from coilset.model.core.base.warning import Warning
from coilset.model.core.results.records.summary_entries import UNSEEN
from coilset.model.physics.slice.analysis import SliceAnalysis, SliceSnapshot
from coilset.model.physics.slice.watch import shear
from coilset.model.physics.solid.continuum import mises
from coilset.model.tools.limits.case_warnings import case_warnings


def summarise(analysis: SliceAnalysis) -> dict:
    """Summary of a run as plain numbers; unknown ones (no release) are None. Units are in the names."""
    result, spring = analysis.result, analysis.spring
    last, section = result.snapshots[-1], analysis.body.section
    forces = [step.force_N for step in result.steps]
    greatest = max(forces, default=0.0, key=abs)
    released = bool(result.steps) and abs(last.force) <= 1e-6 * abs(greatest)
    loaded = max(result.snapshots, key=lambda shot: abs(shot.force))
    before, after = spring.free_length, last.height if released else None
    return {
        "complete": result.complete,
        "free_length_before_mm": before,
        "free_length_after_mm": after,
        "set_mm": None if after is None else before - after,
        "rate_N_per_mm": result.rate,
        "force_max_N": greatest,
        "block_height_mm": spring.block_height,
        "residual_shear_max_MPa": at_surface(analysis, last)["surface_shear_max_MPa"] if released else None,
        "shear_max_MPa": max(at_surface(analysis, shot)["surface_shear_max_MPa"] for shot in result.snapshots),
        "residual_shear_inside_MPa": shear_inside(last) if released else None,
        "shear_inside_max_MPa": max(shear_inside(shot) for shot in result.snapshots),
        "load_loss_percent": next((x for s in reversed(result.steps) if (x := s.load_loss_percent) is not None), None),
        "steps": len(result.steps),
        "iterations": sum(step.iterations for step in result.steps),
        "material": analysis.law.name,
        "ends": analysis.case.ends,
        **dict.fromkeys(UNSEEN),
        "elements": len(analysis.body.forms.cells),
        "section_rule": f"triangles of degree {section.degree} with {len(analysis.body.forms.points)} points",
        "unknowns": analysis.body.u.size + 2,
        "turns": analysis.turns,
        "free_to_turn": analysis.problem.free_ends,
        "turn_after": last.turn,
        "inside_factor": result.inside_factor,
        "plastic_work_max_N_per_mm2": max(float(shot.work.max()) for shot in result.snapshots),
        "plastic_work_known_to_N_per_mm2": analysis.law.data.validity.plastic_work,
        "warnings": [asdict(warning) for warning in slice_warnings(analysis)],
        "loaded": at_surface(analysis, loaded),
        "released": at_surface(analysis, last) if released else None,
    }


def slice_warnings(analysis: SliceAnalysis) -> list[Warning]:
    """Warnings about the case, and about plastic work beyond the material's validity."""
    found = list(case_warnings(analysis.case, analysis.spring, analysis.law))
    limit = analysis.law.data.validity.plastic_work
    beyond = [shot for shot in analysis.result.snapshots if shot.work.max() > limit]
    if beyond:
        greatest = max(float(shot.work.max()) for shot in beyond)
        found.append(beyond_validity(greatest, limit, analysis.law.name, beyond[0].name))
    return found


def shear_inside(shot: SliceSnapshot) -> float:
    """Shear at the inside of the coil, MPa, positive as in a compressed spring, where τ13 points downward."""
    return 0.0 - float(shot.line[0, 4])


def at_surface(analysis: SliceAnalysis, shot: SliceSnapshot) -> dict:
    """Shear at the inside and the outside of the coil, maximum shear and equivalent stress at the surface.

    Shear is positive upward. A position is (ξ, η) in the unloaded section, mm.
    """
    surface, ends = analysis.lattice.surface, [0, -1]
    places = np.concatenate([analysis.lattice.places[surface], analysis.line.places[ends]])
    stress = np.concatenate([shot.stress[surface], shot.line[ends]])
    out = {
        "snapshot": shot.name,
        "force_N": shot.force,
        "shear_inside_MPa": float(shot.line[0, 4]),
        "shear_outside_MPa": float(shot.line[-1, 4]),
    }
    for name, values in (("shear", shear(stress)), ("equivalent_stress", mises(stress))):
        at = int(np.argmax(values))
        out |= {f"surface_{name}_max_MPa": float(values[at]), f"surface_{name}_max_at_mm": places[at].tolist()}
    return out
