"""Numbers of a run as they are printed: by the table alone, for each way of loading."""

from dataclasses import fields

import pytest

from coilset.model.core.results.loading import Loading, loading_of
from coilset.model.core.results.quantities import ENTRIES, ORDER, SERIES, quantities, quantity
from coilset.model.core.results.records.summary_entries import Summary

PRESSED = {
    "set_mm": 1.23456,
    "estimated_set_error_mm": 0.0123,
    "free_length_before_mm": 24.0,
    "free_length_after_mm": 22.76544,
    "force_max_N": 345.678,
    "block_height_mm": 7.0,
    "rate_30_70_N_per_mm": None,
    "residual_shear_inside_MPa": -45.678,
    "steps": 9,
}
STEPS = {"steps": {"force_N": 0.1}}  # the only cause of which anything was found


def printed(summary):
    return {one.words: (one.text, one.remark) for one in quantities(summary)}


def test_every_entry_is_one_of_the_summary_and_every_listed_number_has_its_words():
    entries = {field.name for field in fields(Summary)}
    assert set(ENTRIES) <= entries
    assert {of_error for _, of_error in ENTRIES.values()} <= {*entries, ""}
    assert all(set(order) <= set(ENTRIES) | set(SERIES) for order in ORDER.values())


def test_a_number_has_the_digits_of_its_error_and_its_remark():
    found = printed(PRESSED)
    assert found["set"] == ("1.235 ± 0.013 mm", "5.14 % of the free length")
    assert found["free length"] == ("22.765 ± 0.013 mm", "24 mm before")
    assert found["maximum force"] == ("345.68 N", "error not estimated")
    assert found["rate, 30 to 70 % of the travel to block"][0] == "needs a travel of 11.9 mm"
    assert found["residual shear stress, inside of the coil"] == ("-45.7 MPa", "against the load")


def test_what_was_not_estimated_has_no_largest_part():
    """The steps' part alone may be known, as where the companion finds no equilibrium."""
    assert printed(PRESSED | {"estimated_errors": STEPS})["maximum force"][1] == "error not estimated"
    known = PRESSED | {"estimated_errors": STEPS, "estimated_force_error_N": 0.1}
    assert printed(known)["maximum force"] == ("345.68 ± 0.10 N", "largest part of the errors ±: steps")


def test_a_given_force_has_no_error_and_its_height_is_printed():
    given = {"force_max_is_given": True, "estimated_force_error_N": 0.4, "force_max_height_mm": 12.0}
    found = printed(PRESSED | given)
    assert found["maximum force"][0] == "345.68 N"
    assert found["maximum force"][1].startswith("as given")
    assert found["height under the maximum force"][0] == "12 mm"
    assert "height under the maximum force" not in printed(PRESSED | {"force_max_height_mm": 12.0})


def test_loads_are_printed_without_their_sign():
    pulled = PRESSED | {"force_max_N": -20.0, "initial_tension_N": 5.0, "initial_tension_given_N": 5.2}
    assert loading_of(pulled) is Loading.PULLED
    found = printed(pulled)
    assert found["maximum force, pulled"][0] == "20 N"
    assert found["initial tension"] == ("5 N", "wound with 5.2 N")
    assert "block height" not in found
    assert found["residual shear stress, inside of the coil"][1] == "with the load"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_torsion_spring_sets_with_its_load_whatever_its_hand(sign):
    numbers = {"turn_max_deg": 200.0, "torque_max_Nmm": 4800.0, "turn_set_deg": 10.0}
    turned = {name: sign * value for name, value in numbers.items()} | {"force_max_N": -0.01}
    assert loading_of(turned) is Loading.TURNED
    assert printed(turned)["set"] == ("10 °", "of 200° of rotation")
    assert printed(turned)["maximum torque"][0] == "4800 N mm"


def test_a_spring_that_was_not_released_says_so():
    assert quantity(PRESSED | {"set_mm": None}, "set_mm").text == "the spring was not released"
