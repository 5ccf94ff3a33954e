"""Least squares of a wire's constants to presses of springs.

The uniform rod searches; then whole rods of the constants found show what it lacks at each reading (ends that close,
contacts, the stresses of coiling), and it searches again, until the constants stay. There whole rods on a coarse mesh
show what each constant changes; the search ends where the curves of the whole rod on the mesh of the case are those
that fit.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import OptimizeResult

from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.case.case import Case
from coilset.model.core.case.material import case_law
from coilset.model.physics.manufacture.initial_state import relief_intervals
from coilset.model.physics.uniform_coil.equivalent import coil
from coilset.model.tools.spring_fit.intervals import THRESHOLD, Interval, correlation, intervals, limit, minimum
from coilset.model.tools.spring_fit.laws import CONSTANTS, Form
from coilset.model.tools.spring_fit.model import TESTER, Errors, Model, names
from coilset.model.tools.spring_fit.pressing import Pressing
from coilset.model.tools.wires.law import softening

ROUNDS = 10
SETTLED = (
    2.0  # squared standard deviations by which the last search may have moved: slopes are nearly those of whole rods
)
STARTS = {"yield_stress": (0.3, 0.55, 0.8), "rise": (0.15, 0.6), "rate": (60.0, 300.0, 1200.0)}
SHARE = 0.2  # to begin with: little flows backwards
SHARES = (0.0, 0.4, 0.6, 0.8, 1.0)  # at which whole rods are run where they differ
CORRELATED = 0.4  # of residuals that follow each other, from which on they are no scatter
POSSIBLE = {
    **dict.fromkeys(("G", "yield_stress", "rise", "rate", "compliance"), (0.0, math.inf)),
    **dict.fromkeys(("share", "friction"), (0.0, 1.0)),
}
LEAST_G = 1000.0  # MPa, below which it was given in GPa
COILED = (
    "all of a coiled wire has hardened before it is pressed: yield stress, rise, rate and share compensate for each "
    "other and may lie outside of their intervals; give some by --known"
)
UNLIKE = "the law does not follow the readings"
TESTED = Errors()
MISFIT = 1.5  # residuals over the tester's errors, from which on the law does not follow the readings


@dataclass(frozen=True)
class SpringFit:
    """The result of `fit_springs`.

    Attributes:
        model: the presses, with what whole rods have more.
        x: its unknowns.
        intervals: of each fitted constant, all together with 95 % confidence.
        correlation: of the fitted constants, shape (fitted, fitted).
        scatter: rms residual over the tester's errors.
        following: correlation of residuals that follow each other.
        rounds: how often whole rods were run.
    """

    model: Model
    x: np.ndarray
    intervals: dict[str, Interval]
    correlation: np.ndarray
    scatter: float
    following: float
    rounds: int

    @property
    def values(self) -> dict[str, float]:
        """All constants and properties of the tester."""
        return self.model.values(self.x)

    @property
    def doubtful(self) -> tuple[str, ...]:
        """Constants that the presses do not determine."""
        return tuple(name for name, one in self.intervals.items() if one.undetermined)

    @property
    def sentences(self) -> list[str]:
        """What it found, as a file's remark says it."""
        units = self.model.form.units
        found = [
            f"{one.name} {one.low:.4g} to {one.high:.4g} {units.get(one.name, '')}".strip()
            for one in self.intervals.values()
        ]
        sentences = [f"95 % intervals: {', '.join(found)}", f"rms residual {self.scatter:.2g} of the tester's errors"]
        return sentences + [one for one in (self.misfit, self.caution) if one]

    def material(self, name: str) -> dict[str, Any]:
        """Content of a material file."""
        model = self.model
        files = ", ".join(one.name for one in model.pressings)
        case, temperature = model.pressings[0].case, model.form.temperature
        of = case.material if isinstance(case.material, str) else case.material.wire
        more = [f"G at {hot:g} K by the slope of {of}" for hot, _ in model.form.warmer]
        more += [f"creep as of {of}"] * (model.form.creep is not None)
        about = {
            "name": name,
            "description": f"Constants identified from presses of springs ({model.form.name})",
            "source": f"coilset material fit --spring: {files}",
            "validity": {
                "plastic_work": math.ceil(100.0 * max(model.work, 1.0)) / 100.0,
                "remark": "; ".join([*self.sentences, *more]),
                "temperature": temperature,
                "undetermined": list(self.doubtful),
            },
        }
        return model.form.material(self.values, about)

    @property
    def misfit(self) -> str:
        """Why this law is not that of the readings, in a sentence; empty if nothing says so."""
        if self.scatter > MISFIT:
            return f"the residuals are {self.scatter:.2g} times the tester's errors: {UNLIKE}"
        if self.following > CORRELATED:
            return f"the residuals follow each other (correlation {self.following:.2g}), they are no scatter: {UNLIKE}"
        return ""

    @property
    def caution(self) -> str:
        """What the intervals leave out, in a sentence; empty if nothing."""
        return COILED if any(one.coiled for one in self.model.pressings) else ""


