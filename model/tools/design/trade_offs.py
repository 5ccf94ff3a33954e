"""Alternatives: other conditions and other springs, estimated by the surrogate corrected by the runs."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from coilset.model.core.base.errors import InputError
from coilset.model.tools.design.search import FAR, Found, Search

CHANGE = 0.02  # of each condition, for the rows about other targets
NEAR = 1e-3  # relative deviation up to which an estimate counts as possible


@dataclass(frozen=True)
class TradeOff:
    """One row.

    Attributes:
        of: what differs from the design: a condition, by its name, or an entry.
        value: its value.
        unknowns: values of the unknowns, by their names.
        off: largest relative deviation from the conditions.
        wire_length_mm, free_length_before_mm: of the spring as wound; None where it cannot be built.
        torque: maximum torque over that at which the surface yields.
    """

    of: str
    value: Any
    unknowns: Mapping[str, float]
    off: float
    wire_length_mm: float | None
    free_length_before_mm: float | None
    torque: float | None

    @property
    def possible(self) -> bool:
        """Whether the conditions are met within the bounds, according to the estimate."""
        return self.off <= NEAR


def trade_offs(search: Search, found: Found, others: Mapping[str, Sequence[Any]]) -> Iterator[TradeOff]:
    """Each condition slightly smaller and larger, then each of the entries with other values, one at a time."""
    for number, one in enumerate(search.conditions):
        for sign in (-1.0, 1.0):
            shift = np.zeros(len(search.conditions))
            shift[number] = sign * CHANGE
            target = one.target + sign * CHANGE * one.size
            yield _row(search, found, one.name, target, {}, shift)
    for name, values in others.items():
        for value in values:
            yield _row(search, found, name, value, {name: value}, np.zeros(len(search.conditions)))


def _row(search: Search, found: Found, of: str, value: Any, others: dict[str, Any], shift: np.ndarray) -> TradeOff:
    mapped = search.mapped(found.error, others)
    u = search.nearest(lambda u: mapped(u) - shift, found.error.about)
    off = float(np.abs(search.missed(mapped(u) - shift)).max())
    x = search.value(u)
    unknowns = dict(zip(search.evaluator.names, x.tolist(), strict=True))
    try:
        case = search.evaluator.design.check(search.evaluator.data(x, None, others))
        spring, torque = case.spring.build(), search.evaluator.guess(x, others).torque
    except InputError:
        return TradeOff(of, value, unknowns, FAR, None, None, None)
    return TradeOff(of, value, unknowns, off, spring.wire_length, spring.free_length, torque)
