"""From the file of a design to its solution: conditions, evaluations, search, or the reason why there is none."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from coilset.model.tools.design.choices import Options, choose
from coilset.model.tools.design.conditions import conditions
from coilset.model.tools.design.evaluation import Evaluation, Evaluator
from coilset.model.tools.design.feasibility import refuse_infeasible
from coilset.model.tools.design.file import Design
from coilset.model.tools.design.reach import look_around, nearest_seen, refuse
from coilset.model.tools.design.search import Found, Search
from coilset.model.tools.design.unknowns import Choices

NEARER = 0.8  # of the deviation, for a point seen later to be worth a new search


def make_search(
    design: Design,
    known: Mapping[str, Mapping[str, Any]] | None = None,
    keep: Callable[[dict[str, Any]], object] = lambda record: None,
    report: Callable[[Evaluation, bool], object] = lambda evaluation, known: None,
    threads: int = 1,
) -> Search:
    """The Search of a design; the arguments are those of `Evaluator`.

    Raises:
        InputError: a condition that the load program cannot meet, or no spring between the bounds.
    """
    wanted, data = conditions(design.spec, design.base)
    evaluator = Evaluator(design, wanted, data, known or {}, keep, report, threads)
    unknowns = design.spec.find
    bounds = np.array([[one.low, one.high] for one in unknowns.values()])
    start = np.array([one.own(name, data) for name, one in unknowns.items()])
    search = Search(evaluator, bounds, wanted, start)
    refuse_infeasible(evaluator, wanted, bounds)
    for name, values in design.spec.trade_offs.items():
        for value in values:
            design.check(evaluator.data(bounds.mean(axis=1), None, {name: value}))
    return search


@dataclass(frozen=True)
class Solution:
    """Result of a design.

    Attributes:
        found: the best spring; its `search` has the chosen values fixed.
        options: all combinations of chosen values that were evaluated; None without choices.
    """

    found: Found
    options: Options | None = None


def solve(search: Search) -> Solution:
    """Run a search, for each combination of chosen values if there are choices.

    Raises:
        InputError: the conditions cannot be met, with the reason. Of choices the nearest is a solution.
        SolveError: the search does not converge.
    """
    unknowns = search.evaluator.design.spec.find.items()
    lists = {name: one.choices for name, one in unknowns if isinstance(one, Choices)}
    if not lists:
        return Solution(find(search))
    options = choose(search, lists)
    assert options.best.found is not None  # `choose` raises otherwise
    return Solution(options.best.found, options)


def find(search: Search) -> Found:
    """Run a search without choices.

    Returns:
        Found; `met`, or, with more equations than unknowns, as close as possible.

    Raises:
        InputError: the conditions cannot be met, with the reason.
        SolveError: the search does not converge.
    """
    found = search.run()
    if not found.met and not search.is_over:
        look_around(search, found)
        near = nearest_seen(search)
        if np.linalg.norm(search.missed(search.off(near.values))) < NEARER * np.linalg.norm(search.missed(found.off)):
            found = search.run(again=near.x)
        if not found.met:
            refuse(search, found)
    return found
