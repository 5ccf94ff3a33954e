"""Which further press would determine most: a fresh spring of the same kind, pressed to another height and released.

By the uniform rod: with the slopes J of the residuals of a press that has not been made, the covariance becomes
(JᵀJ + J₀ᵀJ₀)⁻¹, J₀ of the presses that have been; the travel of its turn is an unknown of its own. The share of
kinematic hardening changes nothing below a threshold that a press has, so that no slope says how well it is known: if
it is s, those s' remain whose residuals, with all other unknowns following, differ by less than an interval allows.
The width of what remains is averaged over the shares s that are possible today. For the other constants the secant to
the share that is further away stands in place of its slope.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.tools.spring_fit.fit import SpringFit
from coilset.model.tools.spring_fit.intervals import THRESHOLD, rise, spread
from coilset.model.tools.spring_fit.model import Missing, Model
from coilset.model.tools.spring_fit.pressing import Pressing

HEIGHTS = 12  # that are tried
READINGS = 30  # of each branch
SHARES = np.linspace(0.0, 1.0, 21)  # that are distinguished
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
    """The best next press of a spring of the first kind; None where nothing is fitted that it could determine."""
    model, one = fit.model, fit.model.pressings[0]
    count = len(model.fitted)
    today = _seen(model, fit.x)
    before = _widths(today, fit)
    wanted = [model.fitted.index(name) for name in fit.doubtful] or [int(np.argmax(before))]
    trials = []
    for travel in np.linspace(0.25, 0.98, HEIGHTS) * one.furthest:
        try:
            after = _widths(today.joined(_trial(fit, one, float(travel)), count), fit)
        except SolveError:
            continue
        trials.append((one.spring.free_length - float(travel), after / before))
    if not trials:
        return None
    open_ = tuple(model.fitted[k] for k in wanted if min(ratio[k] for _, ratio in trials) > WORTH)
    hopeful = [k for k in wanted if model.fitted[k] not in open_] or wanted
    height, ratio = min(trials, key=lambda pair: max(pair[1][k] for k in hopeful))
    worst = max(hopeful, key=lambda k: ratio[k])
    return Advice(height, model.fitted[worst], float(ratio[worst]), open_)


@dataclass(frozen=True)
class _Seen:
    """What presses show.

    Attributes:
        J: slopes of the residuals, with the secant of the share, shape (residuals, unknowns).
        shares: residuals at each of `SHARES`, shape (shares, residuals); none if the share is not fitted.
    """

    J: np.ndarray
    shares: np.ndarray

    def joined(self, other: "_Seen", count: int) -> "_Seen":
        """Both, of which only the first `count` unknowns, the constants, are the same."""
        more, turns = other.J.shape[1] - count, self.J.shape[1] - count
        upper = np.hstack([self.J, np.zeros((len(self.J), more))])
        lower = np.hstack([other.J[:, :count], np.zeros((len(other.J), turns)), other.J[:, count:]])
        return _Seen(np.vstack([upper, lower]), np.hstack([self.shares, other.shares]))


def _seen(model: Model, x: np.ndarray) -> _Seen:
    J = model.slopes(x)
    at, rows = model.share, []
    if at is not None:
        for share in SHARES:
            moved = x.copy()
            moved[at] = share
            rows.append(model.residual(moved))
        far = 0 if x[at] > 0.5 else -1
        J[:, at] = (rows[far] - model.residual(x)) / (SHARES[far] - x[at])
    return _Seen(J, np.array(rows).reshape(-1, len(J)))


def _widths(seen: _Seen, fit: SpringFit) -> np.ndarray:
    """Widths of the intervals of all constants, those of the share over what it can be."""
    model = fit.model
    limit = fit.scatter**2 * rise(model)
    found = np.sqrt(limit) * spread(seen.J)[: len(model.fitted)]
    if model.share is not None:
        others, _ = np.linalg.qr(np.delete(seen.J, model.share, axis=1))
        r = seen.shares - (seen.shares @ others) @ others.T
        alike = np.sum((r[:, None] - r[None]) ** 2, axis=2) < THRESHOLD * limit
        now = fit.intervals["share"]
        found[model.share] = np.mean(alike[np.clip(SHARES, now.low, now.high) == SHARES])
    return found


def _trial(fit: SpringFit, one: Pressing, travel: float) -> _Seen:
    """What a press that has not been made would show."""
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
    return _seen(replace(model, weights=(np.where(made.force > 0.01 * top, weights, np.inf),)), x)


def words(advice: Advice | None, undetermined: Sequence[str]) -> list[str]:
    """Sentences for the terminal."""
    if advice is None:
        return []
    sentences = []
    if advice.open_:
        sentences.append(
            f"no press of this spring would determine {', '.join(advice.open_)}: a torsion test with reversal of the "
            "wire would (coilset material fit --back-stresses)"
        )
    if advice.narrower <= WORTH:
        what = "determine" if advice.name in undetermined else "narrow"
        sentences.append(
            f"next: press a fresh spring to {advice.height:.4g} mm; the interval of {advice.name} would become "
            f"{advice.narrower:.2g} times as wide on average, which would {what} it best"
        )
    return sentences
