"""How uncertain the constants are: intervals that hold them all together with 95 % confidence, and their correlation.

Where the residuals are linear in the unknowns over the interval, it follows from the covariance s² (JᵀJ)⁻¹; else from
the profile of the sum of squares: the values of one constant up to which the others can follow until the sum has risen
by s² t². t is Student's, for all constants together (Bonferroni).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.stats import t as student

from coilset.model.tools.identification.result import WIDE
from coilset.model.tools.spring_fit.model import LOGARITHMIC, Model

CONFIDENCE = 0.95
LINEAR = 0.1  # by which the rise of the sum of squares may differ from that of linear residuals
TRIES = 6  # of a profile's end
THRESHOLD = 1.7  # times the rise for a share: beyond its threshold it is one of many shapes, χ² of 3 over that of 1
REACH = 3.0  # in the logarithm of a constant: beyond it nothing is sought


@dataclass(frozen=True)
class Interval:
    """Least and greatest value of a constant; `open_`: it may lie beyond them, or they are all that it can be."""

    name: str
    value: float
    low: float
    high: float
    open_: bool = False

    @property
    def undetermined(self) -> bool:
        """Whether it is no narrower than its value, or for a share half of what it can be."""
        if self.name == "share":
            return self.high - self.low > 0.5
        return self.open_ or self.high - self.low > WIDE * abs(self.value)


def correlation(J: np.ndarray, count: int) -> np.ndarray:
    """Correlation of the first unknowns; NaN for one that changes nothing."""
    scale = np.linalg.norm(J, axis=0)
    live = scale > 1e-9 * scale.max()
    found = np.full((J.shape[1],) * 2, np.nan)
    part = J[:, live] / scale[live]
    covariance = np.linalg.pinv(part.T @ part, rcond=1e-12)
    spread = np.sqrt(np.diag(covariance))
    found[np.ix_(live, live)] = covariance / np.outer(spread, spread)
    return found[:count, :count]


def spread(J: np.ndarray) -> np.ndarray:
    """Standard deviations of the unknowns for residuals of standard deviation 1; infinite where nothing changes."""
    scale = np.linalg.norm(J, axis=0)
    live = scale > 1e-9 * scale.max()
    found = np.full(J.shape[1], np.inf)
    part = J[:, live] / scale[live]
    _, s, V = np.linalg.svd(part, full_matrices=False)
    safe = np.maximum(s, 1e-9 * s.max())
    found[live] = np.sqrt(np.sum((V / safe[:, None]) ** 2, axis=0)) / scale[live]
    return found


def limit(model: Model, found: OptimizeResult) -> float:
    """s² t²: by how much the sum of squares rises to the end of an interval.

    Args:
        model: of the fit.
        found: what `minimum` says of it.
    """
    return 2.0 * float(found.cost) / max(model.readings - len(model.fitted), 1) * rise(model)


def rise(model: Model) -> float:
    """t²: by how much the sum of squares, over the variance s², rises to the end of an interval."""
    t = student.isf(0.5 * (1.0 - CONFIDENCE) / len(model.fitted), max(model.readings - len(model.fitted), 1))
    return float(t) ** 2


def intervals(model: Model, x: np.ndarray, found: OptimizeResult, J: np.ndarray) -> dict[str, Interval]:
    """Of all fitted constants.

    Args:
        model, x: the fit, and its unknowns.
        found: what `minimum` says of it.
        J: slopes there.
    """
    low, high = model.bounds
    risen = limit(model, found)
    widths = math.sqrt(risen) * spread(J)
    result = {}
    for k, name in enumerate(model.fitted):
        logarithmic = name in LOGARITHMIC
        ends, open_ = [], False
        for sign in (-1.0, 1.0):
            reach = min(abs((high if sign > 0.0 else low)[k] - x[k]), REACH if logarithmic else math.inf)
            width, beyond = _end(model, (x, float(found.cost)), J, k, sign * min(float(widths[k]), 1e6), reach, risen)
            ends.append(float(x[k] + sign * width))
            open_ |= beyond and logarithmic
        value, least, most = (math.exp(one) if logarithmic else one for one in (float(x[k]), *ends))
        result[name] = Interval(name, value, least, most, open_)
    return result


def _end(
    model: Model, lowest: tuple[np.ndarray, float], J: np.ndarray, k: int, width: float, reach: float, limit: float
) -> tuple[float, bool]:
    """Distance to one end of an interval, and whether it is the end of what is sought.

    Args:
        model, lowest, J: the fit: unknowns and half the sum of squares, and slopes.
        k: number of the unknown.
        width: of the interval if residuals are linear, with its sign.
        reach: up to which it is sought.
        limit: rise of the sum of squares at the end of the interval.
    """
    x, cost = lowest
    others = np.arange(len(x)) != k
    along = np.zeros(len(x))
    along[k] = 1.0
    kinked = k == model.threshold  # its slope on one side says nothing of the other
    if not kinked:
        along[others] = -np.linalg.lstsq(J[:, others], J[:, k], rcond=1e-9)[0]
    sign, low, high = math.copysign(1.0, width), *model.bounds
    limit *= THRESHOLD if kinked else 1.0

    def guess(distance: float) -> np.ndarray:
        return np.clip(x + sign * distance * along, low, high)

    def risen(x: np.ndarray) -> float:
        return float(np.sum(model.residual(x) ** 2)) - 2.0 * cost

    distance = min(abs(width), reach)
    if not kinked and distance < reach and abs(risen(guess(distance)) / limit - 1.0) < LINEAR:
        return distance, False

    def least(at: float) -> float:
        return 2.0 * float(minimum(model, guess(at), [k], fine=False)[1].cost - cost)

    return _profiled(least, distance, reach, limit)


def minimum(
    model: Model, x: np.ndarray, held: Sequence[int] = (), fine: bool = True
) -> tuple[np.ndarray, OptimizeResult]:
    """Least squares from x on.

    Args:
        model, x: unknowns, and where to start.
        held: numbers of those that stay.
        fine: to the last digit; else as an interval needs it.

    Returns:
        The unknowns, and what scipy says of those that are free.
    """
    low, high = model.bounds
    free = ~np.isin(np.arange(len(x)), held)

    def full(y: np.ndarray) -> np.ndarray:
        z = x.copy()
        z[free] = y
        return z

    found = least_squares(
        lambda y: model.residual(full(y)),
        np.clip(x, low + 1e-6, high - 1e-6)[free],
        lambda y: model.slopes(full(y), np.flatnonzero(free)),
        bounds=(low[free], high[free]),
        x_scale="jac",
        ftol=1e-8 if fine else 1e-3,
        xtol=1e-8 if fine else 1e-4,
        max_nfev=60 if fine else 12,
    )
    return full(found.x), found


def _profiled(risen: Callable[[float], float], distance: float, reach: float, limit: float) -> tuple[float, bool]:
    """Where √(rise of the sum of squares), nearly straight, comes to √limit: by regula falsi, bracketed."""
    inner, outer, at = (0.0, 0.0), None, distance
    for _ in range(TRIES):
        height = math.sqrt(max(risen(at), 0.0) / limit)
        if abs(height - 1.0) < 0.05:
            return at, False
        if height < 1.0:
            if at >= reach:
                return reach, True
            inner = (at, height)
        else:
            outer = (at, height)
        if outer is None:
            at = min(max(at / max(height, 0.25), 1.5 * at), reach)
        else:
            at = inner[0] + (outer[0] - inner[0]) * (1.0 - inner[1]) / (outer[1] - inner[1])
    return (at, False) if outer else (reach, True)
