"""The words for steps and quantities that commands print alike."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from coilset.model.results.records.record import ContactRecord, SeatReactions, Step
    from coilset.model.slice.analysis import SliceStep

HEAD = f"{'step':>5}{'height/mm':>10}{'force/N':>12}{'iter.':>6}"  # of `step_row`


def step_row(step: "Step | SliceStep") -> str:
    """What the steps of rod and slice have in common, under HEAD."""
    force = without_minus(step.force_N, 3)
    return f"{step.number:5d}{step.seat_height_mm:10.4f}{force:>12}{step.iterations:6d}"


def quantity(value: float | None, unit: str, digits: int = 4) -> str:
    """A value with its unit; `none` where the run gave none, as of a spring that was not released."""
    return "none" if value is None else f"{without_minus(value, digits)} {unit}"


def without_minus(value: float, digits: int) -> str:
    """A value in so many decimals, and no -0.0."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def contact_words(kinds: "Sequence[ContactRecord]", reactions: "SeatReactions") -> str:
    """Which kinds of contact press on the wire: `both seats, coils`, `bottom seat`, or `nothing touches`.

    Args:
        kinds: of the Setup.
        reactions: of the step.
    """
    names = [kinds[number].name for number in sorted({int(row[0]) for row in reactions.pressure if row[2] > 0.0})]
    if {"bottom seat", "top seat"} <= set(names):
        names = ["both seats", *(name for name in names if not name.endswith(" seat"))]
    return ", ".join(names) or "nothing touches"
