"""Capability of a production: how many springs of a sweep lie outside the limits of its case, and what to tighten.

    Cp = (U − L)/(6 s),   Cpk = min(U − m, m − L)/(3 s)

with the mean m and the standard deviation s of the cases. Of a sweep of uniform rods with some rods, both are estimates
for rods by control variates, and so is the share outside. Intervals of 95 %: the share by Clopper and Pearson, Cp by
χ², Cpk by Bissell (1990), Cpk ± z √(1/(9 n) + Cpk²/(2 n − 2)); with control variates their own of m and s.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy import stats

from coilset.model.core.case import check
from coilset.model.core.case.material import case_elastic, case_law
from coilset.model.core.results.records.record import Limit
from coilset.model.core.results.records.units import words_and_unit
from coilset.model.tools.limits.limits import case_limits
from coilset.model.tools.sweep.multifidelity import LEVEL, ControlVariate, slope

ENOUGH = 8  # cases
WANTED = 1.33  # Cpk that is usual in production
Interval = tuple[float, float]


@dataclass(frozen=True)
class Capability:
    """One limited result over the cases.

    Attributes:
        limit: Limit.
        values: of the cases, shape (n,); mean, deviation: estimates for springs.
        outside, cp, cpk: estimates, each with its interval of 95 %.
        parts: name of each varied input, and its share of the variance, by a linear fit.
        by: what the estimate is from, in words.
    """

    limit: Limit
    values: np.ndarray
    mean: float
    deviation: float
    outside: tuple[float, Interval]
    cp: tuple[float, Interval]
    cpk: tuple[float, Interval]
    parts: tuple[tuple[str, float], ...]
    by: str

    @property
    def row(self) -> dict[str, str]:
        """Its numbers with their intervals, as texts."""
        (out, (low, high)), (cp, cps), (cpk, cpks) = self.outside, self.cp, self.cpk
        words, unit = words_and_unit(self.limit.name)
        return {
            "result": words,
            "limits": f"{self.limit.low:.5g} to {self.limit.high:.5g} {unit}".rstrip(),
            "outside": f"{100 * out:.2g} % ({100 * low:.2g} to {100 * high:.2g})",
            "Cp": f"{cp:.2f} ({cps[0]:.2f} to {cps[1]:.2f})",
            "Cpk": f"{cpk:.2f} ({cpks[0]:.2f} to {cpks[1]:.2f})",
        }

    @property
    def advice(self) -> str:
        """Which input to tighten, and by how much, for the wanted Cpk."""
        if self.cpk[0] >= WANTED:
            return f"Cpk is at least {WANTED:g}"
        room = min(self.limit.high - self.mean, self.mean - self.limit.low)
        if room <= 0.0:
            return f"the mean of {self.mean:.5g} is outside: change it first"
        if not self.parts:
            return "no varied number explains it"
        name, share = max(self.parts, key=lambda part: part[1])
        wanted = (room / (3.0 * WANTED) / self.deviation) ** 2  # of the variance
        left = share - (1.0 - wanted)
        if left > 0.0:
            kept = 100.0 * np.sqrt(left / share)
            return f"tighten {name} ({100.0 * share:.0f} % of the variance) to {kept:.0f} % of its tolerance"
        centred = 0.5 * (self.limit.high - self.limit.low) / (3.0 * self.deviation)
        more = f"; centred the Cpk would be {centred:.2f}" if centred > 1.05 * self.cpk[0] else ""
        return f"{name} has {100.0 * share:.0f} % of the variance, which is not enough for {WANTED:g} alone{more}"


def limits_of(data: xr.Dataset) -> tuple[Limit, ...]:
    """The limits of a sweep's base case; raises InputError."""
    base = json.loads(data.attrs.get("base", "{}"))
    if not base.get("limits"):
        return ()
    case = check(base)
    spring = case.spring.build()
    return case_limits(case, spring, case_elastic(case, case_law(case, spring)).shear_modulus)


def capabilities(data: xr.Dataset) -> list[Capability]:
    """That of each limited result that enough cases have, from the data set of a sweep; raises InputError."""
    return [found for limit in limits_of(data) if (found := _capability(data, limit)) is not None]


def _capability(data: xr.Dataset, limit: Limit) -> Capability | None:
    if limit.name not in data:
        return None
    values = data[limit.name].values
    known = np.isfinite(values)
    if known.sum() < ENOUGH:
        return None
    rod = data[f"rod_{limit.name}"].values if f"rod_{limit.name}" in data else np.full(len(values), np.nan)
    both = known & np.isfinite(rod)
    parts = _parts(data, values, known)
    if both.sum() >= ENOUGH:
        return _controlled(limit, rod[both], values[both], values[known], parts)
    return _plain(limit, values[known], parts, "uniform rods" if data.attrs.get("model") == "uniform_rod" else "rods")


