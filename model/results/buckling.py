"""Did the spring buckle, at which travel and force? Read from its steps, so that a resumed run says the same."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np

from coilset.model.equilibrium.stability import vanishing
from coilset.model.results.record import Step

SIDEWAYS = 0.05  # of the mean diameter: an axis that has gone off so far has buckled, however gently


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
    seen = next((k for k, step in enumerate(steps) if _has_buckled(step, diameter)), None)
    if seen is None:
        return None
    values = [(step.travel_mm, step.least_eigenvalue) for step in steps[:seen] if isfinite(step.least_eigenvalue)]
    before = steps[seen - 1].travel_mm if seen else 0.0
    travel = vanishing([point for point in values if point[1] > 0.0])
    if not isfinite(travel) or not before <= travel <= steps[seen].travel_mm + (steps[seen].travel_mm - before):
        travel = steps[seen].travel_mm
    place = np.array([[0.0, 0.0], *((step.travel_mm, step.force_N) for step in steps[: seen + 1])])
    force = float(np.interp(travel, *place.T))
    return Buckling(travel, force, max(step.axis_offset_mm for step in steps[seen:]))


def _has_buckled(step: Step, diameter: float) -> bool:
    return step.negative_pivots > 0 or step.left_branch > 0 or step.axis_offset_mm > SIDEWAYS * diameter


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