def fit_springs(
    pressings: Sequence[Pressing],
    form: str = "voce",
    known: Mapping[str, float] | None = None,
    tester: Sequence[str] = (),
    errors: Errors = TESTED,
    like: SpringFit | None = None,
) -> SpringFit:
    """Identify the constants of a wire from springs that are pressed and released.

    A share of back stress that is not determined is the middle of its interval, and the other constants belong to
    it: at the end of its interval the wire is about to flow backwards, and a deeper press would set too little.

    Args:
        pressings: of springs of this wire, each from its unset state on.
        form: of the law, voce or thesis.
        known: constants (`CONSTANTS`) and properties of the tester (`TESTER`) that are given.
        tester: its properties that are fitted.
        errors: of the tester.
        like: a fit of springs that were pressed in the same way, with as many readings, to begin with; its whole rods
            are used again.

    Raises:
        InputError: a name that is none, fewer readings than unknowns, or a stress relief of wire that does not creep.
        SolveError: if no constants are found with which the springs can be pressed so.
    """
    known = dict(known or {})
    _check(known, tester)
    shape, law = form_of(pressings[0].case, form), case_law(pressings[0].case, pressings[0].spring)
    for one in pressings:
        relief_intervals(law, law.parameters(shape.temperature), shape.temperature, one.relief)
    model = Model(tuple(pressings), shape, known, names(shape, known, tester), errors).uncorrected()
    if model.readings < len(model.fitted):
        problem = f"{model.readings} readings cannot determine {len(model.fitted)} constants"
        raise InputError(f"{problem}; give more, or some constants by --known", "--spring")
    if like is not None:
        model = model.like(like.model)
        x, before = minimum(model, like.x)[0], 0
    else:
        model, x, before = _begun(model, law.G)
    model, x, found, rounds = _settled(model, x)
    within = intervals(model, x, found, model.slopes(x))
    at = model.threshold
    if at is not None:
        within["share"] = _from_nothing(model, x, found, within["share"], at)
        if within["share"].undetermined:
            x[at] = 0.5 * (within["share"].low + within["share"].high)
            model, x, found = _again(model, x, at)
    return _result(model, x, found, within, before + rounds)


def form_of(case: Case, name: str) -> Form:
    """The law of few constants of this name, with what a case's material says of other temperatures and of creep."""
    law = case_law(case, case.spring.build())
    temperature = case.temperature or law.reference_temperature
    creep = None if law.data.creep is None else law.data.creep.model_dump(mode="json", exclude_none=True)
    return Form(name, law.nu, temperature, tuple(softening(case, law, temperature)), creep)


def _from_nothing(model: Model, x: np.ndarray, found: OptimizeResult, share: Interval, at: int) -> Interval:
    """The interval of a share that has a threshold: from 0, unless whole rods without any are too far off.

    What whole rods have more is interpolated between shares; exact at one beyond the threshold, it is not exact at
    those below, and the share would seem determined.
    """
    if share.low == 0.0:
        return share
    none = x.copy()
    none[at] = 0.0
    _, _, least = _again(model, none, at)
    return replace(share, low=0.0) if 2.0 * (least.cost - found.cost) < THRESHOLD * limit(model, found) else share


def _again(model: Model, x: np.ndarray, held: int) -> tuple[Model, np.ndarray, OptimizeResult]:
    """Least squares with one unknown held, by whole rods of that."""
    model = model.shifted(minimum(model, x, [held])[0])
    return model, *minimum(model, x, [held])


def _result(
    model: Model, x: np.ndarray, found: OptimizeResult, within: Mapping[str, Interval], rounds: int
) -> SpringFit:
    values = model.values(x)
    return SpringFit(
        model,
        x,
        {name: replace(one, value=values[name]) for name, one in within.items()},
        correlation(model.slopes(x), len(model.fitted)),
        _scatter(model, found),
        _following(model, found),
        rounds,
    )


def _check(known: Mapping[str, float], tester: Sequence[str]) -> None:
    """Refuse names that are none, and values that nothing can have."""
    for option, given, possible in (("--known", known, (*CONSTANTS, *TESTER)), ("--tester", tester, TESTER)):
        for name in given:
            if name not in possible:
                raise InputError(f"'{name}' is none of {', '.join(possible)}", option)
    for name, value in known.items():
        low, high = POSSIBLE.get(name, (-math.inf, math.inf))
        if not low <= value <= high or (value == 0.0 and name in ("G", "yield_stress", "rate")):
            raise InputError(f"{name} must be {f'from 0 to {high:g}' if high == 1.0 else 'positive'}", "--known")
        if name == "G" and value < LEAST_G:
            raise InputError(f"G is in MPa, about 80000 for steel, not {value:g}", "--known")


