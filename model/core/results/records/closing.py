"""Where the coils close: the last state of a compression to block before its characteristic becomes vertical."""

from collections.abc import Sequence
from typing import Any

from coilset.model.core.results.records.record import Setup, Step

VERTICAL = 20.0
"""Change of the force over that of the travel, both in per cent, from which a spring counts as standing on a wall: one
of constant rate has 1, the example at block 1.1, a cone 160."""
UNCERTAIN = 0.05  # of the force: an error from which it is one on a wall, too
ROUNDING = 1e-9  # of the block height


def steepness(travels: Sequence[float], forces: Sequence[float], k: int) -> float:
    """Change of the force up to number k of a curve over that of the travel, both in per cent of those at k."""
    travel, force = travels[k] - travels[k - 1], forces[k] - forces[k - 1]
    return abs(force / travel) * travels[k] / forces[k] if travel and forces[k] else 0.0


def before_vertical(travels: Sequence[float], forces: Sequence[float], errors: Sequence[float | None]) -> int | None:
    """Number of the last point of a compression before it becomes vertical; None if it is not at its end, or always.

    Where steps are too long to show it, the error of the force does: on a wall small errors of height weigh much.
    """
    for k in range(len(travels) - 1, -1, -1):
        steep = k > 0 and steepness(travels, forces, k) > VERTICAL
        if not steep and (errors[k] or 0.0) <= UNCERTAIN * abs(forces[k]):
            return k if k < len(travels) - 1 else None
    return None


def closing(setup: Setup, steps: Sequence[Step]) -> Step | None:
    """The last step before the vertical of the last compression to block; None where there is no such compression, or
    it is not vertical at its end."""
    ends = [k for k, step in enumerate(steps) if step.progress >= 1.0 and is_at_block(setup, step)]
    if not ends:
        return None
    first = last = ends[-1]
    while first > 0 and steps[first - 1].travel_mm < steps[first].travel_mm:
        first -= 1
    way = steps[first : last + 1]
    found = before_vertical(
        *zip(*((one.travel_mm, one.force_N, one.estimated_force_error_N) for one in way), strict=True)
    )
    return None if found is None else way[found]


def is_at_block(setup: Setup, step: Step) -> bool:
    """Whether a step is at block, or is on the way to it."""
    return setup.phases[step.phase] == "block" or step.seat_height_mm <= setup.spring.block_height * (1.0 + ROUNDING)


def stands_on_wall(setup: Setup, steps: Sequence[Step]) -> bool:
    """Whether the greatest force is one behind the closing of the coils, on which small errors of height weigh much."""
    top = max(steps, key=lambda step: abs(step.force_N), default=None)
    return top is not None and is_at_block(setup, top) and closing(setup, steps) is not None


def closing_entries(setup: Setup, steps: Sequence[Step]) -> dict[str, Any]:
    """Entries of the summary."""
    step = closing(setup, steps)
    return {
        "closing_force_N": step.force_N if step else None,
        "closing_height_mm": step.seat_height_mm if step else None,
        "estimated_closing_force_error_N": step.estimated_force_error_N if step else None,
    }
