"""Statistics of rods from few of them and many uniform rods: control variates.

With r the response of the rod, known in n of N cases, and u that of the uniform rod, known in all, the estimator of a
mean

    θ = r̄ₙ − β (ūₙ − ū_N),   β = cov(r, u)/var(u),   var θ = s²/n + β² var(u)/N,   s² the variance of r − β u

is unbiased but for the estimate of β, of order 1/n; plain sampling has var(r)/n (Peherstorfer, Willcox and Gunzburger,
SIAM Rev. 60 (2018) 550). A probability is the mean of an indicator; its control is the indicator of a + b u, the
regression of r on u. A quantile is where the probability so estimated has its level.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats
from scipy.optimize import isotonic_regression

from coilset.model.core.results.records.units import words_and_unit
from coilset.model.tools.sweep.plan import Plan

if TYPE_CHECKING:
    import xarray as xr

LEVEL = 0.95
FEWEST = 8  # rods, below which no interval is given
QUANTILES = (0.05, 0.5, 0.95)
CANDIDATES = 401  # values at which the distribution is evaluated


@dataclass(frozen=True)
class Statistic:
    """An estimate with the bounds of its 95 % interval, and the cases of plain sampling that this is worth."""

    value: float
    low: float
    high: float
    worth: float


class ControlVariate:
    """Estimates for one response.

    Attributes:
        rod: as given.
        uniform: number of uniform rods.

    Args:
        rod: of the cases that rods computed, shape (n,).
        uniform: of the same cases by the uniform rod, shape (n,).
        all_uniform: of all cases by the uniform rod, those among them, shape (N,).

    Raises:
        ValueError: fewer than FEWEST rods.
    """

    def __init__(self, rod: np.ndarray, uniform: np.ndarray, all_uniform: np.ndarray) -> None:
        if len(rod) < FEWEST:
            raise ValueError(f"{len(rod)} rods are too few for an interval; {FEWEST} are needed")
        self.rod, self.uniform = rod, len(all_uniform)
        self._line = slope(rod, uniform), float(uniform.mean()), float(rod.mean())
        self._predicted = self.predicted(uniform)
        self._all_predicted = np.sort(self.predicted(all_uniform))

    def predicted(self, uniform: np.ndarray) -> np.ndarray:
        """What the regression of rods on uniform rods makes of these, in their shape."""
        beta, uniform_mean, rod_mean = self._line
        return rod_mean + beta * (uniform - uniform_mean)

    def mean(self) -> Statistic:
        """Of the response."""
        every = self._all_predicted
        return self._controlled(self.rod, self._predicted, float(every.mean()), float(every.var()))

    def probability(self, limit: float) -> Statistic:
        """That the response is at most `limit`."""
        rod, predicted = ((values <= limit).astype(float) for values in (self.rod, self._predicted))
        share = float(np.searchsorted(self._all_predicted, limit, "right")) / len(self._all_predicted)
        found = self._controlled(rod, predicted, share, share * (1.0 - share))
        value, low, high = np.clip([found.value, found.low, found.high], 0.0, 1.0).tolist()
        return Statistic(value, low, high, found.worth)

    def quantile(self, level: float) -> Statistic:
        """The value that a share `level` of the cases does not exceed."""
        everything = np.concatenate([self.rod, self._all_predicted])
        candidates = np.quantile(everything, np.linspace(0.0, 1.0, CANDIDATES))
        found = [self.probability(value) for value in candidates]
        bounds = ([getattr(one, name) for one in found] for name in ("value", "low", "high"))
        value, high, low = (float(np.interp(level, isotonic_regression(one).x, candidates)) for one in bounds)
        at = int(np.argmin(np.abs(candidates - value)))
        return Statistic(value, low, high, found[at].worth)

    def _controlled(self, rod: np.ndarray, control: np.ndarray, mean: float, spread: float) -> Statistic:
        """Of the mean of `rod`, from its control, and from the mean and variance of the control of all cases."""
        n, beta = len(rod), slope(rod, control)
        value = float(rod.mean() - beta * (control.mean() - mean))
        # two degrees of freedom are used up; an indicator that never changes still may by about one case in n
        residual = max(float(np.var(rod - beta * control, ddof=2)), 1.0 / (n + 1.0) ** 2 if _is_indicator(rod) else 0.0)
        variance = residual / n + beta**2 * spread / len(self._all_predicted)
        half = float(stats.t.ppf(0.5 + 0.5 * LEVEL, n - 2)) * variance**0.5
        return Statistic(
            value, value - half, value + half, float(np.var(rod, ddof=1)) / variance if variance else np.inf
        )


def slope(values: np.ndarray, control: np.ndarray) -> float:
    """Of the regression of values on their control; 0 if that is constant."""
    spread = float(np.var(control))
    return float(np.mean((values - values.mean()) * (control - control.mean()))) / spread if spread else 0.0


def _is_indicator(values: np.ndarray) -> bool:
    return bool(np.isin(values, (0.0, 1.0)).all())


def of_response(data: "xr.Dataset", name: str) -> ControlVariate:
    """Estimates for a response of a sweep of uniform rods, some of which rods computed, too.

    Raises:
        ValueError: no or too few rods have it.
    """
    if f"rod_{name}" not in data or name not in data:
        raise ValueError(f"no rod of this sweep has the response {name}")
    uniform = data[name].values
    known = np.isfinite(uniform)
    rod = data[f"rod_{name}"].values
    both = known & np.isfinite(rod)
    return ControlVariate(rod[both], uniform[both], uniform[known])


def as_rods(data: "xr.Dataset") -> "xr.Dataset":
    """The data set of a sweep as its tables and figures show it, so that they agree with the estimates for rods.

    Of uniform rods each response is what the regression on the rods among them makes of it; where there are no or too
    few rods, it is named as that of the uniform rod.
    """
    if data.attrs.get("model") != "uniform_rod":
        return data
    shown = data.copy()
    for name, values in data.data_vars.items():
        if values.dims != ("case",) or values.dtype.kind != "f" or "long_name" not in values.attrs:
            continue
        if str(name).startswith("rod_"):
            continue
        try:
            of_rods = of_response(data, str(name)).predicted(values.values)
            shown[name] = values.copy(data=of_rods)
        except ValueError:
            shown[name] = values.assign_attrs(long_name=f"{values.attrs['long_name']} of the uniform rod")
    return shown


def of_parquet(path: str | Path, name: str) -> ControlVariate:
    """The same of all cases of a sweep, from its Parquet file.

    Raises:
        ValueError: no or too few rods have it.
        ModuleNotFoundError: pyarrow is not installed.
    """
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

    file = pq.ParquetFile(path)
    uniform = np.full(int(file.schema_arrow.metadata[b"cases"]), np.nan)
    cases, values = [], []  # of rods
    for batch in file.iter_batches(columns=["case", "model", name]):
        case, value = batch["case"].to_numpy(), batch[name].to_numpy(zero_copy_only=False)
        of_rods = pc.equal(batch["model"], "rod").to_numpy(zero_copy_only=False)
        uniform[case[~of_rods]] = value[~of_rods]
        cases.append(case[of_rods])
        values.append(value[of_rods])
    rod, beside = np.concatenate([[], *values]), uniform[np.concatenate([np.empty(0, int), *cases])]
    both = np.isfinite(rod) & np.isfinite(beside)
    return ControlVariate(rod[both], beside[both], uniform[np.isfinite(uniform)])


def lines(plan: Plan, estimates_of: Callable[[str], ControlVariate]) -> Iterator[str]:
    """For people: mean and quantiles of the responses of rods, with their intervals.

    Args:
        plan: of the sweep.
        estimates_of: from the name of a response, `of_parquet` or `of_response` of this sweep.
    """
    if not plan.spec.rods:
        return
    yield "rods, from some of them and many uniform rods (95 % intervals):"
    for name in ("set_mm", "force_max_N"):
        try:
            estimates = estimates_of(name)
        except ValueError as error:
            yield f"  {error}"
            continue
        words, unit = words_and_unit(name)
        found = {"mean": estimates.mean()} | {f"{100 * level:g} %": estimates.quantile(level) for level in QUANTILES}
        parts = (f"{word} {one.value:.5g} ({one.low:.5g} to {one.high:.5g})" for word, one in found.items())
        yield f"  {words}, {unit}, {len(estimates.rod):,} and {estimates.uniform:,}: {', '.join(parts)}"
