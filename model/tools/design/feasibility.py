"""Conditions that no spring between the bounds of a design can meet, refused before any run."""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import Case
from coilset.model.core.case.targets import SLACK, lowest_height
from coilset.model.tools.design.conditions import Condition, without_limit
from coilset.model.tools.design.evaluation import Evaluator


def refuse_infeasible(evaluator: Evaluator, conditions: Sequence[Condition], bounds: np.ndarray) -> None:
    """Look at the springs in the corners of the bounds and in their middle.

    Args:
        conditions: of the design.
        bounds: minimum and maximum values of the unknowns, shape (n, 2).

    Raises:
        InputError: with the design's own entry: an unknown that takes none of these numbers, or a force at a height
            below the block height of all these springs.
    """
    places = np.array([*itertools.product(*bounds), bounds.mean(axis=1)])
    cases = list(_cases(evaluator, places))
    lowest = min(_lowest_heights(cases), default=0.0)
    for one in conditions:
        if one.height is not None and one.height < (1.0 - SLACK) * lowest:
            raise InputError(
                f"is {one.height:g} mm, below the block height, which is {lowest:.6g} mm or more between "
                "these bounds; give a greater height",
                f"{without_limit(one.name)}.height",
            )


def _cases(evaluator: Evaluator, places: np.ndarray) -> Iterator[Case]:
    """The cases that can be read; raises InputError if none can, always for the same unknown, or if one is no entry."""
    errors = []
    for x in places:
        data = evaluator.data(x)
        try:
            yield evaluator.design.check(data)
        except InputError as error:
            errors.append(error)
    wrong = {error.place for error in errors}
    owners = {entry: name for name, one in evaluator.design.spec.find.items() for entry in one.driven(name)}
    if len(errors) == len(places) and len(wrong) == 1 and wrong <= owners.keys():
        raise InputError(errors[0].problem, f"find.{owners[errors[0].place]}")


def _lowest_heights(cases: Sequence[Case]) -> Iterator[float]:
    """Of the springs that can be built."""
    for case in cases:
        try:
            yield lowest_height(case, case.spring.build())
        except InputError:
            continue
