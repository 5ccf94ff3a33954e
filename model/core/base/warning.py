"""A warning: something to think about that forbids nothing; the one form in which all rooms give it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Warning:
    """One thing to think about.

    Attributes:
        name: short name of its kind, such as `index` or `lift-off`.
        place: entry of the case file, or place in the run, that it is about.
        message: one line for people, with its numbers.
        value: the number that was found; None where there is none.
        limit: the number that it is held against; None where there is none.
        unit: of both; empty for a ratio or a count.
    """

    name: str
    place: str
    message: str
    value: float | None = None
    limit: float | None = None
    unit: str = ""
