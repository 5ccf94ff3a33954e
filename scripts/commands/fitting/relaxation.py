"""Relaxation tests, catalogue points and load losses of springs from files, for `coilset material creep`."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from coilset.scripts.commands.fitting.springs import with_cases

if TYPE_CHECKING:
    from coilset.model.tools.identification.creep_fit import CreepFit
    from coilset.model.tools.identification.relaxation_tests import Readings


def read(paths: Sequence[str], points: bool) -> "tuple[Readings, ...]":
    """The tests of all files; forces of a spring, whose case file follows, as shear stress 8 F D/(π d³).

    The stress is that of a straight bar, as the fit is: the curvature of a coil is left out.

    Raises:
        InputError: a file is wrong.
    """
    from coilset.model.core.case import UnloadedCase, read_case
    from coilset.model.physics.uniform_coil.equivalent import coil
    from coilset.model.tools.identification.relaxation_tests import read_relaxation
    from coilset.model.tools.standards import en13906

    found = []
    for path, case in with_cases(paths):
        per_force = None
        if case is not None:
            d, D, _, _ = coil(read_case(case, kind=UnloadedCase).spring.build())
            per_force = float(en13906.stress(1.0, d, D))
        found.append(read_relaxation(path, points, per_force))
    return tuple(found)


def words(fit: "CreepFit", error: float | None) -> Iterator[str]:
    """How well the law follows the readings, and what it is known for."""
    scatter = f"residual {fit.scatter:.2g} % of the load"
    if fit.scatter != fit.scatter:
        scatter = "as many readings as constants"
    yield scatter if error is None else f"{scatter}; the intervals are those of an error of {error:g} % of the load"
    if fit.beyond:
        yield (
            "warning: the residuals are larger than this error allows, and the intervals are theirs: the law does not "
            "follow the readings"
        )
    known = fit.range
    ends = {name: f"{low:g} to {high:g}" if low < high else f"{low:g}" for name, (low, high) in known.items()}
    yield (
        f"known for {ends['temperature']} K, equivalent stresses of {ends['stress']} N/mm² and {ends['hours']} h: "
        "a run that goes beyond warns"
    )
