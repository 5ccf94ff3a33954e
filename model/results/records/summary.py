"""The summary of a run."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any

import numpy as np

from coilset.model.base.errors import InputError
from coilset.model.results.fatigue import fatigue
from coilset.model.results.limits import judged, limit_warnings
from coilset.model.results.records.buckling import buckling
from coilset.model.results.records.rates import rates, tension, turning
from coilset.model.results.records.record import Errors, Result, Setup, Snapshot
from coilset.model.results.records.releases import Release, is_turned, releases
from coilset.model.results.records.summary_entries import Summary
from coilset.model.results.records.warnings import run_warnings
from coilset.model.results.records.working import LINE, WorkingState, plastic_rise, working_numbers
from coilset.model.section import surface
from coilset.model.standards import en13906
from coilset.model.standards.cylinder import Cylinder

CROSSINGS = tuple(name for name in LINE if name.startswith("line_"))


def summarise(setup: Setup, result: Result) -> dict[str, Any]:
    """The Summary of a run as plain data, as in summary.json, with the numbers of working states; see `summary`."""
    made = summary(setup, result)
    plain = {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(made).items()}
    numbers = working_numbers(made.working)
    entries = judged(setup.bounds, plain | numbers) if result.complete else ()
    outside = [asdict(warning) for warning in limit_warnings(entries)]
    return plain | {"limits": list(entries), "warnings": [*plain["warnings"], *outside]} | numbers


def summary(setup: Setup, result: Result) -> Summary:
    """The summary of a run; free length, set and residual stress are those after the last release.

    Args:
        setup: Setup.
        result: Result, complete or not; its snapshots are complete on rank 0 only.
    """
    freed = releases(setup, result)
    release = freed[-1] if freed else None
    shot = release.snapshot if release else None
    residual = shear_peak(setup, shot) if shot else None
    inside, inside_turn = shear_inside(setup, shot) if shot else (None, None)
    axis, buckled = setup.spring.measured_axis, buckling(result.steps, setup.mean_diameter)
    return Summary(
        complete=result.complete,
        free_length_before_mm=setup.spring.free_length,
        free_length_after_mm=release.free_length if release else None,
        set_mm=release.set if release else None,
        releases=tuple(_release(one) for one in freed),
        rate_N_per_mm=result.rate if isfinite(result.rate) else None,
        **rates(setup, result, release),
        force_max_N=max((step.force_N for step in result.steps), default=0.0, key=abs),
        block_height_mm=setup.spring.block_height,
        residual_shear_max_MPa=residual.value if residual else None,
        residual_shear_max_turn=residual.turn if residual else None,
        residual_shear_max_angle_deg=residual.angle if residual else None,
        shear_max_MPa=max(shear_peak(setup, one).value for one in result.snapshots),
        **ends_peak(setup, shot),
        residual_shear_inside_MPa=inside,
        residual_shear_inside_turn=inside_turn,
        shear_inside_max_MPa=max(shear_inside(setup, one)[0] for one in result.snapshots),
        **peaks(setup, "residual_", [shot] if shot else []),
        **peaks(setup, "", result.snapshots),
        **bending(setup, "residual_", [shot] if shot else []),
        **bending(setup, "max_", result.snapshots),
        **beyond_coil(setup, shot, result.snapshots),
        inner_diameter_min_mm=min(inner_diameter(setup, one) for one in result.snapshots),
        **turning(setup, result, release),
        **tension(setup, result, release),
        **plastic_work(setup, result),
        **estimated_errors(setup, result),
        working=working_entries(setup, result),
        working_set_mm=result.working.set if result.working else None,
        fatigue=fatigue(setup, result),
        limits=(),
        load_loss_percent=load_loss(result),
        coiling_diameter_mm=setup.coiling_diameter,
        measured_axis_offset_mm=axis.offset if axis else None,
        measured_axis_tilt_deg=axis.tilt if axis else None,
        steps=len(result.steps),
        iterations=sum(step.iterations for step in result.steps),
        evaluations=sum(step.evaluations for step in result.steps),
        failed_solves=sum(step.failed_solves for step in result.steps),
        material=setup.material,
        ends=setup.ends,
        unstable_steps=sum(step.negative_pivots > 0 for step in result.steps),
        buckled=buckled is not None,
        buckling_travel_mm=buckled.travel_mm if buckled else None,
        buckling_force_N=buckled.force_N if buckled else None,
        buckling_travel_EN_13906_1_mm=setup.buckling_travel if isfinite(setup.buckling_travel) else None,
        elements=len(setup.turns) - 1,
        section_kind=setup.section_kind,
        section_rule=setup.rule.name,
        lift_off_max_mm=max((step.lift_off_mm for step in result.steps), default=0.0),
        warnings=tuple(run_warnings(setup, result)),
    )


def load_loss(result: Result) -> float | None:
    """Percentage of the force that the spring had lost when time last passed at constant height."""
    losses = [step.load_loss_percent for step in result.steps if step.load_loss_percent is not None]
    return losses[-1] if losses else None


def _release(release: Release) -> dict[str, Any]:
    return {
        "phase": release.phase + 1,
        "step": release.step.number,
        "free_length_mm": release.free_length,
        "set_mm": release.set,
    }


def estimated_errors(setup: Setup, result: Result) -> dict[str, Any]:
    """Errors of maximum force, set and residual shear: in total, and by their causes; None where not estimated.

    Nor are they in torsion, where axial force and loss of length are close to zero.
    """
    errors = None if is_turned(setup, result.steps) else result.errors
    total = Errors(None, None, None) if errors is None else errors.total
    return {
        "estimated_force_error_N": total.force_N,
        "estimated_set_error_mm": total.set_mm,
        "estimated_residual_shear_inside_error_MPa": total.residual_shear_inside_MPa,
        "estimated_errors": errors,
    }


def is_middle(setup: Setup) -> np.ndarray:
    """Whether sections are in the middle turns: a turn from the tips, or from the end coils of closed ends."""
    spring = setup.spring
    first, last = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    return surface.is_middle(setup.section_turns, first, last)


def shear_peak(setup: Setup, snapshot: Snapshot, ends: bool = False) -> surface.Peak:
    """The maximum shear stress on the wire's surface in the middle turns or, on request, in the end turns.

    The surface value is a property of the spring. The core holds a larger residual shear stress, but the value found
    there depends on the position of the section points.
    """
    among = is_middle(setup) != ends
    stress = surface.shear(snapshot.surface_state, snapshot.components)
    return surface.peak(stress[among], setup.section_turns[among], setup.inside)


def ends_peak(setup: Setup, snapshot: Snapshot | None) -> dict[str, Any]:
    """The maximum residual shear on the ends' surface, MPa, its turn and its angle from the coil's inside, degrees.

    None before the release, and of half a turn or less, all of which is its middle.
    """
    top = None if snapshot is None or is_middle(setup).all() else shear_peak(setup, snapshot, ends=True)
    value, turn, angle = (None,) * 3 if top is None else (top.value, top.turn, top.angle)
    return {
        "residual_shear_ends_max_MPa": value,
        "residual_shear_ends_max_turn": turn,
        "residual_shear_ends_max_angle_deg": angle,
    }


def shear_inside(setup: Setup, snapshot: Snapshot) -> tuple[float, float]:
    """Shear stress on the wire's surface at the inside of the coil, MPa, positive as in a compressed spring; its turn.

    The value of largest magnitude in the middle turns; of several that are equal but for rounding, as in a spring whose
    halves are alike, the first.
    """
    among = is_middle(setup)
    values = setup.inside.shear(snapshot.surface_state, snapshot.components)[among]
    size = np.abs(values)
    at = int(np.argmax(size >= (1.0 - surface.TIE) * size.max()))
    return float(values[at]), float(setup.section_turns[among][at])


def bending(setup: Setup, prefix: str, snapshots: Sequence[Snapshot]) -> dict[str, Any]:
    """Stress along the wire on the surface at the inside and the outside of the coil, MPa, positive in tension.

    Of each the value of largest magnitude in the middle turns and the snapshots; None without snapshots.
    """
    found: dict[str, Any] = {}
    for name, angle in (("inside", 0.0), ("outside", math.pi)):
        values = []
        for shot in snapshots:
            along = surface.component(shot.surface_state, shot.components, "s11")[is_middle(setup)]
            place = round((setup.inside.angle + angle) / (2.0 * math.pi) * along.shape[-1]) % along.shape[-1]
            values += [float(along[..., place].min()), float(along[..., place].max())]
        found[f"{prefix}bending_{name}_MPa"] = max(values, key=abs, default=None)
    return found


def beyond_coil(setup: Setup, released: Snapshot | None, snapshots: Sequence[Snapshot]) -> dict[str, Any]:
    """Stress along the wire of hooks or arms, MPa, positive in tension, and its turn; the residual one at that place.

    The value of largest magnitude on their surface in any snapshot; None without hooks or arms.
    """
    names = "tail_stress_max_MPa", "tail_stress_max_turn", "residual_tail_stress_MPa"
    among = (setup.section_turns < 0.0) | (setup.section_turns > setup.spring.turns)
    if not among.any():
        return dict.fromkeys(names)

    def along(shot: Snapshot) -> np.ndarray:
        return surface.component(shot.surface_state, shot.components, "s11")[among]

    stress = max(map(along, snapshots), key=lambda values: float(np.abs(values).max()))
    at, angle = np.unravel_index(np.abs(stress).argmax(), stress.shape)
    residual = None if released is None else float(along(released)[at, angle])
    return dict(zip(names, (float(stress[at, angle]), float(setup.section_turns[among][at]), residual), strict=True))


def inner_diameter(setup: Setup, snapshot: Snapshot) -> float:
    """Diameter of the largest arbor about the axis that the coils leave room for, mm."""
    coil = (setup.turns >= 0.0) & (setup.turns <= setup.spring.turns)
    radius = 0.5 * setup.spring.wire_diameter(setup.turns[coil])
    return 2.0 * float((np.hypot(*snapshot.x[coil, :2].T) - radius).min())


def peaks(setup: Setup, prefix: str, snapshots: Sequence[Snapshot]) -> dict[str, Any]:
    """The maximum shear and equivalent stress on the surface in the snapshots, MPa, and where: turn, and angle from
    the inside of the coil, degrees; None without snapshots."""
    found = {}
    for name, stress in (("shear", surface.shear), ("equivalent", surface.equivalent)):
        tops = [
            surface.peak(stress(shot.surface_state, shot.components), setup.section_turns, setup.inside)
            for shot in snapshots
        ]
        top = max(tops, key=lambda one: one.value, default=None)
        for unit, value in (("MPa", "value"), ("turn", "turn"), ("angle_deg", "angle")):
            found[f"{prefix}{name}_surface_max_{unit}"] = getattr(top, value) if top else None
    return found


def plastic_work(setup: Setup, result: Result) -> dict[str, Any]:
    """The maximum plastic work b* on the surface, where it is, and up to which the material's constants are valid."""
    tops = [
        surface.peak(surface.component(shot.surface_state, shot.components, "b"), setup.section_turns, setup.inside)
        for shot in result.snapshots
    ]
    top = max(tops, key=lambda one: one.value)
    return {
        "plastic_work_max_N_per_mm2": max([top.value, *(step.plastic_work_max_N_per_mm2 for step in result.steps)]),
        "plastic_work_max_turn": top.turn if top.value > 0.0 else None,
        "plastic_work_max_angle_deg": top.angle if top.value > 0.0 else None,
        "plastic_work_known_to_N_per_mm2": setup.limits.plastic_work,
    }


