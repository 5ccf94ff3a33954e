"""Constants of a wire from synthetic presses of coiled and relieved springs: within intervals, a third height

The spring of `spring-fit`, but 60 mm long, of harder wire, which was coiled and relieved for half an hour at 523 K
before it is pressed: the residual stress of coiling is as large as the stress of the press, and all of the wire but its
core has flowed far before. The creep of the relief is that of the library's `creeping`, and given in the fit. Presses
to 55 and 80 % of the travel to block by the whole rod on a finer mesh than the fit's; noise as in `spring-fit`. As the
wire has flowed before, in another direction, the share of back stress counts from the first press on.

The first set, run by itself, had yield stress, rise and share outside: they compensate for each other, and the fit's
coarser mesh moves them. Of four sets, one may have a constant outside the intervals by chance in five of such series,
two in one of seventy. The set of a press to 95 % must be within 1 %, as of virgin wire.
"""

import numpy as np

from coilset.model.core.case import Case, check
from coilset.model.tools.spring_fit import rods
from coilset.model.tools.spring_fit.fit import SpringFit, fit_springs, form_of
from coilset.model.tools.spring_fit.laws import TRIAL
from coilset.verification.cases.springs import spring_fit as virgin
from coilset.verification.study import Study

FAST = False
UNMET = (
    "yield stress, rise and share of wire that has flowed before compensate for each other, and the fit's coarser mesh "
    "moves them by more than their intervals; sets that follow from them are within 0.3 %"
)
SETS = 4
TRUE = {"G": 80000.0, "yield_stress": 1000.0, "rise": 500.0, "rate": 150.0, "share": 0.3}


def spring() -> Case:
    """The spring that is pressed."""
    data = virgin.spring().model_dump(mode="json")
    data["spring"] |= {"free_length": 60.0, "made_by": "coiling", "relieved": {"temperature": 523.15, "minutes": 30}}
    return check(data | {"material": "creeping"})


def run(study: Study) -> None:
    """All sets, and the third height of each."""
    case = spring()
    form = form_of(case, "voce")
    furthest = virgin.pressed(case, [1.0], True, form, TRUE).furthest
    clean = [virgin.pressed(case, [part * furthest], False, form, TRUE) for part in virgin.PARTS]
    third = [virgin.THIRD * furthest, None]
    true = rods.whole(clean[0], form.material(TRUE, TRIAL), third, virgin.FINE)[0][1].free
    fits: list[SpringFit] = []
    for seed in range(SETS):
        rng = np.random.default_rng(seed)
        fit = fit_springs([virgin.noisy(one, rng) for one in clean], like=fits[0] if fits else None)
        found = rods.whole(clean[0], form.material(fit.values, TRIAL), third)[0][1].free
        study.check(f"set at a third height, constants of set {seed}, mm", found, true, "the true constants", 0.01)
        fits.append(fit)
    outside = [[name for name, one in virgin.inside(fit, TRUE).items() if not one] for fit in fits]
    wrong = sum(map(bool, outside))
    study.check(f"sets with a constant outside its interval, of {SETS}", wrong, 1, "95 % intervals", kind="at_most")
    rms = np.mean([fit.scatter for fit in fits])
    study.check("rms residual over the noise, mean of all sets", rms, 1.5, "the noise", kind="at_most")
    rows = [
        [seed, name, TRUE[name], one.value, one.low, one.high, int(name in outside[seed])]
        for seed, fit in enumerate(fits)
        for name, one in fit.intervals.items()
    ]
    study.table("all sets", ["set", "constant", "true", "found", "from", "to", "outside"], rows)
