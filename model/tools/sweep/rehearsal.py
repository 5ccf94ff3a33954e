"""Checks before any case of a sweep runs: whether the cases can be built at all.

If inputs scatter or are combined, a case that cannot be built is one failed case of many. A listed value with which no
case can be built is a mistake in the sweep file, and so is a sweep in which no case can be built.
"""

from typing import Any

from coilset.model.core.base.entry import shown
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import Case
from coilset.model.core.case.material import case_law
from coilset.model.core.case.targets import check_steps, check_targets
from coilset.model.tools.sweep.spec import SweepSpec, Values


def build_input(case: Case) -> None:
    """Build the spring, its nodes and the material of a case, check its steps and targets, and discard them.

    Raises:
        InputError: with the same message as the case would give when it runs.
    """
    spring = case.spring.build()
    spring.stations(case.mesh.elements_per_turn, case.mesh.sagitta)
    law = case_law(case, spring)
    check_steps(case)
    check_targets(case, spring, law.G)
    if case.temperature is not None:
        law.known(case.temperature)


class Rehearsal:
    """Builds cases until each listed value has occurred in one that can be built."""

    def __init__(self, spec: SweepSpec) -> None:
        self._problems: dict[Any, InputError | None] = {None: None}  # None stands for the sweep itself
        self._words: dict[Any, str] = {None: "no case of this sweep can be built"}
        self._listed = []
        for column, (name, vary) in enumerate(spec.vary.items()):
            if isinstance(vary, Values):
                self._listed.append(column)
                for value in vary.values:  # they may be dicts: distinguished by identity
                    self._problems[column, id(value)] = None
                    self._words[column, id(value)] = f"no case with {name} = {shown(value)} can be built"

    def try_case(self, row: tuple[Any, ...], case: Case) -> None:
        """Build a case if one of its values has not yet occurred in one that could be built."""
        open_ones = [place for place in self._places(row) if place in self._problems]
        if not open_ones:
            return
        try:
            build_input(case)
        except InputError as error:
            for place in open_ones:
                self._problems[place] = self._problems[place] or error
        else:
            for place in open_ones:
                del self._problems[place]

    def conclude(self) -> None:
        """To be called when all cases have been tried.

        Raises:
            InputError: a value, or the sweep itself, with which no case could be built.
        """
        for place, error in self._problems.items():
            if error is not None:
                raise InputError(f"{error.problem}; {self._words[place]}", error.place, error.file)

    def _places(self, row: tuple[Any, ...]) -> list[Any]:
        return [None, *((column, id(row[column])) for column in self._listed)]
