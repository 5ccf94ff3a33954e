"""Did the spring buckle, at which travel and force? Read from its steps, so that a resumed run says the same."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

import numpy as np

from coilset.model.equilibrium.stability import vanishing
from coilset.model.results.record import Step

SIDEWAYS = 0.05  # of the mean diameter: an axis that has gone off so far has buckled, however gently
NEAR = (
    0.95  # of the critical travel: what goes off before is pushed by the ends of a helix that are no whole turns apart
)
WELL_ABOVE = 0.15  # of the first eigenvalue


@dataclass(frozen=True)
class Buckling:
    """Where a spring buckled.

    Attributes:
        travel_mm, force_N: where its least eigenvalue vanishes, or where it was first seen to have gone off.
        offset_mm: greatest distance of its axis from the straight one after that.
    """

    travel_mm: float
    force_N: float
    offset_mm: float


def buckling(steps: Sequence[Step], diameter: float) -> Buckling | None:
    """The Buckling that a run has seen, or None.

    Args:
        steps: Steps up to now.
        diameter: mean diameter of the coil, mm.
    """
    # Eigenvalues are asked for where a spring is slender enough to buckle. Where none is, its ends push the axis off.
    asked = any(step.least_eigenvalue is not None for step in steps)
    critical = critical_travel(steps) if asked else inf
    seen = next((k for k, step in enumerate(steps) if _has_buckled(step, diameter, critical)), None)
    if seen is None:
        return None
    before = steps[seen - 1].travel_mm if seen else 0.0
    travel = critical
    if not isfinite(travel) or not before <= travel <= steps[seen].travel_mm + (steps[seen].travel_mm - before):
        travel = steps[seen].travel_mm
    place = np.array([[0.0, 0.0], *((step.travel_mm, step.force_N) for step in steps[: seen + 1])])
    force = float(np.interp(travel, *place.T))
    return Buckling(travel, force, max(step.axis_offset_mm for step in steps[seen:]))


def critical_travel(steps: Sequence[Step]) -> float:
    """Travel at which the least eigenvalue of the straight spring vanishes, mm; NaN if its values do not tell.

    A spring whose axis goes off gently stays stable: its eigenvalue turns away from zero. So values are taken while
    they are well above zero, where there are enough of these.
    """
    values = [(step.travel_mm, value) for step in steps if (value := step.least_eigenvalue) is not None and value > 0.0]
    first = values[0][1] if values else 0.0
    falling = [point for point, last in zip(values, [(0.0, np.inf), *values], strict=False) if point[1] < last[1]]
    well_above = [point for point in falling if point[1] > WELL_ABOVE * first]
    return vanishing(well_above if len(well_above) >= 3 else falling)


def _has_buckled(step: Step, diameter: float, critical: float) -> bool:
    """Is it unstable, has it snapped, or has its axis gone off far, and not by the push of its ends long before?"""
    gone = step.axis_offset_mm > SIDEWAYS * diameter and not step.travel_mm < NEAR * critical
    return step.negative_pivots > 0 or step.left_branch > 0 or gone


def axis_offset(x: np.ndarray, start: np.ndarray, turns: np.ndarray) -> float:
    """Greatest distance by which the mean of a whole turn has moved sideways since the start, mm.

    Args:
        x, start: station positions now and at the start, shape (n, 3), mm.
        turns: of the stations, shape (n,).
    """
    if turns[-1] - turns[0] <= 1.5:
        return 0.0
    moved = (x - start)[:, :2]
    steps = 0.5 * np.diff(turns)[:, None] * (moved[1:] + moved[:-1])
    total = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    first = turns[turns <= turns[-1] - 1.0]
    mean = [np.interp(first + 1.0, turns, part) - np.interp(first, turns, part) for part in total.T]
    return float(np.hypot(*mean).max())