def working_entries(setup: Setup, result: Result) -> tuple[dict[str, Any], ...]:
    """Entries of summary.json, one for each working state."""
    if result.working is None:
        return ()
    return tuple(_entry(setup, result, state) for state in result.working.states)


def _entry(setup: Setup, result: Result, state: WorkingState) -> dict[str, Any]:
    shot, seats = state.snapshot, state.seats
    if shot is None or seats is None:
        return {f"{state.kind}_wanted": state.value, "reason": state.reason}
    stresses = nominal(setup, state.force)
    inside, turn = shear_inside(setup, shot)
    peak = shear_peak(setup, shot)
    return {
        f"{state.kind}_wanted": state.value,
        "reason": "",
        "length_mm": state.length,
        "force_N": state.force,
        "estimated_error": state.error,
        "rate_N_per_mm": state.rate if np.isfinite(state.rate) else None,
        "shear_MPa": stresses[0],
        "corrected_shear_MPa": stresses[1],
        "shear_inside_MPa": inside,
        "shear_inside_turn": turn,
        "shear_surface_MPa": peak.value,
        "shear_surface_turn": peak.turn,
        "shear_surface_angle_deg": peak.angle,
        "allowed_MPa": setup.limits.shear,
        "allowed_of": setup.limits.shear_of if setup.limits.shear else "",
        "safety": _safety(setup, *stresses),
        "plastic_work_rise_N_per_mm2": plastic_rise(result, shot),
        "bottom_centre_x_mm": _known(seats.bottom.centre_x_mm),
        "bottom_centre_y_mm": _known(seats.bottom.centre_y_mm),
        "top_centre_x_mm": _known(seats.top.centre_x_mm),
        "top_centre_y_mm": _known(seats.top.centre_y_mm),
        "side_force_N": seats.side_force_N,
        **({} if setup.force_line is None else {f"{one}_mm": _known(getattr(seats, f"{one}_mm")) for one in CROSSINGS}),
    }


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None


def nominal(setup: Setup, force: float) -> tuple[float | None, float | None]:
    """τ = 8 D F/(π d³) and τk = k τ of EN 13906-1, or D F/(2 W) of wire that is not round, MPa.

    None of a spring that is no cylinder of one wire.
    """
    try:
        cylinder = Cylinder.of(setup.spring)
    except InputError:
        return None, None
    stress = en13906.stress(force, cylinder.of_stress, cylinder.D)
    return stress, cylinder.correction * stress


def _safety(setup: Setup, stress: float | None, corrected: float | None) -> float | None:
    """Allowed over nominal shear stress, whichever of the two is limited."""
    of = corrected if setup.limits.shear_of == "corrected stress" else stress
    return setup.limits.shear / abs(of) if setup.limits.shear is not None and of else None
