"""Warnings at working lengths and about presetting, each just on either side of its bound."""

import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.base.errors import InputError
from coilset.model.base.warning import Warning
from coilset.model.standards.cylinder import Cylinder
from coilset.model.standards.wires import wire
from coilset.model.standards.working import gap_warnings, presetting_warning, stress_warnings

SPEC = {
    "wire_diameter": 4.0,
    "mean_diameter": 32.0,
    "turns": 7.5,
    "free_length": 60.0,
    "end_coils": "closed and ground",
}


def cylinder(**entries):
    return Cylinder.of(SpringSpec.model_validate(SPEC | entries).build())


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


def test_gap():
    # Sa = 5.5 (0.0015 · 32²/4 + 0.4) = 4.312 mm over the block length of 28 mm
    assert gap_warnings(cylinder(), [50.0, 32.32]) == []
    (found,) = gap_warnings(cylinder(), [50.0, 32.3])
    assert (
        found.message == "at 32.3 mm the gaps between the coils add up to 4.3 mm, less than the 4.31 mm of EN 13906-1"
    )
    assert found.limit == pytest.approx(4.312)
    assert len(gap_warnings(cylinder(), [32.32], dynamic=True)) == 1


def test_stress():
    # R = 81500 · 4⁴/(8 · 32³ · 5.5) = 14.47 N/mm; τ = 8 D R s/(π d³) = 18.42 s; 0.56 (2230 − 820 lg 4) = 972.3 N/mm²
    known = wire("EN 10270-1 SH")
    bound = 972.35 / 18.425
    assert stress_warnings(cylinder(free_length=90.0), 81500.0, [90 - bound + 0.1], known) == []
    (found,) = stress_warnings(cylinder(free_length=90.0), 81500.0, [90 - bound - 0.1], known)
    assert found.name == "stress"
    assert found.limit == pytest.approx(972.3, abs=0.1)
    assert "allowed for EN 10270-1 SH" in found.message


def test_stress_of_american_wire_is_corrected():
    """Shigley's table 10-6: 45 % of Rm for music wire, with the correction for curvature in the stress."""
    known, spring = wire("ASTM A228"), cylinder(free_length=90.0)
    # G = 80,000: τ = 18.086 s; k = 8.5/7.25; Rm of the table at 4 mm, between 1744 and 1717
    bound = 0.45 * known.strength(4.0) / (18.086 * 8.5 / 7.25)
    assert stress_warnings(spring, 80000.0, [90 - bound + 0.1], known) == []
    (found,) = stress_warnings(spring, 80000.0, [90 - bound - 0.1], known)
    assert "the nominal corrected stress is" in found.message
    assert found.limit == pytest.approx(0.45 * 1726, rel=5e-3)


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
