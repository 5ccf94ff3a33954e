"""Numbers of any size in texts, with few digits."""

import math

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
