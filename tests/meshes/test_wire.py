"""The entry `spring.wire`: its errors in one line, and what the geometry makes of it."""

import numpy as np
import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.model.tools.sheet.rows import sections
from coilset.model.tools.sheet.spring_data import spring_data
from coilset.model.tools.standards.cylinder import Cylinder

OVAL = {"oval": {"width": 4.0, "height": 5.0}}
RECTANGLE = {"rectangle": {"width": 6.0, "height": 3.0, "corner": 0.5}}


def case(wire, **entries):
    spring = {"mean_diameter": 32.0, "turns": 5.0, "pitch": 9.0, "wire": wire} | entries
    return check({"spring": spring, "loading": [{"to": "block"}]})


@pytest.mark.parametrize(
    ("wire", "entries", "place", "problem"),
    [
        ({}, {}, "spring.wire", "no shape is given"),
        ({**OVAL, **RECTANGLE}, {}, "spring.wire", "oval, rectangle are given; give one of"),
        ({"oval": {"width": 4.0}}, {}, "spring.wire.oval.height", "required"),
        ({"oval": {"width": -4.0, "height": 5.0}}, {}, "spring.wire.oval.width", "greater than 0"),
        ({"rectangle": {"width": 6.0, "height": 3.0, "corner": 2.0}}, {}, "spring.wire.rectangle.corner", "more than"),
        ({"egg": {"inside": 3.0, "outside": 1.0, "distance": 1.0}}, {}, "spring.wire.egg.distance", "one circle is"),
        ({"tube": {"outer": 3.0, "inner": 4.0}}, {}, "spring.wire.tube.inner", "no inner diameter"),
        ({"tube": {"outer": 5.0, "inner": 4.97}}, {}, "spring.wire.tube.inner", "a wall of 0.015 mm; .*give 4.9 mm"),
        ({"tube": {"outer": 5.0, "inner": 3.0}}, {"end_coils": {"form": "closed and ground"}}, "spring.end_coils", "t"),
        (OVAL, {"made_by": "coiling"}, "spring", "made_by is for round wire"),
        ({"oval": {"width": 12.0, "height": 5.0}}, {}, "spring.mean_diameter", "thicker than the coil allows"),
    ],
)
def test_wrong_entries(wire, entries, place, problem):
    with pytest.raises(InputError, match=problem) as error:
        case(wire, **entries).spring.build()
    assert error.value.place == place


def test_an_outline_counts_from_the_centre_line(tmp_path):
    file = tmp_path / "wire.csv"
    file.write_text("xi,eta\n0,0\n6,0\n6,3\n0,3\n")
    with pytest.raises(InputError, match=r"middle of the outline is at ξ = 3, η = 1.5 mm"):
        case({"outline": str(file)}).spring.build()
    file.write_text("xi,eta\n-3,-1.5\n3,-1.5\n3,1.5\n-3,1.5\n")
    drawn = case({"outline": str(file)}).spring.build()
    assert drawn.wire_diameter(0.0) == pytest.approx(3.0)
    assert drawn.section.area * 1.5**2 == pytest.approx(18.0)


def test_block_of_rectangles_is_the_sum_of_their_heights():
    """Ground cylinder: 5 turns of 3 mm less what grinding takes; in a cone, too, as flat faces stay on each other."""
    ends = {"form": "closed and ground", "tip": 0.5}
    cylinder = case(RECTANGLE, end_coils=ends).spring.build()
    assert cylinder.block_height == pytest.approx(3.0 * 5.0, abs=1e-6)
    cone = {"shape": "cone", "bottom": 36.0, "top": 26.0}  # 1 mm a turn
    assert case(RECTANGLE, mean_diameter=cone, end_coils=ends).spring.build().block_height == pytest.approx(15.0)


def test_ellipses_of_a_cone_stand_in_each_others_flanks():
    """Two ellipses a, b touch where (x/2a)² + (z/2b)² = 1: with 1 mm aside z = 5 √(1 − 1/16)."""
    cone = {"shape": "cone", "bottom": 36.0, "top": 26.0}
    spring = case(OVAL, mean_diameter=cone).spring.build()
    assert spring.block_height == pytest.approx(5.0 * 5.0 * np.sqrt(1.0 - 1.0 / 16.0) + 5.0, rel=1e-5)


def test_outer_diameter_counts_the_width():
    spring = case(OVAL, mean_diameter=None, outer_diameter=36.0).spring.build()
    assert spring.mean_radius(0.0) == pytest.approx(16.0)


def test_numbers_of_a_round_ellipse_are_those_of_round_wire():
    """J, W, A, and Göhner's factor, which Bergsträsser's meets within 0.5 % at D/d = 6.4.

    The coil's rate over that of the straight wire is 1/(1 − 3/(16 w²)) but for terms in 1/w⁴ (Ancker and Goodier).
    """
    made = Cylinder.of(case({"oval": {"width": 5.0, "height": 5.0}}).spring.build())
    assert made.wire.torsion == pytest.approx(np.pi * 5.0**4 / 32.0, rel=1e-7)
    assert (made.of_stress, made.of_mass) == pytest.approx((5.0, 5.0), rel=1e-7)
    assert made.wire.curved == pytest.approx(1.0 / (1.0 - 3.0 / (16.0 * 6.4**2)), abs=2e-4)
    assert made.of_rate == pytest.approx(5.0 * made.wire.curved**0.25)
    assert made.correction == pytest.approx((6.4 + 0.5) / (6.4 - 0.75), rel=5e-3)


def test_data_name_the_formula_of_the_rate():
    """That of round wire stands for no rectangle."""
    names = [label for label, *_ in spring_data(case(RECTANGLE).spring.build())]
    assert "rate 4 G J c/(π D³ n)" in names


@pytest.mark.parametrize(("mean", "rate"), [(20.0, 63.55), (30.0, 18.12), (40.0, 7.539)])
def test_rate_of_flat_wire_in_a_coil(mean, rate):
    """5 × 3, of `coilset slice` of the same coil, held ends: by J alone the rate was 6.8, 3.1 and 1.8 % lower."""
    wire = {"rectangle": {"width": 5.0, "height": 3.0, "corner": 0.4}}
    flat = case(wire, mean_diameter=mean, turns=6, pitch=8.18182)
    made = case_sheet(flat, flat.spring.build(), None, "EN 10270-2 VDSiCr")
    shown = {row.label: row.value for _, part in sections(made) for row in part}
    assert shown["R of a rising wire"] == pytest.approx(rate, rel=2e-3)
    assert ("rate 4 G J c/(π D³ n)", f"{shown['rate R']:.5g}", "N/mm") in list(
        spring_data(flat.spring.build(), made.elastic)
    )


def test_section_modulus_of_a_rectangle():
    """2 : 1 with sharp corners: J = 0.2287 b h³, W = 0.2459 b h² (Timoshenko and Goodier, table of Saint-Venant)."""
    sharp = {"rectangle": {"width": 6.0, "height": 3.0}}
    numbers = Cylinder.of(case(sharp).spring.build()).wire
    assert numbers.torsion == pytest.approx(0.2287 * 6.0 * 27.0, rel=1e-3)
    assert numbers.modulus == pytest.approx(0.2459 * 6.0 * 9.0, rel=1e-2)
