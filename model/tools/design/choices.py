"""Unknowns with a list of values: combinations of them are fixed, one after the other, and the others sought for each.

All combinations are evaluated if there are few. Of many, the lists are taken as ranges first, and the combinations of
the two values next to that solution are evaluated: the best of these need not be the best of all.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from coilset.model.core.base.errors import CoilsetError, InputError, SolveError
from coilset.model.tools.design.reach import nearest_seen
from coilset.model.tools.design.search import Found, Search

FEW = 16  # combinations that are all evaluated


@dataclass(frozen=True)
class Option:
    """One combination of chosen values.

    Attributes:
        chosen: values of the chosen unknowns, by their names.
        found: values found for the other unknowns; None if there are none.
        reason: why there is none.
    """

    chosen: Mapping[str, float]
    found: Found | None
    reason: str = ""

    @property
    def off(self) -> float:
        """The largest relative deviation from a condition; infinite where nothing was found."""
        return np.inf if self.found is None else float(np.abs(self.found.search.missed(self.found.off)).max())


@dataclass(frozen=True)
class Options:
    """The combinations that were evaluated.

    Attributes:
        tried: in the order of the lists.
        best: of `tried`.
        total: number of all combinations.
    """

    tried: Sequence[Option]
    best: Option
    total: int


def choose(search: Search, lists: Mapping[str, Sequence[float]]) -> Options:
    """Evaluate combinations of values.

    Args:
        search: with no unknown fixed; the bounds of one with a list are its smallest and its largest value.
        lists: values of unknowns, by their names, the preferred ones first.

    Returns:
        Options; the best is the first, in the order of the lists, that meets all conditions, or the one with the
        smallest deviation.

    Raises:
        InputError: if no spring can be run with any of them.
    """
    total = int(np.prod([len(values) for values in lists.values()]))
    rows = list(itertools.product(*lists.values()))
    rows = rows if total <= FEW else _near(search, lists, rows)
    tried = [_option(search, dict(zip(lists, row, strict=True))) for row in rows]
    best = next((one for one in tried if one.found is not None and one.found.met), min(tried, key=lambda one: one.off))
    if best.found is None:
        raise InputError(f"no spring can be run with any of these values; {best.reason}", f"find.{next(iter(lists))}")
    return Options(tried, best, total)


def _option(search: Search, chosen: dict[str, float]) -> Option:
    fixed = np.array([chosen.get(name, np.nan) for name in search.evaluator.names])
    part = search.with_fixed(fixed)
    try:
        found = part.run()
    except CoilsetError as error:
        return Option(chosen, None, str(error.problem) if isinstance(error, InputError) else str(error))
    finally:
        search.evaluations += part.evaluations
    return Option(chosen, found)


def _near(search: Search, lists: Mapping[str, Sequence[float]], rows: list[tuple[float, ...]]) -> list:
    """The combinations next to the solution in which each list is a range."""
    try:
        x = search.run().x
    except SolveError:
        x = nearest_seen(search).x
    places = [search.evaluator.names.index(name) for name in lists]
    next_to = [_both_sides(values, x[place]) for values, place in zip(lists.values(), places, strict=True)]
    near = [row for row in rows if all(value in sides for value, sides in zip(row, next_to, strict=True))]
    widths = np.array([max(values) - min(values) for values in lists.values()])
    apart = [float(np.linalg.norm((np.array(row) - x[places]) / widths)) for row in near]
    kept = set(np.argsort(apart, kind="stable")[:FEW].tolist())
    return [row for number, row in enumerate(near) if number in kept]


def _both_sides(values: Sequence[float], x: float) -> set[float]:
    """The values next to a number, below and above."""
    below, above = [one for one in values if one <= x], [one for one in values if one >= x]
    return {*([max(below)] if below else []), *([min(above)] if above else [])}
