"""Rates of a spring from its characteristic: as spring makers measure it, at given travels, in torsion and tension."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import dropwhile
from typing import Any

import numpy as np

from coilset.model.core.base.between_steps import MAKERS, Between, part
from coilset.model.core.results.records.record import Result, Setup, Step
from coilset.model.core.results.records.releases import FREE, LEAST_TURN, Release, is_turned

FEW = 3  # open steps that show a line and how it bends
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
        height = release.step.seat_height_mm  # of its path, on which the ends are held
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
    first = next(step for step in steps if abs(step.turn_deg) > LEAST_TURN)
    after = None
    if release is not None:
        faint = FREE * max(abs(step.torque_Nmm) for step in steps)
        loaded = [step for step in steps if step.phase < release.phase and abs(step.torque_Nmm) > faint]
        if loaded and loaded[-1].turn_deg != release.step.turn_deg:
            freed = loaded[-1].turn_deg - release.step.turn_deg
            after = (loaded[-1].torque_Nmm - release.step.torque_Nmm) / freed
    values = (
        max((step.turn_deg for step in steps), key=abs),
        max((step.torque_Nmm for step in steps), key=abs),
        first.torque_Nmm / first.turn_deg,
        after,
        release.snapshot.turn if release else None,
    )
    return dict(zip(names, values, strict=True))


@dataclass(frozen=True)
class Held:
    """The initial tension F0 of coils that are wound onto each other, where a curve bends as they open.

    Attributes:
        force: F0, N; rate: of the open spring beside it, N/mm; both None where they cannot be determined.
        error: estimated size of the error of F0, N; None where it is not known.
        points: open steps that show it.
    """

    force: float | None = None
    rate: float | None = None
    error: float | None = None
    points: int = 0


def tensions(result: Result, release: Release | None) -> tuple[Held, Held | None]:
    """F0 in the first pull, and by the last release, None without one; 0 if the coils stay open then.

    The line of the open spring is that through the two open steps next to where the coils open or close. The line of
    the closed one begins at the spring free of load, at the initial rate. They meet at F0. Closed coils stiffen a
    little as they are pulled: what steps before the opening show of this counts as error.
    """
    steps, rate = result.steps, result.rate
    opens = next((k for k, step in enumerate(steps) if _is_open(step)), len(steps))
    closed = [one.force_N / one.travel_mm for one in steps[:opens] if one.travel_mm < 0.0]
    if not rate > 0.0:  # or unknown: the first step in which coils touch shows it
        rate = closed[0] if closed else math.nan
    stiffest = max([rate, *closed])
    first = _held(_going_on(steps[opens:]), 0.0, rate, stiffest)
    if release is None:
        return first, None
    if not release.step.contacts:
        return first, Held(0.0, None, 0.0, FEW)
    back = list(dropwhile(lambda step: not _is_open(step), steps[release.step.number - 1 :: -1]))
    return first, _held(_going_on(back), -release.step.travel_mm, rate, stiffest)


def _is_open(step: Step) -> bool:
    return step.force_N < 0.0 and not step.contacts


def _going_on(steps: Sequence[Step]) -> list[Step]:
    """The first open steps, of which each is longer than the one before; as many as show a line and its bend."""
    found: list[Step] = []
    for step in steps:
        if len(found) == FEW or not _is_open(step) or (found and step.travel_mm >= found[-1].travel_mm):
            break
        found.append(step)
    return found


def _held(opened: Sequence[Step], free: float, closed: float, stiffest: float) -> Held:
    """F0 by open steps, the nearest one first.

    A third one shows how far the line bends on the way back to F0; with the error of the force this is that of F0.

    Args:
        opened: at most FEW of them.
        free: extension of the spring free of load, mm.
        closed, stiffest: rate of the closed coils, N/mm, and the greatest that steps show.
    """
    points = len(opened)
    if points < 2 or not closed > 0.0:
        return Held(points=points)
    (a, f), (b, g) = ((-step.travel_mm - free, -step.force_N) for step in opened[:2])
    rate = (g - f) / (b - a)
    if rate >= closed:
        return Held(points=points)
    force, other = (max((f - rate * a) / (1.0 - rate / one), 0.0) for one in (closed, stiffest))
    known = opened[0].estimated_force_error_N
    if points < FEW or known is None:
        return Held(force, rate, None, points)
    c, h = -opened[2].travel_mm - free, -opened[2].force_N
    bend = ((h - g) / (c - b) - rate) / (c - a) * (force / closed - a) * (force / closed - b)
    return Held(force, rate, (abs(bend) + known) / (1.0 - rate / closed) + abs(force - other), points)


def tension(setup: Setup, result: Result, release: Release | None) -> dict[str, Any]:
    """Entries of the summary of a spring whose coils are wound onto each other; None of any other."""
    first, after = tensions(result, release) if setup.initial_tension else (Held(), None)
    return {
        "initial_tension_given_N": setup.initial_tension or None,
        "initial_tension_N": first.force,
        "estimated_initial_tension_error_N": first.error,
        "initial_tension_after_N": after and after.force,
        "estimated_initial_tension_after_error_N": after and after.error,
        "open_rate_N_per_mm": first.rate,
    }
