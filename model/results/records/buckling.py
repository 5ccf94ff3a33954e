"""Whether the spring buckled, and at which travel and force, from its steps, so that a resumed run agrees."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite, nan

import numpy as np

from coilset.model.results.records.record import Step

SIDEWAYS = 0.05  # of the mean diameter: an axis that has deflected this far has buckled, however gradually
NEAR = 0.95  # of the critical travel: an earlier deflection is due to ends that are not a whole number of turns apart
FALLEN = 0.5  # of the first eigenvalue
APART = 0.04  # of the first eigenvalue: values closer to each other say little about the next ones
# Of force times mean diameter. Springs that snapped set 3e-6 and more free; coils that slide over each other set 2e-10
# free and less where they pass from one cubic of the wire's curve to the next, whose curvature jumps there.
SNAPPED = 1e-8


@dataclass(frozen=True)
class Buckling:
    """Where a spring buckled.

    Attributes:
        travel_mm, force_N: where its lowest eigenvalue vanishes, or where a deflection was first seen.
        offset_mm: maximum distance of its axis from the straight one after that.
    """

    travel_mm: float
    force_N: float
    offset_mm: float


def buckling(steps: Sequence[Step], diameter: float) -> Buckling | None:
    """The Buckling found in a run, or None.

    Args:
        steps: Steps up to now.
        diameter: mean diameter of the coil, mm.
    """
    # Eigenvalues are computed if a spring is slender enough to buckle. If there are none, its ends deflect the axis.
    asked = any(step.least_eigenvalue is not None for step in steps)
    critical = critical_travel(steps) if asked else inf
    seen = next((k for k, step in enumerate(steps) if _has_buckled(step, diameter, critical)), None)
    if seen is None:
        return None
    now, (before, force_before) = steps[seen], (0.0, 0.0)
    if seen:
        before, force_before = steps[seen - 1].travel_mm, steps[seen - 1].force_N
    travel, force = critical, now.force_N
    if not isfinite(travel) or not before <= travel <= now.travel_mm + (now.travel_mm - before):
        travel = now.travel_mm
    elif travel < now.travel_mm:  # between these two steps: an earlier loading may have passed it too
        force = float(np.interp(travel, [before, now.travel_mm], [force_before, now.force_N]))
    return Buckling(travel, force, max(step.axis_offset_mm for step in steps[seen:]))


def critical_travel(steps: Sequence[Step]) -> float:
    """Travel at which the lowest eigenvalue of the straight spring vanishes, mm; NaN if it cannot be determined.

    A spring whose axis deflects gradually stays stable: its eigenvalue turns away from zero, and every parabola from
    there on leads too far. So the least travel is taken of those to which parabolas through three values in a row
    lead, once the eigenvalue has fallen far enough for them to be short.
    """
    values = [(step.travel_mm, value) for step in steps if (value := step.least_eigenvalue) is not None and value > 0.0]
    first = values[0][1] if values else 0.0
    apart: list[tuple[float, float]] = []
    for travel, value in values:
        if not apart or value < apart[-1][1] - APART * first:
            apart.append((travel, value))
    travels = [vanishing(apart[:k]) for k in range(3, len(apart) + 1) if apart[k - 1][1] < FALLEN * first]
    return min((travel for travel in travels if isfinite(travel)), default=vanishing(apart))


def vanishing(points: Sequence[tuple[float, float]]) -> float:
    """Where the lowest eigenvalue vanishes, by a parabola through its last three values; NaN if it does not fall.

    Args:
        points: travel, mm, and eigenvalue of stable states, in the order of the path.
    """
    if len(points) < 3:
        return nan
    travel, values = np.array(points[-3:]).T
    ahead = np.roots(np.polyfit(travel - travel[-1], values, 2))
    ahead = ahead.real[(np.abs(ahead.imag) < 1e-12) & (ahead.real >= 0.0)]
    return float(travel[-1] + ahead.min()) if len(ahead) and values[-1] < values[-2] else nan


def _has_buckled(step: Step, diameter: float, critical: float) -> bool:
    """Whether it is unstable, has snapped through, or its axis has deflected far, other than by its ends."""
    gone = step.axis_offset_mm > SIDEWAYS * diameter and not step.travel_mm < NEAR * critical
    return step.negative_pivots > 0 or snapped(step, diameter) or gone


def snapped(step: Step, diameter: float) -> bool:
    """Whether the spring snapped through before this step and released a significant energy."""
    return step.left_branch > 0 and step.released_energy_Nmm > SNAPPED * abs(step.force_N) * diameter


def axis_offset(x: np.ndarray, start: np.ndarray, turns: np.ndarray) -> float:
    """Maximum distance by which the mean of a whole turn has moved sideways since the start, mm.

    Args:
        x, start: station positions now and at the start, shape (n, 3), mm.
        turns: of the stations, shape (n,).
    """
    if turns[-1] - turns[0] <= 1.5:
        return 0.0
    return float(np.hypot(*turn_means((x - start)[:, :2], turns).T).max())


def turn_means(values: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Means of values over the whole turn that begins at each station, as far as there is one, shape (m, columns).

    Args:
        values: at the stations, shape (n, columns).
        turns: of the stations, shape (n,), more than one.
    """
    first, total = turns[turns <= turns[-1] - 1.0], np.zeros(values.shape)
    np.cumsum(0.5 * np.diff(turns)[:, None] * (values[1:] + values[:-1]), axis=0, out=total[1:])
    return np.stack([np.interp(first + 1.0, turns, one) - np.interp(first, turns, one) for one in total.T], axis=1)
