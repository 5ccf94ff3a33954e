"""Texts in pictures: numbers of any size with few digits, and the phases that a legend names."""

import math
from collections.abc import Sequence

MOST_DECIMALS = 6


def decimals(size: float, digits: int = 3) -> int:
    """Number of decimals with which a number of this size has the given number of digits."""
    if not size or not math.isfinite(size):
        return 0
    return min(max(digits - 1 - math.floor(math.log10(abs(size))), 0), MOST_DECIMALS)


def plain(value: float, digits: int = 4) -> str:
    """A number with the given number of digits, without exponent or trailing zeros: `120,200`, `1.103`, `0.0042`."""
    text = f"{value:,.{decimals(value, digits)}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text


def named_phases(phases: Sequence[str], most: int) -> list[tuple[int, str | None]]:
    """For each phase the number of its target among the different ones, and its name in a legend.

    Cycles go to the same targets again and again: each is named once, and `most` of them at most; else None.
    """
    targets = list(dict.fromkeys(phases))
    numbers = [targets.index(phase) for phase in phases]
    return [
        (number, phase if phases.index(phase) == index and number < most else None)
        for index, (number, phase) in enumerate(zip(numbers, phases, strict=True))
    ]


def in_legend(phase: str) -> str:
    """A phase in a legend: a target with the word that leads to it, a waiting or heating as it is."""
    return phase if phase.startswith(("hold ", "heat ")) else f"to {phase}"


def unnamed(phases: Sequence[str], most: int) -> str | None:
    """The line of a legend for the targets that it does not name."""
    more = len(dict.fromkeys(phases)) - most
    return f"and {more} more" if more > 0 else None
