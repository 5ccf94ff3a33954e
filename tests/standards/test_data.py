"""Data of springs against the formulas of the standard and of handbooks."""

import numpy as np
import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.standards.buckling import buckling_travel
from coilset.model.standards.data import spring_data
from coilset.model.standards.rate import torsion_rate
from coilset.model.standards.wires.steel import STEEL

G = 81500.0


def build(**entries):
    return SpringSpec(**{"wire_diameter": 4.0, "mean_diameter": 32.0, "turns": 7.5, "pitch": 10.0} | entries).build()


def test_rate_of_a_cylinder_is_that_of_the_standard():
    data = spring_data(build(end_coils="closed and ground"))
    assert data.is_cylinder
    assert data.active_turns == 5.5
    assert data.rate == pytest.approx(G * 4.0**4 / (8 * 32.0**3 * 5.5), rel=1e-12)  # R = G d⁴/(8 D³ n)
    assert data.index == pytest.approx((8, 8))


def test_a_heavy_spring_is_weighed_in_kilograms():
    """Ten times as large in each direction, a thousand times as heavy."""
    light, heavy = (
        {name: (value, unit) for name, value, unit in spring_data(build(**lengths)).rows()}["mass"]
        for lengths in ({}, {"wire_diameter": 40.0, "mean_diameter": 320.0, "pitch": 100.0})
    )
    assert light[1] == "g"
    assert heavy == (light[0], "kg")


def test_rate_of_a_cone_is_wahls():
    # Wahl, Mechanical Springs: δ = 16 P n (r1 + r2)(r1² + r2²)/(G d⁴)
    cone = build(mean_diameter={"shape": "cone", "bottom": 60.0, "top": 30.0}, turns=5.0, pitch=14.0)
    assert torsion_rate(cone, G) == pytest.approx(G * 4.0**4 / (16 * 5 * (30 + 15) * (30**2 + 15**2)), rel=1e-12)
    assert not spring_data(cone).is_cylinder


def test_rate_of_a_barrel():
    # 1/R = 64/(G d⁴) ∫ r³ dt, r = a − h x², t = n (1 + x)/2: n/2 ∫ (a − h x²)³ dx = n (a³ − a² h + 3/5 a h² − h³/7)
    barrel = build(mean_diameter={"shape": "barrel", "ends": 30.0, "middle": 50.0}, turns=6.0, pitch=14.0)
    a, h = 25.0, 10.0
    integral = 6 * (a**3 - a**2 * h + 0.6 * a * h**2 - h**3 / 7)
    assert torsion_rate(barrel, G) == pytest.approx(G * 4.0**4 / (64 * integral), rel=1e-12)


def test_mass_and_length():
    data = spring_data(build(turns=5.0, pitch=10.0))
    length = 5 * np.hypot(np.pi * 32, 10)
    assert data.wire_length == pytest.approx(length, rel=1e-12)
    assert data.mass == pytest.approx(7.85e-6 * np.pi * 4 * length, rel=1e-12)
    assert (data.outer_diameter, data.inner_diameter) == pytest.approx((36, 28))


def test_buckling_limits_of_the_standard():
    # EN 13906-1: no buckling below L0/D = π/ν √((1/2 + G/E)/(1 − G/E))⁻¹, at half of L0/(1 − G/E) on that limit
    ratio = STEEL.shear_modulus / STEEL.young_modulus
    limit = np.pi / 0.5 * np.sqrt((1 - ratio) / (0.5 + ratio))
    below, above = (build(turns=20.0, pitch=None, free_length=32.0 * limit * factor) for factor in (0.999, 1.0001))
    assert buckling_travel(below) == np.inf
    assert buckling_travel(above) == pytest.approx(above.free_length * 0.5 / (1 - ratio), rel=0.03)
    assert buckling_travel(above) < above.free_length * 0.5 / (1 - ratio)


def test_rows_are_readable():
    rows = {label: (text, unit) for label, text, unit in spring_data(build(hand="left")).rows()}
    assert rows["free length"] == ("79", "mm")
    assert rows["hand"] == ("left", "")
    assert rows["spring index D/d"] == ("8", "")
