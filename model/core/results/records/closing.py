"""Where the coils close: the last state of a compression to block before its characteristic becomes vertical."""

from collections.abc import Sequence
from typing import Any

from coilset.model.core.results.records.record import Setup, Step

VERTICAL = 20.0
"""Change of the force over that of the travel, both in per cent, from which a spring counts as standing on a wall: one
of constant rate has 1, the example at block 1.1, a cone 160."""


def steepness(before: Step, step: Step) -> float:
    """Change of the force from one step to the next over that of the travel, both in per cent of the latter's."""
    travel = step.travel_mm - before.travel_mm
    if not (travel and step.force_N):
        return 0.0
    return abs((step.force_N - before.force_N) / travel) * step.travel_mm / step.force_N


def closing(setup: Setup, steps: Sequence[Step]) -> Step | None:
    """The last step before the vertical of the last compression to block; None where there is no such compression, or
    it is not vertical at its end."""
    ends = [k for k, step in enumerate(steps) if step.progress >= 1.0 and setup.phases[step.phase] == "block"]
    if not ends:
        return None
    phase, last = steps[ends[-1]].phase, ends[-1]
    for k in range(last, 0, -1):
        if steps[k - 1].phase != phase:
            return None
        if steepness(steps[k - 1], steps[k]) <= VERTICAL:
            return steps[k] if k < last else None
    return None


def stands_on_wall(setup: Setup, steps: Sequence[Step]) -> bool:
    """Whether the greatest force is one behind the closing of the coils, on which small errors of height weigh much."""
    top = max(steps, key=lambda step: abs(step.force_N), default=None)
    return top is not None and setup.phases[top.phase] == "block" and closing(setup, steps) is not None


def closing_entries(setup: Setup, steps: Sequence[Step]) -> dict[str, Any]:
    """Entries of the summary."""
    step = closing(setup, steps)
    return {
        "closing_force_N": step.force_N if step else None,
        "closing_height_mm": step.seat_height_mm if step else None,
        "estimated_closing_force_error_N": step.estimated_force_error_N if step else None,
    }
