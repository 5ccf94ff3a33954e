"""Runs a case again, finer, where its estimated errors exceed its accuracy and what is too coarse was left to coilset.

An error falls with a power of the factor by which its cause is made finer: that of the mesh between the first and the
second (docs/rod.md), of the section's points with the second, of contact with the power 0.6 of its bedding's stiffness,
and that of all steps with the power 2/3 of what one of them may bring in. What a case gives itself is kept. Nothing is
made finer for a number that `FINEST` would not bring within the accuracy: many times the cost, and still wrong. Nor is
it where that would cost more than `MOST` times the first run: 0.2 % of a set of 0.6 mm are 1 µm.
"""

import logging
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from coilset.meshes.springs.shapes import Table
from coilset.model.compose.analysis import Analysis
from coilset.model.compose.contacts import bedding_of
from coilset.model.compose.run_warnings import allowed_errors
from coilset.model.core.base.errors import SolveError
from coilset.model.core.case import Case
from coilset.model.core.results.records.labels import plain
from coilset.model.core.results.records.record import RunErrors
from coilset.model.core.results.records.releases import is_turned

log = logging.getLogger("coilset.steps")

ROUNDS = 2  # of finer runs at most
AIM = 0.9  # of the accuracy, to which a finer run is to come
SMALL = 0.2  # of the accuracy: a cause with less is left as it is
ORDERS = {"steps": 2.0 / 3.0, "mesh": 1.5, "section": 2.0, "contact": 0.6}
FINEST = {"steps": 30.0, "mesh": 4.0, "section": 3.0, "contact": 30.0}
"""Greatest factor of what is made finer, in one round."""
COSTS = {"steps": 1.0 / 3.0, "mesh": 1.0, "section": 2.0, "contact": 0.1}
"""Powers of these factors with which the time of a run grows."""
MOST = 5.0  # times the first run's time that a finer run may take
STATED = 3.0  # times `FINEST`, up to which a run that is left out is stated
MOST_RINGS, MOST_ANGLES = 64, 256  # that a case may have


@dataclass(frozen=True)
class Finer:
    """A case to be run again.

    Attributes:
        case: Case.
        changes: what is finer, in words.
        cost: about so many times that of the run before.
    """

    case: Case
    changes: str
    cost: float


def within_accuracy(first: Analysis, run: Callable[[Analysis, str], object]) -> Analysis:
    """Run an analysis, and again finer, until its estimated errors are within its accuracy; collective.

    Args:
        first: Analysis.
        run: runs one; the text says what is finer than in the one before, empty for the first.

    Returns:
        The last analysis whose run is complete; its result states why there is no finer one, if its error calls for
        it.

    Raises:
        SolveError: the first found no equilibrium.
    """
    run(first, "")
    analysis, left, cost, failed = first, left_open(first.case), 1.0, ""
    for _ in range(ROUNDS):
        finer = finer_case(analysis, left, MOST / cost)
        if finer is None:
            break
        again = Analysis(finer.case, analysis.comm, threads=first.threads, **first.further)
        try:
            run(again, finer.changes)
        except SolveError as error:
            log.warning("the run with %s ended early and is discarded: %s", finer.changes, error)
            failed = f"a run with {finer.changes} found no equilibrium and was discarded"
            break
        analysis, cost = again, cost * finer.cost
    analysis.recorder.add_finer(failed or left_out(analysis, left))
    return analysis


def left_out(analysis: Analysis, left: set[str]) -> str:
    """Why a complete run has no finer one that would bring its worst number within its accuracy, in words; empty if
    that is accurate enough, or wrong by what the case gives itself; collective.

    Args:
        analysis: of the run.
        left: causes that may be made finer.
    """
    errors, allowed = _errors(analysis)
    over = {name: (getattr(errors.total, name) or 0.0) / error for name, error in allowed.items()} if errors else {}
    worst = max(over, key=lambda name: over[name], default="")
    if errors is None or over.get(worst, 0.0) <= 1.0:
        return ""
    if errors.largest(worst) not in left:
        return ""
    factors = _factors(_parts(errors, worst), allowed[worst], left)
    if not (factors and _in_reach(factors, STATED)):
        return "no finer run of a reasonable length would bring it there"
    finer = _finer(analysis, factors)
    return f"a run with {finer.changes}, about {plain(finer.cost, 2)} times as long, was left out"


def finer_case(analysis: Analysis, left: set[str], most: float = MOST) -> Finer | None:
    """The case with which the errors of a complete run would be within its accuracy; None if they are, or cannot be,
    and of a torsion spring, whose runs take long; collective.

    Args:
        analysis: of the run.
        left: causes that may be made finer.
        most: times the cost of the run that the finer one may have.
    """
    errors, allowed = _errors(analysis)
    factors = needed(errors, allowed, left, most) if errors else {}
    return _finer(analysis, factors) if factors else None


