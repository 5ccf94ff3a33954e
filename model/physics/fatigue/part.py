"""What fatigue adds to a run: its entries in the summary, warnings, and the usage of the wire's surface."""

from typing import Any

import numpy as np

from coilset.model.core.results.files.netcdf import Variable
from coilset.model.core.results.records.part import Part
from coilset.model.core.results.records.record import Result, Setup
from coilset.model.physics.fatigue.usage import fatigue, fatigue_warnings, usage


def _numbers(setup: Setup, result: Result) -> dict[str, Any]:
    return {"fatigue": fatigue(setup, result)}


def _variables(setup: Setup, result: Result) -> dict[str, Variable]:
    criteria = usage(setup, result)
    if not criteria:
        return {}
    about = "amplitude of fully reversed stress that damages as much, over that endured; by each criterion"
    used = np.stack([loads / endured for _, loads, endured in criteria])
    dims = ("criterion", "element", "gauss", "angle")
    return {
        "fatigue_usage": Variable(dims, used, {"units": "1", "about": about}),
        "criterion": Variable(("criterion",), np.array([name for name, _, _ in criteria])),
    }


PART = Part(numbers=_numbers, found=(fatigue_warnings,), variables=_variables)
