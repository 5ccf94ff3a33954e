"""Cylinders of the standard, and the warning about presetting, just on either side of its bound."""

import numpy as np
import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.warning import Warning
from coilset.model.core.material.law.steel import STEEL, Elastic
from coilset.model.tools.limits.presetting import presetting_warning
from coilset.model.tools.sheet.sheet import Sheet
from coilset.model.tools.standards import en13906
from coilset.model.tools.standards.cylinder import Cylinder

SPEC = {
    "wire_diameter": 4.0,
    "mean_diameter": 32.0,
    "turns": 7.5,
    "free_length": 60.0,
    "end_coils": "closed and ground",
}


def cylinder(**entries):
    return Cylinder.of(SpringSpec.model_validate(SPEC | entries).build())


def made(spring, lengths=(), shear_modulus=81500.0, dynamic=False):
    return Sheet(spring, Elastic(shear_modulus, 206e3, STEEL.density), 1e3, lengths=lengths, dynamic=dynamic)


def test_cylinder_of_a_spring():
    found = cylinder()
    assert (found.d, found.D, found.turns, found.n, found.ends) == (4.0, 32.0, 7.5, 5.5, "closed and ground")
    assert found.length == pytest.approx(60.0)
    assert found.solid == pytest.approx(28.0)
    # ground tips take 2 · 0.25 · 4 mm off the rise, end coils rise by 4 mm each: 60 + 2 = 2 · 4 + 5.5 m
    assert found.pitch == pytest.approx((60.0 + 2.0 - 8.0) / 5.5)


def test_other_shapes_are_refused():
    with pytest.raises(InputError) as error:
        cylinder(mean_diameter={"shape": "cone", "bottom": 40.0, "top": 30.0}, end_coils="open")
    assert str(error.value) == (
        "spring.mean_diameter: EN 13906-1 is for cylinders of one wire; the mean diameter goes from 30 to 40 mm"
    )


def test_presetting():
    assert presetting_warning(3.3, 32.0) is None
    found = presetting_warning(1.6, 32.0)
    assert isinstance(found, Warning)
    assert found.message == "presetting takes 1.6 mm, 5 % of the travel to block; a set of 10 % or more is usual"
    longer = presetting_warning(-1.6, 32.0)
    assert longer is not None
    assert longer.message.startswith("presetting leaves the spring longer by 1.6 mm, 5 % of the travel")
    assert longer.value == -1.6
    elastic = presetting_warning(-9e-15, 32.0)  # by rounding
    assert elastic is not None
    assert elastic.message.startswith("presetting takes 0 mm, 0 % of")


VARIABLE = {  # a valve spring of variable pitch: the close coils close first
    "wire_diameter": 4.0,
    "outer_diameter": 32.0,
    "turns": 7.5,
    "pitch": {"turns": [0.0, 7.5], "values": [6.0, 14.5], "interpolation": "linear"},
    "end_coils": "closed and ground",
}


def variable():
    return Cylinder.of(SpringSpec.model_validate(VARIABLE).build())


def test_coils_of_variable_pitch_close_one_by_one():
    """s(F) = ∫ min(F/R₁, p − d) dt over the active turns, by the trapezoidal rule; R (L0 − L) is too low near block."""
    spring, turn_rate = variable(), 81500.0 * 4.0**4 / (8 * 28.0**3)
    geometry = SpringSpec.model_validate(VARIABLE).build()
    turn = np.linspace(1.0, 6.5, 100_001)
    play = geometry.pitch(turn) - 4.0
    for force in (100.0, 400.0, 900.0):
        travel = np.trapezoid(np.minimum(force / turn_rate, play), turn)
        assert spring.series_force(float(travel), turn_rate) == pytest.approx(force, rel=1e-3)
        assert made(spring).force(spring.length - travel) == pytest.approx(force, rel=1e-3)
    assert made(spring).force(spring.solid) == pytest.approx(turn_rate * play.max(), rel=2e-3)
    assert made(spring).force(spring.solid) > 1.4 * made(spring).rate * (spring.length - spring.solid)


def test_springs_of_thick_wire_are_coiled_hot():
    """Ground: Lc = (n_t − 0.3) d, Sa = 0.02 n (D + d); no formula for unground ones."""
    hot = cylinder(wire_diameter=25.0, mean_diameter=150.0, free_length=420.0)
    assert made(hot).block == pytest.approx(7.2 * 25.0)
    assert en13906.gap_sum(25.0, 150.0, 5.5) == pytest.approx(0.02 * 5.5 * 175.0)
    assert made(cylinder(wire_diameter=25.0, mean_diameter=150.0, free_length=420.0, end_coils="closed")).block is None
    assert made(cylinder(wire_diameter=20.0, mean_diameter=150.0, free_length=420.0)).block == pytest.approx(150.0)
