"""From a wish to its solution: conditions, evaluations, search, or the reason why there is none."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from coilset.model.design.beforehand import refuse_beforehand
from coilset.model.design.conditions import conditions
from coilset.model.design.evaluation import Evaluation, Evaluator
from coilset.model.design.reach import look_around, nearest_seen, refuse
from coilset.model.design.search import Found, Search
from coilset.model.design.wish import Wish

NEARER = 0.8  # of the deviation, for a point seen later to be worth a new search


def make_search(
    wish: Wish,
    known: Mapping[str, Mapping[str, Any]] | None = None,
    keep: Callable[[dict[str, Any]], object] = lambda record: None,
    report: Callable[[Evaluation, bool], object] = lambda evaluation, known: None,
    threads: int = 1,
) -> Search:
    """The Search of a wish; the arguments are those of `Evaluator`.

    Raises:
        InputError: a condition that the load program cannot meet, or no spring between the bounds.
    """
    sought, data = conditions(wish.spec, wish.base)
    evaluator = Evaluator(wish, sought, data, known or {}, keep, report, threads)
    bounds = np.array([[one.low, one.high] for one in wish.spec.find.values()])
    start = np.array([_given(data, name) for name in wish.spec.find])
    search = Search(evaluator, bounds, sought, start)
    refuse_beforehand(evaluator, sought, bounds)
    for name, values in wish.spec.trade_offs.items():
        for value in values:
            wish.check(evaluator.data(bounds.mean(axis=1), None, {name: value}))
    return search


def find(search: Search) -> Found:
    """Run a search.

    Returns:
        Found; `met`, or, with more conditions than unknowns, as close as possible.

    Raises:
        InputError: the wish cannot be met, with the reason.
        SolveError: the search does not converge.
    """
    found = search.run()
    if not found.met and len(search.conditions) == len(found.x):
        look_around(search, found)
        near = nearest_seen(search)
        if np.linalg.norm(search.off(near.values)) < NEARER * np.linalg.norm(found.off):
            found = search.run(again=near.x)
        if not found.met:
            refuse(search, found)
    return found


def _given(data: Any, name: str) -> float:
    """The case's own value of an entry; NaN if it is missing or not a number."""
    for part in name.split("."):
        try:
            data = data[int(part)] if isinstance(data, list) else data[part]
        except (KeyError, IndexError, ValueError, TypeError):
            return float("nan")
    return float(data) if isinstance(data, int | float) and not isinstance(data, bool) else float("nan")
