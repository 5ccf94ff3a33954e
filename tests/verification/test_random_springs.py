"""Random springs: valid, the same for the same number, and of every kind that the case file knows."""

import pytest

from coilset.model.core.case import check
from coilset.model.core.case.material import case_law
from coilset.model.core.case.targets import check_targets
from coilset.model.core.material import library
from coilset.model.tools.limits.case_warnings import case_warnings
from coilset.verification.random_springs.springs import FAMILIES, features, random_spring

NUMBERS = range(84)
KINDS = {
    *("right", "left", "open", "closed", "closed and ground", "two ends", "tips", "groove", "clamped"),
    *("friction", "no friction", "curved", "plane", "warping", "once", "twice", "block", "travel"),
    *("coiled", "peened", "named wire", *library.names()),
}


@pytest.fixture(scope="module")
def cases():
    return [random_spring(number) for number in NUMBERS]


def test_they_are_valid_and_their_supports_are_those_of_springs(cases):
    for data in cases:
        case = check(data)
        spring = case.spring.build()
        law = case_law(case, spring)
        check_targets(case, spring, law.G)
        assert "support" not in {warning.name for warning in case_warnings(case, spring, law)}
        assert 3.0 <= 2.0 * spring.mean_radius(0.0) / spring.wire_diameter(0.0) <= 20.0


def test_every_kind_occurs(cases):
    assert set().union(*map(features, cases)) == KINDS
    shapes = {
        data["spring"]["mean_diameter"]["shape"] for data in cases if isinstance(data["spring"]["mean_diameter"], dict)
    }
    assert shapes == {"cone", "barrel", "hourglass", "double cone"} < set(FAMILIES)


def test_a_number_has_one_spring(cases):
    assert cases[5] == random_spring(5)
    assert len({str(case) for case in cases}) == len(cases)
