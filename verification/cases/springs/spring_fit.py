"""Constants of a wire from synthetic presses of springs: 40 sets within their intervals, a third height, a wrong law

Two springs of a wire (4 mm, D 32 mm, four turns, closed and ground) are pressed by the whole rod to 55 and 80 % of
their travel to block and released, 40 readings a branch; normal noise of 0.5 % of each force and 0.02 mm of each travel
is added. The law is Voce's, half of the rise back stress: too little to flow backwards, so that the share of kinematic
hardening must come out as not determined. The intervals hold all constants together with 95 % confidence: of 40 sets 2
may have one outside, and 4 or more are allowed by chance in one of twenty such series.

The set of a third spring, pressed to 95 %, is predicted by the whole rod with the constants of five more sets: on some
of the 40 it was decided to take the middle of a share that is not determined, so that these could not fail. The same
readings fitted by a law without hardening show what a wrong law looks like.
"""

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import replace

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import Case, check
from coilset.model.tools.spring_fit import rods
from coilset.model.tools.spring_fit.fit import SpringFit, fit_springs
from coilset.model.tools.spring_fit.laws import CONSTANTS, TRIAL, Form
from coilset.model.tools.spring_fit.pressing import Pressing
from coilset.verification.study import Study

FAST = False
SETS, READINGS, FRESH = 40, 40, range(40, 45)  # FRESH: seeds of the sets that predict
FORCE, TRAVEL = 0.005, 0.02  # noise, of each force and in mm
PARTS, THIRD = (0.55, 0.8), 0.95  # of the travel to block
FINE = rods.Steps(60, 15, 20, {"elements_per_turn": 20})  # of the presses
TRUE = {"G": 80000.0, "yield_stress": 500.0, "rise": 800.0, "rate": 300.0, "share": 0.5}
FORM = Form("voce", 0.3, 293.15)


def spring() -> Case:
    """The spring that is pressed."""
    entries = {"wire_diameter": 4.0, "mean_diameter": 32.0, "turns": 4.0, "free_length": 44.0}
    return check(
        {
            "spring": {**entries, "end_coils": {"form": "closed and ground"}},
            "material": "elastic",
            "loading": [{"to": "block"}],
        }
    )


def pressed(
    case: Case,
    tops: Sequence[float],
    uniform: bool = False,
    form: Form = FORM,
    true: Mapping[str, float] = TRUE,
) -> Pressing:
    """Readings without noise of a spring that is pressed to travels one after the other and released.

    Args:
        case: of the spring.
        tops: travels, mm.
        uniform: by the uniform rod instead of the whole one.
        form, true: of its law, and the constants.
    """
    ends = tuple(end for top in tops for end in (float(top), None))
    none = Pressing("press", case, np.zeros(1), np.zeros(1), np.zeros(1, int), ends)
    made = _read(none, rods.uniform(none, form.law(true), ends))
    return made if uniform else _read(made, rods.whole(made, form.material(true, TRIAL), ends, FINE)[0])


def _read(one: Pressing, curves: Sequence[rods.Branch]) -> Pressing:
    travels = [curve.places(READINGS)[:: -1 if k % 2 else 1] for k, curve in enumerate(curves)]
    force = np.concatenate([curve.at(travel) for curve, travel in zip(curves, travels, strict=True)])
    return replace(one, travel=np.concatenate(travels), force=force, branch=np.repeat(np.arange(len(curves)), READINGS))


def noisy(one: Pressing, rng: np.random.Generator) -> Pressing:
    """The same with noise."""
    travel = one.travel + TRAVEL * rng.normal(size=one.travel.size)
    force = one.force * (1.0 + FORCE * rng.normal(size=one.force.size))
    last = [np.flatnonzero(one.branch == k)[-1] for k in range(len(one.ends))]
    ends = tuple(None if end is None else float(travel[at]) for end, at in zip(one.ends, last, strict=True))
    return replace(one, travel=travel, force=force, ends=ends)


