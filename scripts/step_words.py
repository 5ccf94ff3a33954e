"""The words for steps and quantities that commands print alike."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from coilset.model.results.record import Step
    from coilset.model.slice.analysis import SliceStep

HEAD = f"{'step':>5}{'height/mm':>10}{'force/N':>12}{'iter.':>6}"  # of `step_row`


def step_row(step: "Step | SliceStep") -> str:
    """What the steps of rod and slice have in common, under HEAD."""
    force = without_minus(step.force_N, 3)
    return f"{step.number:5d}{step.seat_height_mm:10.4f}{force:>12}{step.iterations:6d}"


def quantity(value: float | None, unit: str, digits: int = 4) -> str:
    """A value with its unit; in words if there is none."""
    return "not reached" if value is None else f"{without_minus(value, digits)} {unit}"


def without_minus(value: float, digits: int) -> str:
    """A value in so many decimals, and no -0.0."""
    return f"{round(value, digits) + 0.0:.{digits}f}"
