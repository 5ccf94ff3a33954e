"""Numbers of any size in texts, with few digits."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

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


def apart(value: float, limit: float) -> tuple[str, str]:
    """Two numbers that differ, in two digits, or in as many more as they differ by: `2.04` and `2`, not twice `2`."""
    texts = ((f"{value:.{digits}g}", f"{limit:.{digits}g}") for digits in range(2, 16))
    return next((pair for pair in texts if pair[0] != pair[1]), (f"{value:g}", f"{limit:g}"))


def listed(words: Sequence[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))


def lives_text(lives: Mapping[str, float] | None, missing: str) -> str:
    """Cycles that 10, 50 and 90 % do not survive, as in `1.7e6, 3.5e6, 6.9e6`; `missing` without any."""
    if lives is None:
        return missing
    return ", ".join(f"{life:.2g}".replace("e+", "e").replace("e0", "e") for life in lives.values())


def within(value: float | None, error: float | None, unit: str, digits: int) -> str:
    """A value with its unit in the digits that its error allows, `13.28 ± 0.02 mm`, at most `digits` decimals.

    Args:
        value: None: there is none.
        error: its size, rounded up to one digit, or two that begin with 1; None: not known, and not shown.
        unit: of both.
        digits: decimals.
    """
    if value is None:
        return "none"
    if error is None or not math.isfinite(error):
        return f"{value:z.{digits}f} {unit}"
    error = max(error, 10.0**-digits)
    first = math.floor(math.log10(error))
    place = min(digits, -first + (error < 2.0 * 10.0**first))
    error = math.ceil(error * 10.0**place - 1e-9) / 10.0**place
    return f"{round(value, place) + 0.0:.{max(place, 0)}f} ± {error:.{max(place, 0)}f} {unit}"


NUMBERS = {"force_N": "force", "set_mm": "set", "residual_shear_inside_MPa": "residual stress"}
"""Numbers whose errors are estimated, in words."""
TURNED = {"force_N": "torque"}
"""What these are in torsion."""
CAUSES = {
    "steps": "steps",
    "mesh": "mesh",
    "section": "section points",
    "contact": "contact",
    "warping": "warping",
}
"""Causes of these errors, in words."""


HELD = 1e-3  # of the set: a smaller change of it, as the ends are let go, is not worth a row


def held_matters(summary: Mapping[str, Any]) -> bool:
    """Whether the set of a spring is another one once its ends are let go, beyond its error; of summary.json."""
    set_mm, held = summary.get("set_mm"), summary.get("set_held_mm")
    if set_mm is None or held is None:
        return False
    return bool(abs(held - set_mm) > max(HELD * abs(set_mm), summary.get("estimated_set_error_mm") or 0.0))


def last_released(summary: Mapping[str, Any]) -> tuple[int, int] | None:
    """Step of the last release and number of all steps, where the run does not end with it; of summary.json.

    The set is that of this release: what follows, as time under load, is not in it.
    """
    releases = summary.get("releases")
    if not releases or releases[-1]["step"] == summary["steps"]:
        return None
    return releases[-1]["step"], summary["steps"]


def largest_errors(errors: Mapping[str, Mapping[str, float | None]] | None, turned: bool = False) -> str:
    """Which cause has the largest part in which number, `mesh (force, set), steps (residual stress)`.

    Args:
        errors: `estimated_errors` of a summary; None: empty.
        turned: whether they are those of a torsion spring.
    """
    words = NUMBERS | TURNED if turned else NUMBERS
    found: dict[str, list[str]] = {}
    for number, word in words.items() if errors else ():
        parts = {cause: (errors or {}).get(cause, {}).get(number) or 0.0 for cause in CAUSES}
        largest = max(parts, key=lambda cause: parts[cause])
        if parts[largest]:
            found.setdefault(CAUSES[largest], []).append(word)
    if len(found) == 1:
        return next(iter(found))
    return ", ".join(f"{cause} ({', '.join(words)})" for cause, words in found.items())