def _plain(limit: Limit, values: np.ndarray, parts: Sequence[tuple[str, float]], by: str) -> Capability:
    n, mean, s = len(values), float(values.mean()), float(values.std(ddof=1))
    out = int(np.sum((values < limit.low) | (values > limit.high)))
    tail = 0.5 * (1.0 - LEVEL)
    low = float(stats.beta.ppf(tail, out, n - out + 1)) if out else 0.0
    high = float(stats.beta.ppf(1.0 - tail, out + 1, n - out)) if out < n else 1.0
    cp, cpk = _indices(limit, mean, s)
    half = float(stats.norm.ppf(1.0 - tail)) * (1.0 / (9.0 * n) + cpk**2 / (2.0 * n - 2.0)) ** 0.5
    bounds = tuple(float(cp * (stats.chi2.ppf(level, n - 1) / (n - 1)) ** 0.5) for level in (tail, 1.0 - tail))
    share = (out / n, (low, high))
    cps, cpks = (cp, (bounds[0], bounds[1])), (cpk, (cpk - half, cpk + half))
    return Capability(limit, values, mean, s, share, cps, cpks, tuple(parts), f"{n} {by}")


def _controlled(
    limit: Limit, rod: np.ndarray, uniform: np.ndarray, all_uniform: np.ndarray, parts: Sequence[tuple[str, float]]
) -> Capability:
    """Estimates for rods; the square of the deviation is a response of its own."""
    estimates = ControlVariate(rod, uniform, all_uniform)
    mean = estimates.mean()
    squares = [(values - middle) ** 2 for values, middle in ((rod, mean.value), *_centred(rod, uniform, all_uniform))]
    variance = ControlVariate(*squares).mean()
    below, above = estimates.probability(limit.low), estimates.probability(limit.high)
    out = below.value + 1.0 - above.value
    reach = np.hypot(below.high - below.low, above.high - above.low) / 2.0
    least = max(variance.value, 1e-12 * mean.value**2, 1e-300)
    s = least**0.5
    deviations = [max(bound, 0.01 * least) ** 0.5 for bound in (variance.low, variance.high)]
    cp, cpk = _indices(limit, mean.value, s)
    cps = [_indices(limit, mean.value, one)[0] for one in deviations]
    corners = [_indices(limit, m, one)[1] for m in (mean.low, mean.high) for one in deviations]
    predicted = rod.mean() + slope(rod, uniform) * (all_uniform - uniform.mean())
    return Capability(
        limit,
        predicted,
        mean.value,
        s,
        (out, (max(out - reach, 0.0), min(out + reach, 1.0))),
        (cp, (cps[1], cps[0])),
        (cpk, (min(corners), max(corners))),
        tuple(parts),
        f"{len(all_uniform)} uniform rods and {len(rod)} rods",
    )


def _centred(rod: np.ndarray, uniform: np.ndarray, all_uniform: np.ndarray) -> Iterator[tuple[np.ndarray, float]]:
    beta = slope(rod, uniform)
    middle = float(beta * all_uniform.mean())
    yield beta * uniform, middle
    yield beta * all_uniform, middle


def _indices(limit: Limit, mean: float, s: float) -> tuple[float, float]:
    """Cp and Cpk."""
    return (limit.high - limit.low) / (6.0 * s), min(limit.high - mean, mean - limit.low) / (3.0 * s)


def _parts(data: xr.Dataset, values: np.ndarray, known: np.ndarray) -> list[tuple[str, float]]:
    """Shares of the variance by a linear fit over independent inputs."""
    inputs = np.atleast_1d(data.attrs["inputs"]).tolist()
    names = [name for name in inputs if data[name].dtype.kind == "f" and np.ptp(data[name].values[known])]
    if len(names) + 2 > known.sum():
        return []
    x = np.stack([stats.zscore(data[name].values[known]) for name in names], axis=1)
    slopes = np.linalg.lstsq(np.column_stack([np.ones(len(x)), x]), values[known], rcond=None)[0][1:]
    total = float(np.var(values[known]))
    words = [str(data[name].attrs.get("long_name", name)) for name in names]
    return [(word, float(slope**2) / total) for word, slope in zip(words, slopes, strict=True)] if total else []


def lines(found: Sequence[Capability]) -> Iterator[str]:
    """For people, two lines for each limited result."""
    for one in found:
        row = one.row
        shares = f"outside {row['outside']}, Cp {row['Cp']}, Cpk {row['Cpk']}"
        yield f"{row['result']}, {row['limits']}: {shares}; from {one.by}"
        yield f"  {one.advice}"
