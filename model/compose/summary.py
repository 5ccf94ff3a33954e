"""The summary of a run."""

from dataclasses import asdict
from itertools import pairwise
from math import degrees, hypot, isfinite
from typing import Any

import numpy as np

from coilset.model.compose.parts import parts
from coilset.model.compose.run_warnings import run_warnings
from coilset.model.core.base.package import package
from coilset.model.core.results.records.closing import closing_entries
from coilset.model.core.results.records.rates import rates, tension, turning
from coilset.model.core.results.records.record import Errors, Result, Setup, Snapshot, Step
from coilset.model.core.results.records.releases import Release, releases, turned_radius
from coilset.model.core.results.records.summary_entries import Summary
from coilset.model.core.results.stresses import (
    bending,
    beyond_coil,
    ends_peak,
    peak_entries,
    peaks,
    plastic_work,
    shear_inside,
    shear_inside_median,
    shear_peak,
)

# The doors to numbers that a case asks for.
WORKING, LIMITS = "coilset.model.physics.working.working", "coilset.model.tools.limits.limits"


def summarise(setup: Setup, result: Result) -> dict[str, Any]:
    """The Summary of a run as plain data, as in summary.json, with the numbers of working states; see `summary`."""
    made = summary(setup, result)
    plain = {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(made).items()}
    numbers = package(WORKING, "a working length", "working").working_numbers(made.working) if made.working else {}
    if setup.bounds and result.complete:
        limits = package(LIMITS, "a limit", "limits")
        entries = limits.judged(setup.bounds, plain | numbers)
        outside = [asdict(warning) for warning in limits.limit_warnings(entries)]
        plain |= {"limits": list(entries), "warnings": [*plain["warnings"], *outside]}
    return plain | numbers


def summary(setup: Setup, result: Result) -> Summary:
    """The summary of a run, complete or not, on rank 0; free length, set and residual stress are those after the last
    release."""
    freed = releases(setup, result)
    release, top = freed[-1] if freed else None, result.top
    shot = release.snapshot if release else None
    inside, inside_turn = shear_inside(setup, shot) if shot else (None, None)
    losses, axis = load_losses(result), setup.spring.measured_axis
    added = {name: value for part in parts() for name, value in part.numbers(setup, result).items()}
    return Summary(
        complete=result.complete,
        free_length_before_mm=setup.spring.free_length,
        free_length_after_mm=release.free_length if release else None,
        set_mm=release.set if release else None,
        **held(setup, result, release),
        releases=tuple(_release(one) for one in freed),
        rate_N_per_mm=result.rate if isfinite(result.rate) else None,
        **rates(setup, result, release),
        force_max_N=top.force_N if top else 0.0,
        **closing_entries(setup, result.steps),
        force_max_is_given=top is not None and setup.is_force_given(top),
        force_max_height_mm=top.seat_height_mm if top else None,
        estimated_force_max_height_error_mm=top.estimated_height_error_mm if top else None,
        block_height_mm=setup.spring.block_height,
        **peak_entries("residual_shear_max", shear_peak(setup, shot) if shot else None),
        shear_max_MPa=max(shear_peak(setup, one).value for one in result.snapshots),
        **peak_entries("residual_shear_ends_max", ends_peak(setup, shot)),
        residual_shear_inside_MPa=inside,
        residual_shear_inside_turn=inside_turn,
        residual_shear_inside_median_MPa=shear_inside_median(setup, shot) if shot else None,
        shear_inside_max_MPa=max((shear_inside(setup, one)[0] for one in result.snapshots), key=abs),
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
        load_loss_percent=losses[-1]["loss_percent"] if losses else None,
        load_losses=losses,
        coiling_diameter_mm=setup.coiling_diameter,
        measured_axis_offset_mm=axis[0] if axis else None,
        measured_axis_tilt_deg=axis[1] if axis else None,
        steps=len(result.steps),
        iterations=sum(step.iterations for step in result.steps),
        evaluations=sum(step.evaluations for step in result.steps),
        failed_solves=sum(step.failed_solves for step in result.steps),
        material=setup.material,
        ends=setup.ends,
        elements=len(setup.turns) - 1,
        section_kind=setup.sections.kind,
        section_rule=setup.sections.rule,
        lift_off_max_mm=max((step.lift_off_mm for step in result.steps), default=0.0),
        warnings=tuple(run_warnings(setup, result)),
        **added,
    )