def _begun(model: Model, G: float) -> tuple[Model, np.ndarray, int]:
    """What coarse whole rods change, by each constant and at several shares; with the number of rounds.

    Raises:
        SolveError: if a whole rod finds no equilibrium.
    """
    held = [] if model.threshold is None else [model.threshold]
    x = _first(model, G, held)
    coiled = any(one.coiled for one in model.pressings)
    for _ in range(2 + coiled):
        model = model.corrected(x)
        x, _ = minimum(model, x, held, fine=False)
    if coiled:  # the end of its release changes by far more than uniform rods show, and would lead the search away
        model = model.with_slopes(x)
        x, _ = minimum(model, x)
    if held:
        model = model.with_shares(x, SHARES)
        x, _ = minimum(model, x, fine=False)
    return model, x, 2 + len(held)


def _settled(model: Model, x: np.ndarray) -> tuple[Model, np.ndarray, OptimizeResult, int]:
    """Whole rods on the mesh of the case and search in turn, until the constants stay; with the number of rounds.

    They stay where whole rods come no nearer to the readings although their slopes are of this place.

    Raises:
        SolveError: if the constants do not come to rest.
    """
    best: tuple[Model, np.ndarray, OptimizeResult, int] | None = None
    nearest, refreshed = math.inf, False
    for number in range(1, ROUNDS + 1):
        model = model.shifted(x)
        whole, (after, found) = float(np.sum(model.residual(x) ** 2)), minimum(model, x)
        small = SETTLED * max(_scatter(model, found), 1.0) ** 2
        settled = min(whole - 2.0 * found.cost, nearest - whole) < small
        if best is None or whole < nearest:
            nearest, best = whole, (model, after, found, number)
        if settled and refreshed:
            return best
        if settled:
            model, refreshed = best[0].with_slopes(best[0].missing[0].at), True
            after = minimum(model, after)[0]
        x = after
    raise SolveError(f"uniform and whole rods do not agree after {ROUNDS} rounds; are travel and spring right?")


def _first(model: Model, G: float, held: Sequence[int]) -> np.ndarray:
    """Constants by uniform rods alone, from the best of several starts."""
    starts = []
    stress = max(_stress(one, G) for one in model.pressings)
    modulus = model.known.get("G") or _modulus(model, G)
    for begin, rise, rate in itertools.product(*STARTS.values()):
        values = {"G": modulus, "yield_stress": begin * stress, "rise": rise * stress, "share": SHARE}
        values |= {"rate": model.form.rate_at(rate, stress), "friction": 0.0, "compliance": 0.0, "offset": 0.0}
        starts.append(model.start(values | dict(model.known)))
    starts.sort(key=lambda x: float(np.sum(model.residual(x) ** 2)))
    return min((minimum(model, x, held, fine=False) for x in starts[:2]), key=lambda one: one[1].cost)[0]


def _stress(one: Pressing, G: float) -> float:
    """About the uniaxial stress at the surface under the maximum force; without forces that of an elastic wire, MPa."""
    d, D, _, turns = coil(one.spring)
    force = one.force.max() if not one.lengths else 0.6 * G * d**4 / (8.0 * D**3 * turns) * max(filter(None, one.ends))
    return math.sqrt(3.0) * 8.0 * D * float(force) / (math.pi * d**3)


def _modulus(model: Model, G: float) -> float:
    """G of the steepest third of a first press; that of the case's material where only lengths are known."""
    found = [G]
    for one in model.pressings:
        if not one.lengths:
            d, D, _, turns = coil(one.spring)
            here = (one.branch == 0) & (one.travel < 0.4 * one.travel.max())
            if here.sum() > 2:
                found.append(float(np.polyfit(one.travel[here], one.force[here], 1)[0]) * 8.0 * D**3 * turns / d**4)
    return found[-1]


def _scatter(model: Model, found: OptimizeResult) -> float:
    """Rms residual over the tester's errors, with the unknowns taken off."""
    return math.sqrt(2.0 * found.cost / max(model.readings - len(model.fitted), 1))


def _following(model: Model, found: OptimizeResult) -> float:
    """Correlation of neighbouring residuals, over all pressings."""
    r, start, pairs = found.fun, 0, []
    for weight in model.weights:
        end = start + int(np.isfinite(weight).sum())
        pairs.append((r[start : end - 1], r[start + 1 : end]))
        start = end
    a, b = (np.concatenate(part) for part in zip(*pairs, strict=True))
    square = float(np.sum(r[:start] ** 2))
    return float(np.sum(a * b)) / square if square > 0.0 and len(a) > 3 else 0.0
