"""Yield that depends on the rate: limits, steady flow in closed form, relaxation against scipy, Taylor tests."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point.loops import follow
from coilset.model.physics.time.creep.law import RateLaw

YIELD, G, NU = 400.0, 80000.0, 0.3
SLOW, FAST = 1e12, 1e-12  # seconds that an increment takes


def law_of(exponent=5.0, reference_rate=100.0, slope=0.0, zeta=0.0, **more):
    """Linear hardening, σ = YIELD + slope εᵖ in tension."""
    constants = {
        "temperature": 293.15,
        "elasticity": {"G": G, "nu": NU},
        "non_normality": "none",
        "isotropic": {"k0_squared": 2 / 3 * YIELD**2, "a1": 1.0, "a2": 4 / 3 * slope},
        "kinematic": {"a5": zeta, "a6": 1e-3, "a7": 0.0} if zeta else "none",
    }
    about = {
        "name": "synthetic",
        "description": "a law",
        "source": "none",
        "units": "N, mm, K",
        "validity": {"plastic_work": 100, "remark": "none"},
        "temperatures": [constants],
        "rate": {"reference_rate": reference_rate, "exponent": exponent},
    }
    return Law(MaterialFile.model_validate(about | more))


def advance(law, state, de, seconds):
    """One increment; state and tangent."""
    parts = law.parts()
    if seconds is not None:
        parts = RateLaw(law.data.rate, parts).over(np.zeros(3), np.array([seconds / 3600.0, 293.15, 0.0]))
    new, C, count = follow(parts, state[None], de[None])
    assert count[0] >= 0
    return new[0], C[0]


def unit(rng, n):
    v = rng.normal(size=n)
    return v / np.linalg.norm(v)


@pytest.mark.parametrize("components", [3, 6])
@pytest.mark.parametrize("exponent", [1.0, 5.0, 12.0])
def test_limits(components, exponent):
    """Infinitely slow, it is the law without time; so fast that nothing can flow, it is elastic."""
    law, rng = law_of(exponent, slope=3000.0, zeta=5.0), np.random.default_rng(1)
    state = np.zeros(2 * components + 1)
    for _ in range(6):
        de = 4e-3 * unit(rng, components)
        static, C = advance(law, state, de, None)
        slow, D = advance(law, state, de, SLOW**exponent)
        np.testing.assert_allclose(slow[:-1], static[:-1], atol=1e-6 * YIELD)
        np.testing.assert_allclose(D, C, atol=1e-4 * law.E)
        fast, _ = advance(law, state, de, FAST**exponent)
        hooke = 1e6 * advance(law, np.zeros_like(state), 1e-6 * de, None)[0][:components]
        np.testing.assert_allclose(fast[:components], state[:components] + hooke, atol=1e-3 * YIELD)
        state = static
    assert state[-1] > 1.0


@pytest.mark.parametrize("exponent", [1.0, 4.0, 12.0])
@pytest.mark.parametrize("rate", [1e-3, 1.0, 1e3])
def test_steady_flow(exponent, rate):
    """At a constant strain rate without hardening: σ = σ_y (1 + (ε̇/ṗ₀)^(1/m)) in tension, τ by √3 less in torsion."""
    law = law_of(exponent)
    beyond = YIELD * (1.0 + (rate / 100.0) ** (1.0 / exponent))
    steps, end = 60, 16.0 * beyond / law.E
    tension, torsion = np.zeros(7), np.zeros(7)
    for _ in range(steps):
        tension, _ = advance(law, tension, np.array([end / steps, 0.0, 0.0]), end / steps / rate)
        torsion, _ = advance(law, torsion, np.array([0.0, np.sqrt(3) * end / steps, 0.0]), end / steps / rate)
    assert tension[0] == pytest.approx(beyond, rel=1e-6)
    assert torsion[1] == pytest.approx(beyond / np.sqrt(3), rel=1e-6)


def test_stress_beyond_yield_relaxes():
    """Pulled fast, then held: σ̇ = −E ṗ₀ (σ/σ_y(b*) − 1)^m and ḃ* = σ ṗ of a bar, by scipy; of second order."""
    law, H = law_of(3.0, slope=2000.0), 2000.0
    E, errors = law.E, []
    start, _ = advance(law, np.zeros(7), np.array([4e-3, 0.0, 0.0]), 1e-9)
    assert start[0] == pytest.approx(4e-3 * E, rel=1e-3)
    seconds = 1e-4

    def rates(_, y):
        p = 100.0 * max(y[0] / np.sqrt(YIELD**2 + 2.0 * H * y[1]) - 1.0, 0.0) ** 3
        return [-E * p, y[0] * p]

    exact = solve_ivp(rates, (0.0, seconds), start[[0, 6]], "LSODA", rtol=1e-10, atol=1e-8).y[0, -1]
    assert YIELD * 1.05 < exact < 0.7 * start[0]
    for n in (50, 100):
        state = start
        for _ in range(n):
            state, _ = advance(law, state, np.zeros(3), seconds / n)
        errors.append(state[0] - exact)
    assert abs(errors[1]) < 0.02 * exact
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.4)


def test_small_flow_at_much_work():
    """Increments down to rounding find their end, from far beyond yield, whatever the time they take."""
    law, rng = law_of(5.5, slope=2000.0), np.random.default_rng(2)
    state = np.zeros(7)
    for _ in range(20):
        state, _ = advance(law, state, 3e-3 * unit(rng, 3), 1e-3)
    assert state[6] > 5.0
    for size in 10.0 ** np.arange(-16.0, -3.0):
        for seconds in (1e-9, 1e-3, 1e6):
            for _ in range(5):
                new, _ = advance(law, state, size * unit(rng, 3), seconds)
                assert new[6] >= state[6]


@pytest.mark.parametrize("components", [3, 6])
@pytest.mark.parametrize("exponent", [1.0, 6.0])
def test_tangent(components, exponent):
    """The Taylor remainder σ(ε + h v) − σ(ε) − h C v falls as h², from virgin, flowing and overstressed states."""
    law, rng = law_of(exponent, slope=4000.0, zeta=5.0), np.random.default_rng(8)
    steps = 10.0 ** np.arange(-2, -4.01, -0.5)
    for seconds in (1e-6, 1e-3, 1.0, 1e6):
        state = np.zeros(2 * components + 1)
        for size, before in ((3e-3, 1e-5), (2e-3, seconds)):
            state, _ = advance(law, state, size * unit(rng, components), before)
        de, v = (3e-3 * unit(rng, components) for _ in range(2))
        new, C = advance(law, state, de, seconds)
        rest = []
        for h in steps:
            moved, _ = advance(law, state, de + h * v, seconds)
            rest.append(np.linalg.norm(moved[:components] - new[:components] - h * C @ v) / np.linalg.norm(h * C @ v))
        assert rest[-1] < 2e-3
        if rest[0] > 1e-8:  # else it is linear
            assert np.polyfit(np.log(steps), np.log(rest), 1)[0] > 0.9


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"heating": {"dissipated": 0.9, "density": 7.85e-9, "specific_heat": 4.7e8}}, "constants at two temperatures"),
        ({"rate": {"reference_rate": 0.0, "exponent": 5.0}}, "greater than 0"),
    ],
)
def test_what_the_rate_goes_not_with(more, message):
    with pytest.raises((InputError, ValueError), match=message):
        law_of(**more)
