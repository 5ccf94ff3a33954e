"""The uniform rod instead of a spring, against closed formulas."""

import numpy as np
import pytest

from coilset.model.core.case import check
from coilset.model.physics.uniform_coil.equivalent import coil
from coilset.model.tools.design.conditions import Condition
from coilset.model.tools.design.surrogate import guess

SPRING = {"wire_diameter": 4.0, "mean_diameter": 40.0, "turns": 6.0, "pitch": 8.0}


def case(spring=SPRING, material="elastic", loading=({"to": {"travel": 3.0}},), **more):
    return check({"spring": spring, "material": material, "ends": "seats", "loading": list(loading), **more})


def test_the_initial_rate_is_that_of_close_coils():
    """G d⁴/(8 D³ n), which knows neither pitch nor curvature: 1 % at D/d 10 and 3.6°."""
    found = guess(case(), [Condition("such_that.rate_N_per_mm", 1.0)]).values[0]
    shear_modulus = 80769.2308  # of the material `elastic`
    assert found == pytest.approx(shear_modulus * 4.0**4 / (8 * 40.0**3 * 6.0), rel=0.01)


def test_a_cone_is_the_cylinder_of_its_compliance():
    """∫ D³ dt of a cone from 30 to 60 mm: (60⁴ − 30⁴)/(4 · 30) over its turns."""
    cone = {**SPRING, "mean_diameter": {"shape": "cone", "bottom": 60.0, "top": 30.0}}
    d, D, pitch, turns = coil(case(cone).spring.build())
    np.testing.assert_allclose([d, pitch, turns], [4.0, 8.0, 6.0], rtol=1e-12)
    assert pytest.approx(((60.0**4 - 30.0**4) / (4 * 30.0)) ** (1 / 3), rel=1e-5) == D


def test_closed_ends_are_not_active():
    closed = {**SPRING, "end_coils": "closed and ground"}
    assert coil(case(closed).spring.build())[3] == pytest.approx(4.0)


def test_a_fully_plastic_wire_carries_four_thirds_of_its_yield_torque():
    """Without hardening: ∫ τ r dA of the full section over that at first yield; bending and curvature add 2 %."""
    loading = [{"to": "block"}, {"to": {"force": 0}}]
    spring = {**SPRING, "pitch": 40.0}
    assert guess(case(spring, "ideal_plastic", loading), []).torque == pytest.approx(4.0 / 3.0, rel=0.02)


def test_tips_that_are_held_do_not_turn():
    """A steep spring on seats was 0.8 % too soft, as one whose ends turn about its axis."""
    targets, steep = [Condition("such_that.force_max_N", 1.0)], {**SPRING, "pitch": 24.0}
    loading, free = [{"to": {"travel": 60.0}}], {"hold": "groove", "top": {"turn": "free"}}
    clamped = check({"spring": steep, "material": "elastic", "ends": "clamped", "loading": loading})
    held = guess(case(steep, loading=loading), targets).values[0]
    assert held == guess(clamped, targets).values[0]
    assert guess(case(steep, loading=loading, seats=free), targets).values[0] < 0.995 * held


def test_a_warm_wire_yields_at_its_own_temperature():
    """The same elastic travel: the torque falls with G, by 10 % to 573.15 K, the yield stress of `creeping` by 20 %."""
    cold, warm = (guess(case(material="creeping", temperature=kelvin), []).torque for kelvin in (293.15, 573.15))
    assert warm / cold == pytest.approx(0.9 / 0.8, rel=1e-3)


def test_what_it_does_not_know_is_no_number():
    names = ("residual_shear_inside_MPa", "free_length_before_mm")
    found = guess(case(), [Condition(f"such_that.{name}", 1.0) for name in names]).values
    assert np.isnan(found[0])
    assert found[1] == pytest.approx(6.0 * 8.0 + 4.0)
