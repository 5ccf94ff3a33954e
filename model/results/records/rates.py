"""Rates of a spring from its characteristic: as spring makers measure it, at given travels, in torsion and tension."""

from collections.abc import Sequence
from itertools import dropwhile
from typing import Any

import numpy as np

from coilset.model.base.between_steps import Between, part
from coilset.model.results.records.record import Result, Setup, Step
from coilset.model.results.records.releases import Release, is_turned

MAKERS = (0.3, 0.7)  # of the travel to block, between which EN 15800 measures the rate
STANDS = 1e-9  # of the greatest travel and force: a step that changes both by less changes nothing


def first_compression(steps: Sequence[Step]) -> Between:
    """The curve from the start to the first release; a free spring may be heated before."""
    pressed = dropwhile(lambda step: step.travel_mm <= 0.0, steps)
    return _ascending([(step.travel_mm, step.force_N, step.contacts) for step in pressed])


def finished(steps: Sequence[Step], phase: int, height: float, whole: float = 0.0) -> Between:
    """The curve of the finished spring, after a release that ended at a seat height, mm.

    That of the compression after the released phase, if it covers what `makers_rate` needs of the travel `whole` to
    block; else that of the release, backwards.
    """
    before = [step for step in steps if step.phase <= phase]
    later = [step for step in steps if step.phase > phase]
    compression, release = (
        _ascending([(height - step.seat_height_mm, step.force_N, step.contacts) for step in path], path is later)
        for path in (later, before[-2::-1])
    )
    return compression if later and compression.travel[-1] >= MAKERS[1] * whole else release


def _ascending(points: Sequence[tuple[float, float, int]], in_time: bool = True) -> Between:
    """The curve from 0 on, as far as the travel grows; points that repeat the one before are left out.

    The release behind it shows the rate at its end, if the points are given as they followed each other `in_time`.
    """
    least = STANDS * np.abs(np.reshape(points, (-1, 3))).max(axis=0, initial=0.0)[:2]
    found, behind = [(0.0, 0.0, points[0][2] if points else 0)], list[tuple[float, float, int]]()
    for point in points:
        if np.all(np.abs(np.subtract(point[:2], found[-1][:2])) <= least):
            continue
        if point[0] <= found[-1][0]:
            behind = [point] * in_time
            break
        found.append(point)
    travel, force, contacts = np.array([*found, *behind], float).T
    return part(travel, force, contacts, 0, len(found) - 1)


def makers_rate(curve: Between, whole: float) -> float | None:
    """Force over travel between 30 and 70 % of the travel to block, N/mm; None if the curve does not extend that far.

    Args:
        curve: of the spring.
        whole: travel to block, mm.
    """
    low, high = (share * whole for share in MAKERS)
    if whole <= 0.0 or curve.travel[-1] < high:
        return None
    return (curve.at(high)[0] - curve.at(low)[0]) / (high - low)


def _force_and_rate(curve: Between, travel: float) -> tuple[float | None, float | None]:
    """Force, N, and rate, N/mm, at a travel; None beyond the curve."""
    return curve.at(travel)[:2] if len(curve.travel) > 1 and travel <= curve.travel[-1] else (None, None)


def rates(setup: Setup, result: Result, release: Release | None) -> dict[str, Any]:
    """Entries of the summary: the rate between 30 and 70 % of the travel to block, before and after the last release,
    and the requested rates."""
    curve = first_compression(result.steps)
    block, after = setup.spring.block_height, None
    if release is not None:
        height = release.snapshot.height
        after = makers_rate(finished(result.steps, release.phase, height, height - block), height - block)
    return {
        "rate_30_70_N_per_mm": makers_rate(curve, setup.spring.free_length - block),
        "rate_30_70_after_N_per_mm": after,
        "rates": tuple(
            {"travel_mm": at, "force_N": force, "rate_N_per_mm": rate}
            for at in setup.rates_at
            for force, rate in [_force_and_rate(curve, at)]
        ),
    }


def turning(setup: Setup, result: Result, release: Release | None) -> dict[str, Any]:
    """Entries of the summary of a spring that is loaded by a torque about its axis; None of any other."""
    names = "turn_max_deg", "torque_max_Nmm", "turn_rate_Nmm_per_deg", "turn_rate_after_Nmm_per_deg", "turn_set_deg"
    if not is_turned(setup, result.steps):
        return dict.fromkeys(names)
    steps = result.steps
    first = next(step for step in steps if step.turn_deg)
    after = None
    if release is not None:
        loaded = [step for step in steps if step.phase < release.phase]
        if loaded and loaded[-1].turn_deg != release.step.turn_deg:
            freed = loaded[-1].turn_deg - release.step.turn_deg
            after = (loaded[-1].torque_Nmm - release.step.torque_Nmm) / freed
    values = (
        max((step.turn_deg for step in steps), key=abs),
        max((step.torque_Nmm for step in steps), key=abs),
        first.torque_Nmm / first.turn_deg,
        after,
        release.step.turn_deg if release else None,
    )
    return dict(zip(names, values, strict=True))


def tension(setup: Setup, result: Result, release: Release | None) -> dict[str, Any]:
    """Entries of the summary of a spring whose coils are wound onto each other: F0 before and after, N, and rate.

    The line of an open spring, F = a + R s, by the first two steps without contact, and by the last two of the last
    release, is followed back to that of the closed one, s = c F by the first step in which coils touch, or by the
    initial rate: there F0 = a/(1 − R c). c is that of hooks and of coils that press on each other.
    """
    names = "initial_tension_N", "initial_tension_after_N", "open_rate_N_per_mm"
    if not setup.wound_solid:
        return dict.fromkeys(names)
    pulled = [step for step in result.steps if step.force_N < 0.0 and not step.contacts]
    before, rate = _line([step for step in pulled if step.phase == pulled[0].phase][:2] if pulled else [])
    touching = next((step for step in result.steps if step.force_N < 0.0 and step.contacts), None)
    closed = touching.travel_mm / touching.force_N if touching else 1.0 / result.rate if result.rate > 0.0 else 0.0
    if before is not None and rate is not None:
        before /= 1.0 - rate * closed
    after = None
    if release is not None:
        back = [step for step in result.steps if step.phase == release.phase and not step.contacts]
        after, back_rate = _line(back[-2:])
        if after is not None and back_rate is not None:
            after /= 1.0 - back_rate * closed
    return dict(zip(names, (before, None if after is None else max(after, 0.0), rate), strict=True))


def _line(steps: Sequence[Step]) -> tuple[float | None, float | None]:
    """Pull at no travel, N, and rate, N/mm, of the line through two steps; None without two."""
    if len(steps) < 2 or steps[0].travel_mm == steps[1].travel_mm:
        return None, None
    (a, f), (b, g) = ((step.travel_mm, step.force_N) for step in steps)
    rate = (g - f) / (b - a)
    return rate * a - f, rate
