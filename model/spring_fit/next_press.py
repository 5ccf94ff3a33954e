"""Which further press would tell most: a fresh spring of the same kind, pressed to another height and released.

By the uniform rod: with the slopes J of the residuals of a press that has not been made, the covariance becomes
(JᵀJ + J₀ᵀJ₀)⁻¹, J₀ of the presses that have been; the travel of its turn is an unknown of its own. The share of
kinematic hardening changes nothing below a threshold; in place of its slope stands the secant to the share that is
farther away.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from coilset.model.base.errors import SolveError
from coilset.model.spring_fit.fit import SpringFit
from coilset.model.spring_fit.intervals import spread
from coilset.model.spring_fit.model import Missing, Model
from coilset.model.spring_fit.pressing import Pressing

HEIGHTS = 12  # that are tried
READINGS = 30  # of each branch
WORTH = 0.7  # of the present width: a press that leaves more is not worth making for a constant


@dataclass(frozen=True)
class Advice:
    """The press that narrows the least certain constant most.

    Attributes:
        height: to which a fresh spring is pressed, mm.
        name: of the constant.
        narrower: width of its interval afterwards over that of today.
        open_: constants that no press of this spring to any height narrows much.
    """

    height: float
    name: str
    narrower: float
    open_: tuple[str, ...]


def next_press(fit: SpringFit) -> Advice | None:
    """The best next press of a spring of the first kind; None where nothing is fitted that it could tell."""
    model, one = fit.model, fit.model.pressings[0]
    count = len(model.fitted)
    today = _slopes(model, fit.x)
    before = spread(today)[:count]
    wanted = [model.fitted.index(name) for name in fit.doubtful] or [int(np.argmax(before))]
    trials = []
    for travel in np.linspace(0.25, 0.98, HEIGHTS) * one.furthest:
        try:
            after = spread(_joined(today, _trial(fit, one, float(travel)), count))[:count]
        except SolveError:
            continue
        trials.append((one.spring.free_length - float(travel), after / before))
    if not trials:
        return None
    open_ = tuple(model.fitted[k] for k in wanted if min(ratio[k] for _, ratio in trials) > WORTH)
    hopeful = [k for k in wanted if model.fitted[k] not in open_] or wanted
    height, ratio = min(trials, key=lambda pair: max(pair[1][k] for k in hopeful))
    worst = max(hopeful, key=lambda k: before[k])
    return Advice(height, model.fitted[worst], float(ratio[worst]), open_)


def _slopes(model: Model, x: np.ndarray) -> np.ndarray:
    """Slopes of the residuals, with the secant of the share."""
    J = model.slopes(x)
    if model.share is not None:
        far = x.copy()
        far[model.share] = 0.0 if x[model.share] > 0.5 else 1.0
        J[:, model.share] = (model.residual(far) - model.residual(x)) / (far[model.share] - x[model.share])
    return J


def _trial(fit: SpringFit, one: Pressing, travel: float) -> np.ndarray:
    """Slopes of a press that has not been made."""
    places = np.linspace(0.0, travel, READINGS + 1)[1:]
    branch = np.repeat([0, 1], READINGS)
    made = replace(
        one,
        travel=np.append(places, places[::-1]),
        force=np.ones(2 * READINGS),
        branch=branch,
        ends=(travel, None),
        lengths=False,
    )
    model = replace(fit.model, pressings=(made,))
    x = np.append(fit.x[: len(model.fitted)], 0.0)
    nothing = np.zeros((2 * READINGS, len(x)))
    model = replace(
        model,
        missing=(Missing(x, (np.zeros(2 * READINGS),)),),
        slopes_missing=(nothing,),
        weights=(np.ones(2 * READINGS),),
    )
    force = model.uniform(x)[0]
    made = replace(made, force=np.where(force > 0.0, force, 0.0))
    model = replace(model, pressings=(made,))
    top = float(made.force.max())
    weights = np.hypot(model.errors.force * made.force, top / travel * model.errors.travel)
    return _slopes(replace(model, weights=(np.where(made.force > 0.01 * top, weights, np.inf),)), x)


def _joined(first: np.ndarray, second: np.ndarray, count: int) -> np.ndarray:
    """Slopes of both, of which only the constants are the same unknowns."""
    more, turns = second.shape[1] - count, first.shape[1] - count
    upper = np.hstack([first, np.zeros((len(first), more))])
    lower = np.hstack([second[:, :count], np.zeros((len(second), turns)), second[:, count:]])
    return np.vstack([upper, lower])


def words(advice: Advice | None, undetermined: Sequence[str]) -> list[str]:
    """Sentences for the terminal."""
    if advice is None:
        return []
    told = []
    if advice.open_:
        told.append(
            f"no press of this spring would determine {', '.join(advice.open_)}: a torsion test with reversal of the "
            "wire would (coilset material fit --back-stresses)"
        )
    if advice.narrower <= WORTH:
        what = "determine" if advice.name in undetermined else "narrow"
        told.append(
            f"next: press a fresh spring to {advice.height:.4g} mm; the interval of {advice.name} would become "
            f"{advice.narrower:.2g} times as wide, which would {what} it best"
        )
    return told