def _errors(analysis: Analysis) -> tuple[RunErrors | None, dict[str, float]]:
    """Errors of a run that may be made finer, None of another, and those that its accuracy allows; collective."""
    setup, result, comm = analysis.setup, analysis.result, analysis.comm
    if result.errors is None or is_turned(setup, result.steps):
        return None, {}
    return result.errors, comm.bcast(allowed_errors(setup, result) if comm.rank == 0 else None)


def left_open(case: Case) -> set[str]:
    """The causes of errors whose entries a case leaves to coilset."""
    mesh, section = case.mesh, case.mesh.section
    given = {
        "steps": any(getattr(phase, "steps", "auto") != "auto" for phase in case.loading),
        "mesh": "elements_per_turn" in mesh.model_fields_set or mesh.sagitta is not None,
        "section": bool(section.model_fields_set & {"rule", "radial", "angular"}),
        "contact": case.contact.bedding is not None,
    }
    return {cause for cause, is_given in given.items() if not is_given}


def needed(errors: RunErrors, allowed: Mapping[str, float], left: set[str], most: float = MOST) -> dict[str, float]:
    """By what factor each cause must be finer, for all numbers that can be brought within their allowed errors so.

    The numbers are taken in turn, force, set, stress, while the finer run is not too costly.

    Args:
        errors: of the run.
        allowed: errors by the accuracy, by their names in Errors.
        left: causes that may be made finer.
        most: times the cost of the run that the finer one may have.
    """
    factors: dict[str, float] = {}
    for name, error in allowed.items():
        own = _factors(_parts(errors, name), error, left)
        own = own if _in_reach(own) else {}
        joined = factors | {cause: max(factors.get(cause, 1.0), factor) for cause, factor in own.items()}
        if cost_of(joined) <= most:
            factors = joined
    return factors


def cost_of(factors: Mapping[str, float]) -> float:
    """About how many times as long a run takes that is finer by the factors of its causes."""
    return math.prod(factor ** COSTS[cause] for cause, factor in factors.items())


def _parts(errors: RunErrors, name: str) -> dict[str, float | None]:
    """The error of a number by its causes."""
    return {cause.name: getattr(getattr(errors, cause.name), name) for cause in fields(RunErrors)}


def _in_reach(factors: Mapping[str, float], times: float = 1.0) -> bool:
    """Whether nothing is made finer by more than so many times `FINEST`."""
    return all(factor <= times * FINEST[cause] for cause, factor in factors.items())


def _factors(parts: Mapping[str, float | None], most: float, left: set[str]) -> dict[str, float]:
    """`needed` for one number with these parts of its error, in reach or not; empty if one of them is not known."""
    known = {cause: part for cause, part in parts.items() if part is not None}
    if len(known) < len(parts) or sum(known.values()) <= most:
        return {}
    lowered = {cause for cause in left if known[cause] > SMALL * most}
    rest = sum(known[cause] for cause in lowered)
    share = (AIM * most - sum(known.values()) + rest) / rest if rest else 0.0
    return {cause: share ** (-1.0 / ORDERS[cause]) for cause in lowered} if share > 0.0 else {}


def _finer(analysis: Analysis, factors: Mapping[str, float]) -> Finer:
    """The case of an analysis, finer by the factors of its causes."""
    case, words, update = analysis.case, [], dict[str, Any]()
    mesh = dict[str, Any]()
    if "mesh" in factors:
        density = case.mesh.elements_per_turn
        assert not isinstance(density, Table)  # the case gives none
        mesh["elements_per_turn"] = elements = 4.0 * math.ceil(factors["mesh"] * density / 4.0)
        words.append(f"{elements:g} elements per turn")
    if "section" in factors:
        section, angles = case.mesh.section, len(case.section_rule) // case.mesh.section.radial
        radial, angular = (math.ceil(factors["section"] * count / 2.0) * 2 for count in (section.radial, angles))
        radial, angular = min(radial, MOST_RINGS), min(angular, MOST_ANGLES)
        mesh["section"] = section.model_copy(update={"radial": radial, "angular": angular})
        words.append(f"{radial} × {angular} points per section")
    if mesh:
        update["mesh"] = case.mesh.model_copy(update=mesh)
    if "contact" in factors:
        bedding = factors["contact"] * bedding_of(case.contact, analysis.law.E)
        update["contact"] = case.contact.model_copy(update={"bedding": bedding})
        words.append(f"contact.bedding {bedding:.3g} N/mm²")
    if "steps" in factors:
        control = case.solver.control
        steps = replace(control.steps, step_share=control.steps.step_share / factors["steps"])
        update["solver"] = case.solver.model_copy(update={"control": control.model_copy(update={"steps": steps})})
        words.append(f"steps of {100.0 / factors['steps']:.0f} % of the error")
    return Finer(case.model_copy(update=update), ", ".join(words), cost_of(factors))
