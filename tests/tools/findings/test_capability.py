"""Capability: known distributions, controlled estimates against all rods, what to tighten."""

import numpy as np
import pytest
from scipy import stats

from coilset.model.core.case import read_case
from coilset.model.core.results.records.record import Limit
from coilset.model.tools.findings.capability import _capability, _controlled, _plain, lines
from coilset.model.tools.limits.limits import case_limits, judged, limit_warnings
from coilset.model.tools.standards import en13906, en15800

LIMIT = Limit("force_at_37_N", 240.0, 260.0, "given")


def test_a_normal_scatter_has_the_share_and_the_indices_of_its_distribution():
    values = stats.norm(252.0, 4.0).ppf((np.arange(4000) + 0.5) / 4000)
    found = _plain(LIMIT, values, [], "rods")
    share = stats.norm.sf(2.0) + stats.norm.cdf(-3.0)
    assert found.outside[0] == pytest.approx(share, rel=0.02)
    assert found.outside[1][0] < share < found.outside[1][1]
    assert found.cp[0] == pytest.approx(20.0 / 24.0, rel=1e-3)
    assert found.cpk[0] == pytest.approx(8.0 / 12.0, rel=1e-3)
    assert found.cp[1][0] < found.cp[0] < found.cp[1][1]


def test_intervals_hold_the_truth_as_often_as_they_say():
    generator, hits = np.random.default_rng(2), np.zeros(3)
    truth = stats.norm.sf(2.0) + stats.norm.cdf(-3.0), 20.0 / 24.0, 8.0 / 12.0
    for _ in range(300):
        found = _plain(LIMIT, generator.normal(252.0, 4.0, 60), [], "rods")
        intervals = found.outside[1], found.cp[1], found.cpk[1]
        hits += [low <= value <= high for value, (low, high) in zip(truth, intervals, strict=True)]
    assert np.all(hits / 300 > 0.91)


def test_few_rods_and_many_uniform_rods_estimate_all_rods():
    """The uniform rod is 8 % low with a slope of 0.9: mean and deviation of rods come out, not its own."""
    generator, off = np.random.default_rng(7), []
    for _ in range(100):
        rod = generator.normal(250.0, 3.0, 500)
        uniform = 5.0 + 0.9 * rod + generator.normal(0.0, 0.3, 500)
        found = _controlled(LIMIT, rod[:40], uniform[:40], uniform, [])
        off.append((found.mean - rod.mean(), found.deviation / rod.std()))
        assert found.cpk[1][0] < found.cpk[0] < found.cpk[1][1]
    means, ratios = np.array(off).T
    assert np.abs(means).max() < 0.3  # 40 rods alone: 0.47 is one standard deviation
    assert ratios.mean() == pytest.approx(1.0, abs=0.02)
    assert ratios.std() < 0.06  # of 40 rods alone 0.11


def test_the_input_with_the_greatest_share_is_to_be_tightened():
    xarray = pytest.importorskip("xarray")
    generator = np.random.default_rng(3)
    wire, turns = generator.normal(4.0, 0.02, 400), generator.normal(7.5, 0.02, 400)
    force = 250.0 + 200.0 * (wire - 4.0) + 60.0 * (turns - 7.5)  # deviations of 4 and 1.2 N
    data = xarray.Dataset({"force_at_37_N": ("case", force)}, {"wire": ("case", wire), "turns": ("case", turns)})
    found = _capability(data.assign_attrs(inputs=["wire", "turns"]), LIMIT)
    assert dict(found.parts)["wire"] == pytest.approx(16.0 / 17.44, abs=0.05)
    wanted = 10.0 / (3.0 * 1.33)
    part = np.sqrt((wanted**2 - 1.44) / 16.0)  # of the wire's tolerance, so that both together have `wanted`
    assert found.advice.startswith("tighten wire")
    assert float(found.advice.split()[-5]) == pytest.approx(100.0 * part, abs=8.0)
    assert "outside" in next(iter(lines([found])))


def test_limits_of_a_case_are_ranges_and_grades(example):
    settings = [
        "working={lengths: [25]}",
        "limits={free_length: [33, 35.2], force_at_25: EN 15800 grade 2, set_mm: {nominal: 1, tolerance: 0.5}}",
    ]
    case = read_case(example, settings)
    spring = case.spring.build()
    length, force, set_mm = case_limits(case, spring, 80_000.0)
    assert (length.name, length.low, length.high) == ("free_length_after_mm", 33.0, 35.2)
    assert (set_mm.low, set_mm.high) == (0.5, 1.5)
    nominal = en13906.rate(80_000.0, 5.0, 40.0, spring.active_turns) * (spring.free_length - 25.0)
    spread = en15800.force_tolerance(2, 5.0, 40.0, spring.active_turns, nominal)
    assert (force.low, force.high) == pytest.approx((nominal - spread, nominal + spread))
    entries = judged((length, force, set_mm), {"free_length_after_mm": 35.4, "force_at_25_N": nominal, "set_mm": None})
    assert [entry["met"] for entry in entries] == [False, True, False]
    assert entries[0]["margin"] == pytest.approx(-0.2)
    assert entries[1]["margin"] == pytest.approx(spread)
    assert [warning.place for warning in limit_warnings(entries)] == ["free_length_after_mm", "set_mm"]


@pytest.mark.parametrize(("name", "words"), [("force_at_30", "meant"), ("weight", "no number")])
def test_a_limit_of_what_is_no_result_is_refused(example, name, words):
    from coilset.model.core.base.errors import InputError

    case = read_case(example, ["working={lengths: [25]}", f"limits={{{name}: [1, 2]}}"])
    with pytest.raises(InputError, match=words):
        case_limits(case, case.spring.build(), 80_000.0)
