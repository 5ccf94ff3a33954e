"""The uniform rod: closed solutions, its derivatives, ways to drive it, and the slice."""

import math

import numpy as np
import pytest

from coilset.model.core.base.errors import SolveError
from coilset.model.core.material import library
from coilset.model.core.material.point.loops import with_loop
from coilset.model.core.section.rules import polar, upper_half
from coilset.model.physics.manufacture.entries import Relief
from coilset.model.physics.uniform_coil import rod as uniform
from coilset.model.physics.uniform_coil.past import DISK, coiled
from coilset.model.physics.uniform_coil.section import Coil, force_shear, integrate, residual_and_tangent, strains

COIL = np.array([5.0, 40.0, 12.0, 2.5])


def coil(law, free=True):
    rule, R, h = polar(), 20.0, 12.0 / (2 * np.pi)
    y, z = 2.5 * np.ascontiguousarray(rule.points.T)
    j = math.hypot(R, h)
    bend, area = R / j**2, np.pi * 6.25 * rule.weights
    return Coil(with_loop(law.parameters(), 3), R, h, j, y, z, area, bend, *force_shear(2.5, y, z, bend), True, free)


def forces(case, q, old_E, points):
    """∂W/∂q and its derivative at q, from the state at `old_E`."""
    E, S, T, f, K = np.empty(4), np.empty(4), np.empty((4, 4)), np.empty(4), np.empty((4, 4))
    new = np.empty_like(points)
    strains(case, q, E)
    assert integrate(case, E, old_E, points, new, S, T)
    residual_and_tangent(case, q, S, T, f, K)
    return f, K, E, new


@pytest.mark.parametrize("relief", [None, Relief(temperature=523.15, minutes=30)])
def test_coiled_wire_rests_in_the_uniform_coil(relief):
    """Its stress carries no force or moment there, signs of shear included; it is as large as the yield stress."""
    law = library.load("creeping" if relief else "ck15")
    case, points = coil(law), coiled(COIL, law, relief).points[0]
    half = upper_half(DISK)
    y, z = 2.5 * np.ascontiguousarray(half.points.T)
    case = case._replace(y=y, z=z, area=np.pi * 6.25 * half.weights)
    across, along = force_shear(2.5, y, z, case.bend)
    case, S = case._replace(across=across, along=along), np.empty(4)
    integrate(case, np.zeros(4), np.zeros(4), points, np.empty_like(points), S, np.empty((4, 4)))
    force = np.pi * 6.25 * law.yield_stress
    assert np.abs(S / [force, force, 2.5 * force, 2.5 * force]).max() < 1e-6
    assert 0.6 < np.abs(points[:, 0]).max() / law.yield_stress < 3.0
    assert np.abs(points[:, 1:3]).max() > 0.03 * law.yield_stress


def test_tangent_in_a_plastic_state():
    law = library.load("ck15")
    case = coil(law)
    start = np.array([20.0, math.atan2(case.h, 20.0), case.h, 1.0])
    points = uniform.unloaded(COIL, law, polar()).points[0]
    q = start + np.array([0.02, -0.02, -0.4, 0.005])
    _, _, E, points = forces(case, q, np.zeros(4), points)
    assert (points[:, 6] > 0).all()
    q = q + np.array([0.01, -0.005, -0.1, 0.002])
    f, K, _, _ = forces(case, q, E, points)
    direction = np.array([0.05, 0.01, 0.2, 0.01])
    steps = np.array([2e-2, 1e-2, 5e-3])
    rest = [np.linalg.norm(forces(case, q + s * direction, E, points)[0] - f - s * K @ direction) for s in steps]
    assert np.polyfit(np.log(steps), np.log(rest), 1)[0] == pytest.approx(2.0, abs=0.1)
    assert rest[-1] < 0.05 * steps[-1] * np.linalg.norm(K @ direction)


def test_elastic_rate_is_that_of_a_straight_wire():
    # slender coil without pitch: G d⁴/(8 D³ n), corrections of order (d/D)² = 1e-4
    law = library.load("elastic")
    coil = np.array([5.0, 500.0, 1e-6, 3.0])
    force, _ = uniform.press(coil, law, travels=[1e-3])
    assert force[0, 0] / 1e-3 == pytest.approx(law.G * 5**4 / (8 * 500**3 * 3), rel=2e-4)


def test_near_the_slice():
    # the slice with 602 unknowns has 185.879 N and 4.47286 mm, see verification slice-uniform; here −0.02 % and 0.01 %
    law = library.load("ck15")
    force, state = uniform.press([5.0, 40.0, 12.0, 1.0], law, travels=6.3 * np.arange(1, 13) / 12)
    back, state = uniform.press(state, law, forces=[0.0])
    assert force[0, -1] == pytest.approx(185.879, rel=5e-4)
    assert back[0, 0] == pytest.approx(4.47286, rel=3e-4)
    assert abs(state.force[0]) < 1e-6
    assert state.travel[0] == pytest.approx(back[0, 0], rel=1e-12)


def test_half_of_a_symmetric_rule_is_the_whole():
    law = library.load("ck15")
    travels = np.linspace(2, 12, 6)
    whole, half = (uniform.press(COIL, law, travels=travels, rule=r)[0] for r in (polar(), upper_half(polar())))
    assert half == pytest.approx(whole, rel=1e-12)


def test_travel_and_force_drive_alike():
    law = library.load("ck15")
    travels = np.array([2.0, 4.0, 8.0])
    found, state = uniform.press(COIL, law, travels=travels)
    back, other = uniform.press(COIL, law, forces=found[0])
    assert back[0] == pytest.approx(travels, rel=1e-6)  # 1e-9 of the force, at a slope that flow has made small
    assert other.torque == pytest.approx(state.torque, rel=1e-6)


def test_free_ends_bear_no_torque():
    law = library.load("ck15")
    travels = np.linspace(2, 12, 6)
    held, state = uniform.press(COIL, law, travels=travels)
    free, other = uniform.press(COIL, law, travels=travels, free_ends=True)
    assert abs(other.torque[0]) < 1e-6 * state.torque[0]
    assert other.q[0, 3] < 1.0 == state.q[0, 3]
    assert free[0, -1] < held[0, -1]


def test_many_coils_are_each_their_own_and_the_state_given_stays():
    law = library.load("ck15")
    coils = np.tile(COIL, (3, 1))
    coils[:, 2] = 11.0, 12.0, 13.0
    travels = np.linspace(1, 10, 5)
    together, state = uniform.press(coils, law, travels=travels)
    alone = [uniform.press(coil, law, travels=travels)[0][0] for coil in coils]
    assert together == pytest.approx(np.array(alone), rel=1e-12)
    before = state.copy()
    uniform.press(state, law, forces=[0.0])
    assert np.array_equal(before.q, state.q)
    assert np.array_equal(before.points, state.points)


def test_what_cannot_be_is_said():
    law = library.load("ideal_plastic")
    with pytest.raises(SolveError, match="no equilibrium of the uniform coil"):
        uniform.press(COIL, law, forces=[1e5])
    with pytest.raises(ValueError, match="either"):
        uniform.press(COIL, law)
