"""What the standards add to a run: the travel at which EN 13906-1 has it buckle, and a warning of little presetting."""

from collections.abc import Iterator
from math import isfinite
from typing import Any

from coilset.model.core.base.warning import Warning
from coilset.model.core.results.records.part import Part
from coilset.model.core.results.records.record import Result, Setup
from coilset.model.core.results.records.releases import NOTICED, last_release
from coilset.model.tools.limits.presetting import presetting_warning


def _numbers(setup: Setup, result: Result) -> dict[str, Any]:
    return {"buckling_travel_EN_13906_1_mm": setup.buckling_travel if isfinite(setup.buckling_travel) else None}


def _presetting(setup: Setup, result: Result) -> Iterator[Warning]:
    """Of a program that goes to block and comes back, if the spring sets: an elastic spring is not preset."""
    release, spring = last_release(setup, result), setup.spring
    if "block" not in setup.phases or release is None or release.set <= NOTICED * spring.free_length:
        return
    warning = presetting_warning(release.set, spring.free_length - spring.block_height)
    if warning is not None:
        yield warning


PART = Part(numbers=_numbers, found=(_presetting,))
