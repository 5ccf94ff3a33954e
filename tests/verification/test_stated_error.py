"""Quick springs of `verify stated-error`: true errors are below the stated ones."""

import pytest

from coilset.verification.random_springs import stated_error

NOTHING = 1e-6  # N, mm, MPa: smaller numbers are rounding, as the set of a spring that stays elastic


@pytest.mark.parametrize("number", [10, 57, 69, 106, 151, 161, 192, 194, 199, 202])
def test_true_errors_are_below_the_stated_ones(number):
    true, found = stated_error.references()[number], stated_error.run(number)
    assert found.keys() == true.keys()
    for name, one in found.items():
        if abs(true[name]) > NOTHING:
            assert abs(one.value - true[name]) < one.error, name