def inside(fit: SpringFit, true: Mapping[str, float] = TRUE) -> dict[str, bool]:
    """Whether each constant's interval holds the true one."""
    return {name: one.low <= true[name] <= one.high for name, one in fit.intervals.items()}


def run(study: Study) -> None:
    """All sets, the third height, the wrong laws."""
    case = spring()
    furthest = pressed(case, [1.0], uniform=True).furthest
    clean = [pressed(case, [part * furthest]) for part in PARTS]
    fits: list[SpringFit] = []
    for seed in range(SETS):
        rng = np.random.default_rng(seed)
        with contextlib.suppress(SolveError):
            fits.append(fit_springs([noisy(one, rng) for one in clean], like=fits[0] if fits else None))
    study.check(f"sets without a result, of {SETS}", SETS - len(fits), 0, "each set has one", kind="at_most")
    held = [inside(fit) for fit in fits]
    study.check(
        f"sets with a constant outside its interval, of {SETS}",
        sum(not all(one.values()) for one in held),
        4,
        "95 % intervals",
        kind="at_most",
    )
    study.check(
        "rms residual over the noise, mean of all sets", np.mean([fit.scatter for fit in fits]), 1.0, "the noise", 0.05
    )
    study.check(
        f"sets whose share of kinematic hardening is called determined, of {SETS}",
        sum("share" not in fit.doubtful for fit in fits),
        2,
        "nothing flows backwards below a share of about 0.65",
        kind="at_most",
    )
    third = [THIRD * furthest, None]
    true = rods.whole(clean[0], FORM.material(TRUE, TRIAL), third, FINE)[0][1].free
    for seed in FRESH:
        rng = np.random.default_rng(seed)
        fit = fit_springs([noisy(one, rng) for one in clean], like=fits[0])
        material = fit.model.form.material(fit.values, TRIAL)
        found = rods.whole(clean[0], material, third)[0][1].free
        study.check(f"set at a third height, constants of set {seed}, mm", found, true, "the true constants", 0.01)
    rng = np.random.default_rng(0)
    first = [noisy(one, rng) for one in clean]
    flat = fit_springs(first, known={"rise": 0.0, "rate": 100.0, "share": 0.0})
    study.check("1 over the rms residual of a law without hardening", 1.0 / flat.scatter, 0.5, "wrong", kind="at_most")
    study.shown("correlation of its neighbouring residuals", flat.following, 0.0, "scatter", "a wrong law")
    names = [name for name in CONSTANTS if name in fits[0].intervals]
    rows = [
        [
            name,
            TRUE[name],
            np.mean([fit.intervals[name].value for fit in fits]),
            np.mean([fit.intervals[name].low for fit in fits]),
            np.mean([fit.intervals[name].high for fit in fits]),
            sum(not one[name] for one in held),
        ]
        for name in names
    ]
    study.table(f"{SETS} sets", ["constant", "true", "mean", "mean from", "mean to", "outside"], rows)
    study.figure("spring_fit", _draw(fits, names))


def _draw(fits: Sequence[SpringFit], names: Sequence[str]) -> Figure:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 4.0), layout="constrained")
        axes = figure.add_subplot()
        for shift, fit in zip(np.linspace(-0.38, 0.38, len(fits)), fits, strict=True):
            for k, name in enumerate(names):
                one, true = fit.intervals[name], TRUE[name]
                holds = one.low <= true <= one.high
                axes.vlines(k + shift, one.low / true, one.high / true, color="C0" if holds else "C3", lw=1.0)
                axes.plot(k + shift, one.value / true, ".", ms=2.5, color="k")
        axes.axhline(1.0, color="k", lw=0.7)
        axes.set_xticks(range(len(names)), names)
        axes.set(ylabel="identified over true constant", title=f"{len(fits)} sets of two presses, intervals of 95 %")
        axes.grid(lw=0.3, axis="y")
    return figure