def held(setup: Setup, result: Result, release: Release | None) -> dict[str, Any]:
    """What the ends of a released spring held before they were let go; None of one that they hold, or without ends."""
    if release is None or not release.snapshot.free:
        return {"set_held_mm": None, "end_moment_held_Nmm": None}
    ends = [end for one in result.seats if one.step == release.step.number for end in (one.bottom, one.top)]
    moments = [abs(value) for end in ends for value in (hypot(end.moment_x_Nmm, end.moment_y_Nmm), end.moment_z_Nmm)]
    return {
        "set_held_mm": setup.spring.free_length - release.step.seat_height_mm,
        "end_moment_held_Nmm": max(moments, default=None),
    }


def load_losses(result: Result) -> tuple[dict[str, Any], ...]:
    """What the spring had lost of its force at the end of each time at constant height."""
    found: list[dict[str, Any]] = []
    before: Step | None = None
    for last, step in pairwise(result.steps):
        if step.load_loss_percent is None:
            before = None
            continue
        if before is None:
            before = last
            found.append({})
        found[-1] = {
            "height_mm": step.seat_height_mm,
            "step": step.number,
            "hours": step.hours - before.hours,
            "temperature_before_K": before.temperature_K,
            "temperature_after_K": step.temperature_K,
            "force_before_N": before.force_N,
            "force_after_N": step.force_N,
            "loss_percent": step.load_loss_percent,
        }
    return tuple(found)


def _release(release: Release) -> dict[str, Any]:
    return {
        "phase": release.phase + 1,
        "step": release.step.number,
        "free_length_mm": release.free_length,
        "set_mm": release.set,
    }


def estimated_errors(setup: Setup, result: Result) -> dict[str, Any]:
    """Errors of maximum force, set and residual shear: in total, and by their causes; None where not estimated.

    In torsion those of maximum torque, of the rotation under it, and of the set.
    """
    radius, errors, none = turned_radius(setup, result.steps), result.errors, Errors(None, None, None)
    total = none if errors is None else errors.total
    pressed, turned = (none, total) if radius else (total, none)
    top = max(result.steps, key=lambda step: abs(step.torque_Nmm)) if radius else None
    angle = None if top is None else top.estimated_height_error_mm
    return {
        "estimated_rate_error_N_per_mm": None if errors is None or radius else result.rate_error,
        "estimated_force_error_N": pressed.force_N,
        "estimated_set_error_mm": pressed.set_mm,
        "estimated_residual_shear_inside_error_MPa": pressed.residual_shear_inside_MPa,
        "torque_max_is_given": top is not None and setup.is_torque_given(top),
        "estimated_torque_error_Nmm": None if turned.force_N is None else radius * turned.force_N,
        "estimated_turn_error_deg": None if angle is None else degrees(angle / radius),
        "estimated_turn_set_error_deg": None if turned.set_mm is None else degrees(turned.set_mm / radius),
        "estimated_errors": errors,
    }


def inner_diameter(setup: Setup, snapshot: Snapshot) -> float:
    """Diameter of the largest arbor about the axis that the coils leave room for, mm."""
    coil = (setup.turns >= 0.0) & (setup.turns <= setup.spring.turns)
    radius = 0.5 * setup.spring.wire_diameter[coil]
    return 2.0 * float((np.hypot(*snapshot.x[coil, :2].T) - radius).min())
