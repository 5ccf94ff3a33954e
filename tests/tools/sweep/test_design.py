"""Designs against what they promise, and the sensitivity measures against functions whose indices are known."""

import numpy as np
import pytest
from scipy import stats

from coilset.model.core.base.entry import check_entries
from coilset.model.core.base.errors import InputError
from coilset.model.tools.findings.sensitivity import rank_correlation, sobol_indices
from coilset.model.tools.sweep.design import rows, unit_cube
from coilset.model.tools.sweep.spec import Normal, SweepSpec


def spec(**given):
    return check_entries({"case": "case.yaml", **given}, SweepSpec)


def test_grid_has_every_combination_once():
    found = rows(spec(vary={"a": [1, 2, 3], "b": {"from": 0, "to": 1, "count": 5}}), {})
    assert len(found) == len(set(found)) == 15
    assert {b for a, b in found if a == 2} == {0.0, 0.25, 0.5, 0.75, 1.0}


def test_log_spacing_has_equal_ratios():
    found = np.array(rows(spec(vary={"a": {"from": 1, "to": 1000, "count": 4, "spacing": "log"}}), {})).ravel()
    np.testing.assert_allclose(found, [1.0, 10.0, 100.0, 1000.0], rtol=1e-14)


def test_one_at_a_time_leaves_the_others_at_the_base():
    found = rows(spec(vary={"a": [1, 2, 3], "b": [5, 6]}, design="one_at_a_time"), {"a": 2, "b": 5})
    assert list(found) == [(2, 5), (1, 5), (3, 5), (2, 6)]


def test_together_pairs_first_with_first():
    assert list(rows(spec(vary={"a": [1, 2], "b": [5, 6]}, design="together"), {})) == [(1, 5), (2, 6)]


def test_latin_hypercube_has_one_point_in_each_stratum():
    found = np.array(rows(spec(vary={"a": {"from": 3, "to": 5}}, design="latin_hypercube", samples=50), {})).ravel()
    strata = np.floor((found - 3.0) / 2.0 * 50.0).astype(int)
    assert sorted(strata) == list(range(50))


def test_the_seed_decides_the_samples():
    draws = [unit_cube(spec(vary={"a": [1]}, design="random", samples=8, seed=seed)) for seed in (1, 1, 2)]
    np.testing.assert_array_equal(draws[0], draws[1])
    assert not np.array_equal(draws[0], draws[2])


def test_tolerance_cuts_and_has_the_deviation_of_the_cut_normal():
    """Variance of a normal cut at ±k σ: σ² (1 − 2k φ(k)/(2Φ(k) − 1)); mid-points of 10⁵ strata meet it to 1e-4."""
    k, half = 2.0, 0.3
    found = np.array(Normal(mean=5.0, tolerance=half, sigmas=k).at((np.arange(1e5) + 0.5) / 1e5))
    expected = half / k * np.sqrt(1.0 - 2.0 * k * stats.norm.pdf(k) / (2.0 * stats.norm.cdf(k) - 1.0))
    assert np.abs(found - 5.0).max() <= half
    assert found.std() == pytest.approx(expected, rel=1e-4)


def test_list_under_sampling_takes_each_value_equally_often():
    found = rows(spec(vary={"a": ["x", "y"], "b": {"from": 0, "to": 1}}, design="sobol", samples=64), {})
    assert [row[0] for row in found].count("x") == 32


def test_sobol_indices_of_the_ishigami_function():
    """Ishigami and Homma 1990, a = 7, b = 0.1: S = (0.3139, 0.4424, 0), total (0.5576, 0.4424, 0.2437).

    4096 base samples leave errors below 0.02 (seen: 0.006); a mixed-up block would be off by tenths.
    """
    side = {"from": -np.pi, "to": np.pi}
    given = spec(vary={"x": side, "y": side, "z": side}, design="sobol_indices", samples=4096)
    x, y, z = np.array(rows(given, {})).T
    found = sobol_indices(np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x), 3, 4096)
    np.testing.assert_allclose(found.first, [0.3139, 0.4424, 0.0], atol=0.02)
    np.testing.assert_allclose(found.total, [0.5576, 0.4424, 0.2437], atol=0.02)
    assert (found.first_interval[:, 0] < found.first).all()
    assert (found.first < found.first_interval[:, 1]).all()


