"""What stability adds to a run: where the spring buckled, and warnings of unstable, bowed and leaning springs."""

from collections.abc import Iterator
from math import isfinite
from typing import Any

from coilset.model.core.base.warning import Warning
from coilset.model.core.results.records.part import Part, place_of
from coilset.model.core.results.records.record import Result, Setup
from coilset.model.core.results.records.releases import is_turned
from coilset.model.physics.stability.buckling import SIDEWAYS, buckling, leaning, snapped


def _numbers(setup: Setup, result: Result) -> dict[str, Any]:
    found = buckling(result.steps, setup.spring.mean_diameter)
    return {
        "buckled": found is not None,
        "buckling_travel_mm": found.travel_mm if found else None,
        "buckling_force_N": found.force_N if found else None,
        "unstable_steps": sum(step.negative_pivots > 0 for step in result.steps),
    }


def _buckled(setup: Setup, result: Result) -> Iterator[Warning]:
    found, limit = buckling(result.steps, setup.spring.mean_diameter), setup.buckling_travel
    if found is not None:
        formula = f"at {limit:.4g} mm" if isfinite(limit) else "never, as long as the wire is elastic"
        message = (
            f"the spring buckled at a travel of {found.travel_mm:.4g} mm and {found.force_N:.4g} N, and its axis went "
            f"up to {found.offset_mm:.3g} mm aside (EN 13906-1: {formula}); the results beyond are for the buckled "
            "shape"
        )
        place = f"travel {found.travel_mm:.4g} mm"
        yield Warning("buckled", place, message, found.travel_mm, limit if isfinite(limit) else None, "mm")


def _unstable(setup: Setup, result: Result) -> Iterator[Warning]:
    unstable = [step for step in result.steps if step.negative_pivots > 0]
    if unstable:
        message = (
            f"{len(unstable)} steps ended in unstable equilibria with no stable one nearby: there are several "
            "branches, and smaller steps may find another"
        )
        yield Warning("unstable", place_of(unstable[0]), message, len(unstable), 0.0)


def _snapped(setup: Setup, result: Result) -> Iterator[Warning]:
    before = [0.0, *(step.force_N for step in result.steps)]
    pairs, diameter = zip(before, result.steps, strict=False), setup.spring.mean_diameter
    snaps = [(force, step) for force, step in pairs if snapped(step, diameter)]
    if snaps:
        force, step = max(snaps, key=lambda snap: snap[1].released_energy_Nmm)
        times = "" if len(snaps) == 1 else f", {len(snaps)} times in all"
        message = (
            f"the spring snapped through at a travel of {step.travel_mm:.5g} mm, from {force:.5g} N to "
            f"{step.force_N:.5g} N, and released {step.released_energy_Nmm:.2g} N mm{times}: several branches exist, "
            "and the one reached by slow snap-through was kept"
        )
        yield Warning("snapped", place_of(step), message, step.released_energy_Nmm, 0.0, "N mm")


def _leans(setup: Setup, result: Result) -> Iterator[Warning]:
    if not setup.spring.is_straight or is_turned(setup, result.steps):  # drawn so, or pushed aside by its arms
        return
    far = leaning(result.steps, setup.spring.mean_diameter)
    if far is not None:
        offset, place = far.axis_offset_mm, place_of(far)
        message = (
            f"the spring leans without buckling: its axis is up to {offset:.3g} mm aside, at a travel of "
            f"{far.travel_mm:.4g} mm, {100.0 * offset / setup.spring.mean_diameter:.2g} % of its mean diameter"
        )
        yield Warning("leans", place, message, offset, SIDEWAYS * setup.spring.mean_diameter, "mm")


PART = Part(numbers=_numbers, seen=(_buckled, _unstable, _snapped), found=(_leans,))
