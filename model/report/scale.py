"""Colour scales with round limits."""

import math

NICE = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


def round_end(greatest: float) -> float:
    """The smallest round number that is not below a value; 1 for 0."""
    if not greatest > 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(greatest))
    return next((end * power for end in NICE if end * power >= greatest * (1.0 - 1e-9)), 10.0 * power)
