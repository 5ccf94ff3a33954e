"""A check of a spring: a value, its limits and where they are from, and whether the spring is permitted by it."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import inf, isfinite

from coilset.model.core.results.records.labels import plain

DIGITS = 4
ROUNDING = 1e-9  # of a limit: a value beyond it by less is at it


class Verdict(StrEnum):
    """The result of a check."""

    PERMITTED = "permitted"
    NOT_PERMITTED = "not permitted"
    NOT_KNOWN = "not known"


@dataclass(frozen=True)
class Check:
    """One check.

    Attributes:
        name: what is checked, and where.
        value: what was found; None where there is none.
        low, high: limits, of which one may be missing; both are missing where they are not known.
        unit: of these; empty of a ratio.
        source: clause and formula of the limits.
        sure: how the limits are known: `two sources`, `one source`, `computed`, `given`.
        because: why the verdict is not known, and what would make it known; empty where it is.
        remark: what must be said beside.
    """

    name: str
    value: float | None = None
    low: float | None = None
    high: float | None = None
    unit: str = ""
    source: str = ""
    sure: str = ""
    because: str = ""
    remark: str = ""

    @property
    def reserve(self) -> float | None:
        """Distance of the value from the nearer limit, negative beyond it; None without limits."""
        if self.value is None:
            return None
        within = [self.value - self.low] if self.low is not None else []
        within += [self.high - self.value] if self.high is not None else []
        return min(within, default=None)

    @property
    def verdict(self) -> Verdict:
        """A value beyond a limit is not permitted, even where it is not known whether the limit is low enough."""
        beyond = -ROUNDING * max(abs(self.low or 0.0), abs(self.high or 0.0)) if self.high != inf else 0.0
        if self.reserve is not None and self.reserve < beyond:
            return Verdict.NOT_PERMITTED
        return Verdict.NOT_KNOWN if self.because or self.reserve is None else Verdict.PERMITTED

    @property
    def limit(self) -> str:
        """The limits as text, without their unit."""
        if self.low is not None and self.high is not None:
            return f"{_text(self.low)} to {_text(self.high)}"
        if self.low is not None:
            return f"≥ {_text(self.low)}"
        return "" if self.high is None else f"≤ {_text(self.high)}"

    @property
    def basis(self) -> str:
        """Source of the limits, and how sure it is."""
        return ", ".join(filter(None, (self.source, self.sure)))

    @property
    def why(self) -> str:
        """That, why the verdict is not known, and the remark, in one line."""
        known = self.verdict is not Verdict.NOT_KNOWN
        return "; ".join(filter(None, (self.basis, "" if known else f"because {self.because}", self.remark)))

    @property
    def cells(self) -> tuple[str, str, str, str, str]:
        """Name with its unit, verdict, value, limit and reserve, as every table of checks has them."""
        name = f"{self.name}, {self.unit}" if self.unit else self.name
        return name, self.verdict.value, _text(self.value), self.limit or "–", _text(self.reserve)

    @property
    def message(self) -> str:
        """The check in one sentence, without the verdict."""
        name, _, value, limit, _ = self.cells
        return f"{name}: {value}, limit {limit} ({self.why})"


HEADS = ("check", "verdict", "value", "limit", "reserve")
"""Columns of a table of checks, see `Check.cells`."""


def sentence(made: Sequence[Check]) -> str:
    """The results of all checks in one or two sentences."""
    failed, left = (
        [one.name for one in made if one.verdict is verdict] for verdict in (Verdict.NOT_PERMITTED, Verdict.NOT_KNOWN)
    )
    words = [f"Not permitted: {', '.join(failed)}."] if failed else []
    words += [f"Not known: {', '.join(left)}."] if left else []
    if not made:
        return "No checks."
    if not words:
        return "Permitted by all checks."
    return " ".join(words if len(failed) + len(left) == len(made) else [*words, "Permitted by all other checks."])


def _text(value: float | None) -> str:
    """A number in few digits, with a sign that is not a hyphen."""
    if value is None or not isfinite(value):
        return "–" if value is None else "∞"
    return plain(value, DIGITS).replace(",", "").replace("-", "−")
