"""What touches after a step, in words."""

from collections.abc import Sequence

from coilset.model.results.record import ContactRecord, SeatReactions


def contact_words(kinds: Sequence[ContactRecord], reactions: SeatReactions) -> str:
    """Which kinds of contact press on the wire: `both seats, coils`, `bottom seat`, or `nothing touches`.

    Args:
        kinds: of the Setup.
        reactions: of the step.
    """
    names = [kinds[number].name for number in sorted({int(row[0]) for row in reactions.pressure if row[2] > 0.0})]
    if {"bottom seat", "top seat"} <= set(names):
        names = ["both seats", *(name for name in names if not name.endswith(" seat"))]
    return ", ".join(names) or "nothing touches"
