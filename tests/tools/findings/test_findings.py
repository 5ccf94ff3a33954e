"""What titles of a sweep's figures say, against cases whose answer is known."""

import numpy as np
import pytest
import xarray as xr

from coilset.model.core.results.records.units import unit_of, words_and_unit
from coilset.model.tools.findings import findings


def cases(values):
    columns = {"set_mm": ("set", values), "height": ("height", range(len(values)))}
    return xr.Dataset(
        {
            name: ("case", np.array(column, dtype=float), {"long_name": words, "units": "mm"})
            for name, (words, column) in columns.items()
        }
    )


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ([3.0, 2.0, 2.0, -1.0], "The set runs from −1 to 3 mm, and falls with the height"),
        ([0.0, 2.0, np.nan, 4.5], "The set runs from 0 to 4.5 mm, and grows with the height"),
        ([0.0, 2.0, 1.0], "The set runs from 0 to 2 mm"),
        ([2.0, 2.0, 2.0], "The set runs from 2 to 2 mm"),
    ],
)
def test_a_trend_is_claimed_only_where_each_step_has_it(values, said):
    assert findings.trend(cases(values), "set_mm", "height", [np.array(values)]) == said


def test_an_input_decides_only_beyond_chance():
    sure, interval = np.array([0.2, -0.9]), np.array([[-0.1, 0.5], [-0.95, -0.8]])
    words = ["pitch", "wire diameter"]
    assert findings.strongest("set", words, sure, interval) == (
        "A greater wire diameter comes with a smaller set most clearly"
    )
    unsure = findings.strongest("set", words, sure * [1.0, 0.1], interval)
    assert unsure == "No input moves the set more than chance would"


def test_the_middle_is_that_of_the_quantiles():
    assert findings.middle(cases(np.arange(101.0)), "set_mm") == "Nine in ten cases have a set of 5 to 95 mm"


def test_a_greatest_value_is_called_so():
    assert words_and_unit("force_max_N") == ("maximum force", "N")
    assert words_and_unit("rate_N_per_mm") == ("rate", "N/mm")


def test_a_unit_is_taken_off_a_name_and_a_turn_is_none():
    assert words_and_unit("load_loss_percent") == ("load loss", "%")
    assert words_and_unit("plastic_work_max_turn") == ("plastic work max turn", "")
    assert words_and_unit("iterations") == ("iterations", "")
    assert unit_of("plastic_work_max_turn") == "1"
    assert unit_of("plastic_work_max_N_per_mm2") == "N/mm²"
    assert unit_of("least_eigenvalue") == "N/mm"
