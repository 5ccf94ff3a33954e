"""Formulas of EN 13906-1 against printed sheets of springs and against derivations that do not use them."""

from math import inf

import numpy as np
import pytest
from catalogue import CATALOGUE, G
from derivations import E, closed_helix, haringx, helix_compliance, ν

from coilset.model.core.case import check
from coilset.model.tools.standards import en13906
from coilset.model.tools.standards.buckling import critical_travel, seating_of
from coilset.model.tools.standards.rate import pitch_compliance


def test_printed_sheet_of_helispring():
    # HeliSpring, DIN EN 13906-1, spring S.198: De 39.6, d 5, n 9.5, F1 280 N, F2 620 N, alternating load
    d, D, n = 5.0, 34.6, 9.5
    rate = en13906.rate(G, d, D, n)
    assert rate == pytest.approx(16.181, abs=5e-4)
    assert 280 / rate == pytest.approx(17.3, abs=0.05)
    assert 620 / rate == pytest.approx(38.3, abs=0.05)
    assert en13906.gap_sum(d, D, n, dynamic=True) == pytest.approx(12.3, abs=0.06)  # printed to 0.1, rounded up


@pytest.mark.parametrize("printed", CATALOGUE, ids=lambda printed: printed.name)
def test_printed_sheets_of_catalogue_springs(printed):
    d, D, n = printed.d, printed.D, printed.n
    rate = en13906.rate(G, d, D, n)
    assert rate == pytest.approx(printed.R, abs=6e-4)
    # closed ends, ground and not: the block length is what the gaps leave of the least length
    smallest = en13906.block_length(printed.ends, n + 2, d) + en13906.gap_sum(d, D, n)
    assert smallest == pytest.approx(printed.Ln, abs=6e-3)
    assert rate * (printed.L0 - smallest) == pytest.approx(printed.Fn, rel=2e-3)


def test_printed_force_under_alternating_load():
    # Gutekunst D-313J-02: 300.88 N at the least length under alternating load
    d, D, n = 3.6, 28.0, 5.5
    smallest = en13906.block_length("closed and ground", n + 2, d) + en13906.gap_sum(d, D, n, dynamic=True)
    assert en13906.rate(G, d, D, n) * (53.9 - smallest) == pytest.approx(300.88, abs=0.1)


def test_stress_is_that_of_the_moment_and_fits_the_travel():
    d, D, n, s = 4.0, 32.0, 6.0, 25.0
    force = en13906.rate(G, d, D, n) * s
    moment, section = force * D / 2, np.pi * d**3 / 16
    assert en13906.stress(force, d, D) == pytest.approx(moment / section)
    assert en13906.stress(force, d, D) == pytest.approx(G * d * s / (np.pi * n * D**2))  # the standard's second form


@pytest.mark.parametrize("w", [4.0, 5.0, 6.3, 8.0, 12.0, 20.0])
def test_stress_correction_agrees_with_others(w):
    wahl = (4 * w - 1) / (4 * w - 4) + 0.615 / w
    göhner = 1 + 5 / (4 * w) + 7 / (8 * w**2) + 1 / w**3
    assert en13906.stress_correction(w) == pytest.approx(wahl, rel=0.02)
    assert en13906.stress_correction(w) == pytest.approx(göhner, rel=0.02)


@pytest.mark.parametrize(("slenderness", "seating"), [(5.4, 0.5), (8.0, 0.5), (15.0, 0.5), (3.0, 1.0), (6.0, 2.0)])
def test_buckling_is_haringx_with_the_square(slenderness, seating):
    found = critical_travel(slenderness * 10.0, 10.0, G / E, seating)
    assert found == pytest.approx(haringx(slenderness * 10.0, 10.0, seating), rel=1e-8)


def test_short_springs_do_not_buckle():
    limit = np.pi / 0.5 * np.sqrt((1 - G / E) / (0.5 + G / E))
    assert limit == pytest.approx(5.16, abs=0.01)
    assert critical_travel(0.999 * limit * 10.0, 10.0, G / E) == np.inf
    assert critical_travel(1.001 * limit * 10.0, 10.0, G / E) < 0.5 / (1 - G / E) * limit * 10.0


def test_natural_frequency_is_that_of_a_half_wave():
    d, D, n, ρ = 4.0, 32.0, 6.0, 7.85e-6
    rate = en13906.rate(G, d, D, n) * 1e3  # N/m
    mass = en13906.mass(ρ, d, en13906.wire_length(D, n))
    assert en13906.natural_frequency(G, ρ, d, D, n) == pytest.approx(0.5 * np.sqrt(rate / mass), rel=1e-12)
    # the standard's number, ρ in kg/dm³
    assert en13906.natural_frequency(G, ρ, d, D, n) == pytest.approx(
        3560 * d / (n * D**2) * np.sqrt(G / 7.85), rel=1e-3
    )


@pytest.mark.parametrize(("D", "m"), [(32.0, 10.0), (28.0, 8.3), (60.0, 12.0)])
def test_growth_of_the_diameter_is_the_standards_and_that_of_a_helix(D, m):
    found = en13906.outer_diameter_growth(4.0, D, m)
    assert found == pytest.approx(0.1 * (m**2 - 0.8 * m * 4.0 - 0.2 * 4.0**2) / D, rel=0.014)  # 0.1 for 1/π²
    assert found == pytest.approx(closed_helix(4.0, D, m, 0.25) - D, rel=0.02)  # to second order of the pitch angle


@pytest.mark.parametrize("ends", ["turning", "held"])
@pytest.mark.parametrize("angle", [0.05, 0.15, 0.4])
def test_pitch_compliance_by_castigliano(angle, ends):
    found = helix_compliance(angle, ends == "held") / helix_compliance(0.0, False)
    assert pitch_compliance(angle, ν, ends) == pytest.approx(found, rel=1e-9)


def test_pitch_compliance_to_the_second_order():
    t = np.tan(0.1)
    assert pitch_compliance(0.1, ν) == pytest.approx(1 + t**2 * (1 - ν) / (2 * (1 + ν)), abs=t**4)
    assert pitch_compliance(0.1, ν, "held") == pytest.approx(1 + t**2 * (0.5 - ν), abs=t**4)
    assert pitch_compliance(0.1, ν) > 1.002


@pytest.mark.parametrize(
    ("ends", "expected"),
    [
        ({}, 0.5),
        ({"ends": "clamped"}, 0.5),
        ({"ends": "clamped", "heads": {"top": {"tilt": "free"}}}, 0.7),
        ({"ends": "clamped", "heads": {"top": {"tilt": "free"}, "bottom": {"tilt": "free"}}}, 1.0),
        ({"ends": "clamped", "heads": {"top": {"sideways": "free"}}}, 1.0),
        ({"ends": "clamped", "heads": {"top": {"sideways": "free", "tilt": "free"}}}, 2.0),
        ({"seats": {"hold": "groove", "top": {"tilt": 5.0}}}, 0.7),
        ({"seats": {"hold": "groove", "top": {"tilt": "free", "sideways": "free"}, "bottom": {"tilt": "free"}}}, inf),
    ],
)
def test_seating_coefficients_are_those_of_the_ends(ends, expected):
    spring = {"wire_diameter": 2, "mean_diameter": 20, "turns": 16, "pitch": 5}
    case = check({"spring": spring, "material": "elastic", "loading": [{"to": {"travel": 5}}], **ends})
    assert seating_of(case) == expected