def test_sobol_indices_leave_out_what_failed():
    """A linear function of two inputs with variances 1 and 4 has S = (0.2, 0.8) whatever samples are left."""
    side = {"mean": 0.0, "tolerance": 3.0}
    given = spec(vary={"x": side, "y": side}, design="sobol_indices", samples=1024)
    x, y = np.array(rows(given, {})).T
    values = x + 2.0 * y
    values[3] = values[1024 + 77] = np.nan
    found = sobol_indices(values, 2, 1024)
    assert found.samples == 512
    np.testing.assert_allclose(found.first, [0.2, 0.8], atol=0.05)


def test_intervals_of_sobol_indices_are_the_same_each_time():
    """A figure that is drawn again shows what it showed; another seed of the sweep gives others, somewhat."""
    values = np.random.default_rng(3).normal(size=4 * 64)
    one, same, other = (sobol_indices(values, 2, 64, seed) for seed in (1, 1, 2))
    for name in ("first_interval", "total_interval"):
        assert np.array_equal(getattr(one, name), getattr(same, name))
        assert not np.array_equal(getattr(one, name), getattr(other, name))


def test_the_only_input_has_all_of_the_variance():
    """Its column of AB is that of B, so that the total index is 1 but for the sample's chance."""
    given = spec(vary={"x": {"mean": 0.0, "tolerance": 3.0}}, design="sobol_indices", samples=1024)
    (x,) = np.array(rows(given, {})).T
    found = sobol_indices(3.0 * x, 1, 1024)
    np.testing.assert_allclose([*found.first, *found.total], 1.0, atol=0.02)


def test_rank_correlation_sees_monotone_and_constant_inputs():
    x = np.linspace(1.0, 2.0, 30)
    found, interval = rank_correlation(np.stack([x, -x, np.ones(30)], axis=1), np.exp(5.0 * x))
    np.testing.assert_allclose(found[:2], [1.0, -1.0])
    assert np.isnan(found[2])
    assert interval[0, 0] > 0.99


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"vary": {"a": {"from": 1, "to": 2}}}, "vary.a: a grid needs 'count'"),
        ({"vary": {"a": {"from": 2, "to": 1, "count": 3}}}, "'from' must be the smaller one"),
        ({"vary": {"a": {"mean": 1, "tolerance": 0.1}}}, "a scatter has no grid"),
        ({"vary": {"a": {"mean": 1, "tolerence": 0.1}}}, "vary.a.tolerence: unknown entry; is tolerance meant?"),
        ({"vary": {"a": {"from": 0, "to": 1, "count": 3, "spacing": "log"}}}, "equal ratios need a positive start"),
        ({"vary": {"a": [1, 2], "b": [1]}, "design": "together"}, "equally many, not a 2, b 1"),
        ({"vary": {"a": [1, 2]}, "design": "latin_hypercube"}, "latin_hypercube needs 'samples'"),
        ({"vary": {"a": [1, 2]}, "samples": 3}, "grid has no 'samples'"),
        ({"vary": {"a": [1, 2]}, "design": "sobol", "samples": 100}, "power of 2 as 'samples', not 100"),
        ({"vary": {"a b": [1, 2]}}, "vary.a b: 'a b': must be a name of letters, digits, _"),
        ({"vary": {}}, "vary"),
        ({"vary": {"a": [1]}, "figures": [{"kind": "lines", "x": "b"}]}, "'b' is none of the varied inputs; there are"),
        ({"vary": {"a": [1]}, "figures": [{"kind": "pie"}]}, "figures.0: {'kind': 'pie'}: kind must be lines, map"),
        ({"vary": {"a": [1]}, "figures": [{"kind": "lines", "x": 5}]}, "figures.0.x: 5: must be a word"),
        ({"vary": {"a": [1]}, "samples": True}, "samples: True: must be a whole number"),
        ({"vary": {"a": {"from": True, "to": 2}}}, "vary.a.from: True: must be a number"),
    ],
)
def test_wrong_sweeps_get_one_line(given, words):
    with pytest.raises(InputError) as found:
        rows(spec(**given), {})
    assert words in str(found.value)
    assert "\n" not in str(found.value)
