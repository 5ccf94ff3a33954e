"""Data of springs against the formulas of the standard and of handbooks."""

import numpy as np
import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.material.law.steel import STEEL
from coilset.model.tools.sheet.spring_data import spring_data
from coilset.model.tools.standards.buckling import buckling_travel
from coilset.model.tools.standards.rate import torsion_rate

G = 81500.0


def build(**entries):
    return SpringSpec(**{"wire_diameter": 4.0, "mean_diameter": 32.0, "turns": 7.5, "pitch": 10.0} | entries).build()


def rows_of(spring):
    return {label: (text, unit) for label, text, unit in spring_data(spring)}


def test_rate_of_a_cylinder_is_that_of_the_standard():
    spring = build(end_coils="closed and ground")
    rate = G * 4.0**4 / (8 * 32.0**3 * 5.5)  # R = G d⁴/(8 D³ n)
    assert torsion_rate(spring, G) == pytest.approx(rate, rel=1e-12)
    rows = rows_of(spring)
    assert rows["rate G d⁴/(8 D³ n), EN 13906-1"] == (f"{rate:.5g}", "N/mm")
    assert rows["active turns"] == ("5.5", "")
    assert rows["spring index D/d"] == ("8", "")


def test_a_heavy_spring_is_weighed_in_kilograms():
    """Ten times as large in each direction, a thousand times as heavy."""
    light, heavy = (
        rows_of(build(**lengths))["mass"]
        for lengths in ({}, {"wire_diameter": 40.0, "mean_diameter": 320.0, "pitch": 100.0})
    )
    assert light[1] == "g"
    assert heavy == (light[0], "kg")


def test_rate_of_a_cone_is_wahls():
    # Wahl, Mechanical Springs: δ = 16 P n (r1 + r2)(r1² + r2²)/(G d⁴)
    cone = build(mean_diameter={"shape": "cone", "bottom": 60.0, "top": 30.0}, turns=5.0, pitch=14.0)
    assert torsion_rate(cone, G) == pytest.approx(G * 4.0**4 / (16 * 5 * (30 + 15) * (30**2 + 15**2)), rel=1e-12)
    assert "rate by torsion, G/(64 ∫ r³/d⁴ dn)" in rows_of(cone)


def test_rate_of_a_barrel():
    # 1/R = 64/(G d⁴) ∫ r³ dt, r = a − h x², t = n (1 + x)/2: n/2 ∫ (a − h x²)³ dx = n (a³ − a² h + 3/5 a h² − h³/7)
    barrel = build(mean_diameter={"shape": "barrel", "ends": 30.0, "middle": 50.0}, turns=6.0, pitch=14.0)
    a, h = 25.0, 10.0
    integral = 6 * (a**3 - a**2 * h + 0.6 * a * h**2 - h**3 / 7)
    assert torsion_rate(barrel, G) == pytest.approx(G * 4.0**4 / (64 * integral), rel=1e-12)


def test_mass_and_length():
    spring = build(turns=5.0, pitch=10.0)
    length = 5 * np.hypot(np.pi * 32, 10)
    assert spring.wire_length == pytest.approx(length, rel=1e-12)
    rows = rows_of(spring)
    assert rows["mass"] == (f"{7.85e-3 * np.pi * 4 * length:.4g}", "g")
    assert (rows["outer diameter"], rows["inner diameter"]) == (("36", "mm"), ("28", "mm"))


def test_buckling_limits_of_the_standard():
    # EN 13906-1: no buckling below L0/D = π/ν √((1/2 + G/E)/(1 − G/E))⁻¹, at half of L0/(1 − G/E) on that limit
    ratio = STEEL.shear_modulus / STEEL.young_modulus
    limit = np.pi / 0.5 * np.sqrt((1 - ratio) / (0.5 + ratio))
    below, above = (build(turns=20.0, pitch=None, free_length=32.0 * limit * factor) for factor in (0.999, 1.0001))
    assert buckling_travel(below) == np.inf
    assert buckling_travel(above) == pytest.approx(above.free_length * 0.5 / (1 - ratio), rel=0.03)
    assert buckling_travel(above) < above.free_length * 0.5 / (1 - ratio)


def test_rows_are_readable():
    rows = rows_of(build(hand="left"))
    assert rows["free length"] == ("79", "mm")
    assert rows["hand"] == ("left", "")
