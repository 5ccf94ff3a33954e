"""Few rods and many uniform rods: statistics against plain sampling of the same cases."""

import numpy as np
import pytest
import xarray as xr
from scipy import stats

from coilset.model.tools.sweep.multifidelity import ControlVariate, as_rods, of_parquet

N, FEW = 4000, 60
LIMIT = 11.5


def responses(rng):
    """Correlated responses, ρ² = 1/1.01, as the sets of rods and uniform rods are."""
    u = 10.0 + rng.normal(size=N)
    return u + 0.3 + 0.1 * rng.normal(size=N), u


def estimates(seed):
    rod, uniform = responses(np.random.default_rng(seed))
    return ControlVariate(rod[:FEW], uniform[:FEW], uniform)


EXACT = stats.norm(10.3, np.hypot(1.0, 0.1))


@pytest.mark.parametrize(
    ("statistic", "exact"),
    [
        (lambda one: one.mean(), EXACT.mean()),
        (lambda one: one.probability(LIMIT), EXACT.cdf(LIMIT)),
        (lambda one: one.quantile(0.9), EXACT.ppf(0.9)),
    ],
)
def test_intervals_hold_the_exact_value_as_often_as_they_promise(statistic, exact):
    """19 of 20 in the mean; of 40, fewer than 34 would happen once in 1,000 times."""
    found = [statistic(estimates(seed)) for seed in range(40)]
    assert sum(one.low <= exact <= one.high for one in found) >= 34
    assert np.mean([one.value for one in found]) == pytest.approx(exact, abs=0.02 * EXACT.std())


def test_it_is_worth_many_rods():
    """1/((1 − ρ²)/n + ρ²/N) plain samples: with ρ² = 1/1.01, n = 60 and N = 4,000, some 2,400."""
    assert 20 * FEW < estimates(0).mean().worth < N
    rod, _ = responses(np.random.default_rng(0))
    plain = 1.96 * rod[:FEW].std() / np.sqrt(FEW)
    found = estimates(0).mean()
    assert found.high - found.low < 2.0 * plain / 4.0


def test_without_correlation_it_is_plain_sampling():
    rng = np.random.default_rng(3)
    rod, uniform = rng.normal(size=N), rng.normal(size=N)
    found = ControlVariate(rod[:FEW], uniform[:FEW], uniform).mean()
    half = stats.t.ppf(0.975, FEW - 2) * rod[:FEW].std(ddof=1) / np.sqrt(FEW)
    assert 0.5 * (found.high - found.low) == pytest.approx(half, rel=0.05)


def test_all_cases_of_a_parquet_file_count(tmp_path):
    """In any order, with a rod whose uniform rod failed, which is left out."""
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    rod, uniform = responses(np.random.default_rng(0))
    uniform = np.where(np.arange(N) == 3, np.nan, uniform)
    case = np.random.default_rng(1).permutation(N + FEW)
    model, at = np.where(case < N, "uniform_rod", "rod"), np.where(case < N, case, case - N)
    values = np.where(case < N, uniform[at], rod[at])
    table = pa.table({"case": at, "model": model, "set_mm": values}).replace_schema_metadata({"cases": str(N)})
    pq.write_table(table, tmp_path / "sweep.parquet")
    found, good = of_parquet(tmp_path / "sweep.parquet", "set_mm"), np.arange(FEW) != 3
    expected = ControlVariate(rod[:FEW][good], uniform[:FEW][good], uniform[np.isfinite(uniform)])
    for name in ("value", "low", "high"):
        assert getattr(found.mean(), name) == pytest.approx(getattr(expected.mean(), name), rel=1e-12)
    assert (len(found.rod), found.uniform) == (FEW - 1, N - 1)


def test_too_few_rods_give_no_interval():
    with pytest.raises(ValueError, match="3 rods are too few"):
        ControlVariate(np.ones(3), np.ones(3), np.ones(9))


def sweep_data(rods, model="uniform_rod"):
    """A sweep of uniform rods of which the first ones have a rod, too; no rod has a rate."""
    rod, uniform = responses(np.random.default_rng(0))
    variables = {
        "set_mm": ("case", uniform, {"long_name": "set", "units": "mm"}),
        "rod_set_mm": ("case", np.where(np.arange(N) < rods, rod, np.nan), {"long_name": "set, rod", "units": "mm"}),
        "rate_N_per_mm": ("case", uniform, {"long_name": "rate", "units": "N/mm"}),
        "seconds": ("case", uniform, {"units": "s"}),
    }
    return xr.Dataset(variables, attrs={"model": model})


def test_tables_and_figures_agree_with_the_answer():
    """They showed the uniform rods, 0.3 mm below the answer; a fifth of the set in a sweep of ground springs."""
    data = sweep_data(FEW)
    shown, found = (
        as_rods(data),
        ControlVariate(data["rod_set_mm"].values[:FEW], data["set_mm"].values[:FEW], data["set_mm"].values),
    )
    assert float(shown["set_mm"].mean()) == pytest.approx(found.mean().value, rel=1e-12)
    for level in (0.05, 0.95):
        assert float(shown["set_mm"].quantile(level)) == pytest.approx(found.quantile(level).value, abs=0.03)
        assert abs(float(data["set_mm"].quantile(level)) - found.quantile(level).value) > 0.2
    assert shown["set_mm"].attrs["long_name"] == "set"
    assert shown["rate_N_per_mm"].attrs["long_name"] == "rate of the uniform rod"
    assert (shown["rate_N_per_mm"] == data["rate_N_per_mm"]).all()
    assert (shown["rod_set_mm"].fillna(0.0) == data["rod_set_mm"].fillna(0.0)).all()
    assert data["rate_N_per_mm"].attrs["long_name"] == "rate"


@pytest.mark.parametrize("rods", [0, 3])
def test_uniform_rods_without_enough_rods_are_called_so(rods):
    shown = as_rods(sweep_data(rods))
    assert shown["set_mm"].attrs["long_name"] == "set of the uniform rod"
    assert (shown["set_mm"] == sweep_data(rods)["set_mm"]).all()
    assert as_rods(sweep_data(0, "rod"))["set_mm"].attrs["long_name"] == "set"
