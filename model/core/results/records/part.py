"""What an optional package adds to the records of a run."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from coilset.model.core.base.warning import Warning
from coilset.model.core.results.files.netcdf import Variable
from coilset.model.core.results.records.record import Result, Setup, Step

WarningsOf = Callable[[Setup, Result], Iterator[Warning]]
"""The warnings of one kind, from the records alone, so that a resumed run has the same ones."""


def place_of(step: Step) -> str:
    """A step as the place of a warning."""
    return f"step {step.number}, travel {step.travel_mm:.4g} mm"


def _none(setup: Setup, result: Result) -> dict[str, Any]:
    return {}


@dataclass(frozen=True)
class Part:
    """What a package adds; its module `part` has one of the name PART.

    Attributes:
        numbers: entries of the Summary.
        seen: warnings that the steps show, sought after each of them.
        found: warnings of the whole run.
        variables: of points.nc.
    """

    numbers: Callable[[Setup, Result], Mapping[str, Any]] = _none
    seen: tuple[WarningsOf, ...] = ()
    found: tuple[WarningsOf, ...] = ()
    variables: Callable[[Setup, Result], Mapping[str, Variable]] = _none
