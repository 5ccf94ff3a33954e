"""Tolerances of EN 15800 against printed ones."""

import pytest
from catalogue import CATALOGUE, G

from coilset.model.tools.standards.en15800 import COIL, DIAMETERS, coil_diameter, force_tolerance, outside, tolerances


@pytest.mark.parametrize("printed", CATALOGUE, ids=lambda printed: printed.name)
def test_catalogue_springs(printed):
    found = tolerances(2, G, printed.d, printed.D, printed.n, printed.L0)
    assert found.free_length == pytest.approx(printed.L0_tolerance, abs=0.0051)
    assert found.coil_diameter == printed.De_tolerance


def test_force_of_a_catalogue_spring():
    # Gutekunst D-313J-02: 327.711 N ± 25.38 N at its least length
    assert force_tolerance(2, 3.6, 28.0, 5.5, 327.711) == pytest.approx(25.38, abs=0.005)


def test_lean_and_parallelism_are_shares_of_length_and_diameter():
    found = tolerances(2, G, 3.6, 28.0, 5.5, 53.9)
    assert found.lean == pytest.approx(0.05 * 53.9)
    assert found.parallelism == pytest.approx(0.03 * 31.6)


# Industrial Springs, mean diameter of springs of grade 2: upper end of D, and w of 4 to 8, 8 to 14, 14 to 20
GRADE_2 = [
    (1.0, 0.07, 0.10, 0.15),
    (1.6, 0.08, 0.10, 0.15),
    (2.5, 0.10, 0.15, 0.20),
    (4.0, 0.15, 0.20, 0.25),
    (6.3, 0.20, 0.25, 0.30),
    (10.0, 0.25, 0.30, 0.35),
    (16.0, 0.30, 0.35, 0.40),
    (25.0, 0.35, 0.45, 0.50),
    (31.5, 0.40, 0.50, 0.60),
    (40.0, 0.50, 0.60, 0.70),
    (50.0, 0.60, 0.80, 0.90),
    (63.0, 0.80, 1.00, 1.10),
    (80.0, 1.00, 1.20, 1.40),
    (100.0, 1.20, 1.50, 1.70),
    (125.0, 1.40, 1.90, 2.20),
    (160.0, 1.80, 2.30, 2.70),
    (200.0, 2.10, 2.90, 3.30),
]


@pytest.mark.parametrize("row", GRADE_2)
def test_coil_diameter_of_grade_2(row):
    D = row[0]
    assert [coil_diameter(2, D / w, D) for w in (8.0, 14.0, 20.0)] == list(row[1:])
    assert [coil_diameter(2, D / w, D) for w in (4.0, 8.1, 14.1)] == list(row[1:])


def test_ranges_of_the_diameter_end_where_they_say():
    assert len(COIL) == len(DIAMETERS) - 1
    assert tolerances(1, G, 4.0, 25.0, 5, 50.0).coil_diameter == 0.20
    assert tolerances(1, G, 4.0, 25.1, 5, 50.0).coil_diameter == 0.25


def test_finer_grades_are_tighter():
    forces = [force_tolerance(grade, 4.0, 32.0, 5, 200.0) for grade in (1, 2, 3)]
    assert forces == pytest.approx([0.63 * forces[1], forces[1], 1.6 * forces[1]])
    assert forces[1] - force_tolerance(2, 4.0, 32.0, 5, 0.0) == pytest.approx(0.015 * 200)


def test_springs_that_it_does_not_cover():
    assert outside(4.0, 32.0, 5, 80.0) is None
    assert outside(4.0, 14.0, 5, 80.0) == "w = 3.5 is outside of 4 to 20"
    assert outside(4.0, 32.0, 1.5, 80.0) == "n = 1.5 active turns are fewer than 2"
    assert outside(18.0, 150.0, 5, 400.0) == "d = 18 mm is outside of 0.07 to 16 mm"  # iTeh's and DIN's abstracts
    assert outside(0.06, 0.9, 5, 5.0) == "d = 0.06 mm is outside of 0.07 to 16 mm"
    assert outside(15.0, 240.0, 5, 400.0) == "D = 240 mm is outside of 0.63 to 200 mm"
    with pytest.raises(ValueError, match="L0 = 700 mm is above 630 mm"):
        tolerances(2, G, 4.0, 32.0, 50, 700.0)
