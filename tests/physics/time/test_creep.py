"""Creep at one point: against scipy's stiff integrators on the rates as they stand, closed relations, Taylor tests.

The material is synthetic: no steel's creep was measured for it.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from coilset.model.core.material import library
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point import points
from coilset.model.core.material.point.loops import follow, with_loop
from coilset.model.core.material.point.over_step import law_over_step
from coilset.model.core.runtime.kernels import KERNEL, njit
from coilset.model.physics.time import increment
from coilset.model.physics.time.creep.law import GAS_CONSTANT, CreepLaw
from coilset.model.physics.time.creep.rod import without_yield
from coilset.model.physics.time.stage import ROOM

COLD, WARM, ALPHA = 293.15, 473.15, 1.2e-5
MODULI = {COLD: (80000.0, 0.29), WARM: (74000.0, 0.31)}
CREEP = {
    "form": "norton_bailey",
    "strain": 2e-4,
    "stress": 500.0,
    "exponent": 6.0,
    "time_exponent": 0.3,
    "activation_energy": 90000.0,
    "temperature": 323.15,
}
GAROFALO = CREEP | {"form": "garofalo", "stress": 150.0, "strain": 1e-8, "exponent": 4.0, "time_exponent": 1.0}


def law_of(entries, isotropic="none", kinematic="none"):
    """A law of constants at two temperatures, elastic or yielding, with the given creep."""
    temperatures = [
        {
            "temperature": t,
            "elasticity": {"G": G, "nu": nu, "alpha": ALPHA},
            "isotropic": isotropic,
            "kinematic": kinematic,
            "non_normality": "none",
        }
        for t, (G, nu) in MODULI.items()
    ]
    about = {
        "name": "synthetic",
        "description": "a law",
        "source": "none",
        "units": "N, mm, K",
        "validity": {"plastic_work": 100, "remark": "none"},
    }
    return Law(MaterialFile.model_validate(about | {"temperatures": temperatures, "creep": entries}))


def advance(law, state, de, before, after):
    """One increment over the time between two clocks; state and tangent."""
    new, C, count = follow(CreepLaw(law.data.creep, law.parts()).over(before, after), state[None], de[None])
    assert count[0] >= 0
    return new[0], C[0]


def unstressed(components, temperature=COLD):
    return np.concatenate([np.zeros(2 * components + 1), [temperature, 0.0]])


class Rates:
    """The rates of creep and elasticity as they stand; y are the stress-giving strains and c, time is in hours."""

    def __init__(self, entries, components):
        self.c, self.n = entries, components

    def stress(self, elastic, T):
        (G0, nu0), (G1, nu1) = MODULI.values()
        w = (T - COLD) / (WARM - COLD)
        G, E = G0 + w * (G1 - G0), 2 * G0 * (1 + nu0) + w * (2 * G1 * (1 + nu1) - 2 * G0 * (1 + nu0))
        if self.n == 3:
            return np.array([E, G, G]) * elastic
        bulk = E * G / (3 * (3 * G - E))
        volume = elastic[:3].sum()
        normal = 2 * G * (elastic[:3] - volume / 3) + bulk * volume
        return np.concatenate([normal, G * elastic[3:]])

    def tensor(self, s):
        if self.n == 3:
            return np.array([[s[0], s[1], s[2]], [s[1], 0, 0], [s[2], 0, 0]])
        return np.array([[s[0], s[3], s[4]], [s[3], s[1], s[5]], [s[4], s[5], s[2]]])

    def creep(self, elastic, c, t, T):
        """Rates of creep strain and of c."""
        S = self.tensor(self.stress(elastic, T))
        S = S - np.trace(S) / 3 * np.eye(3)
        size = np.sqrt(1.5 * (S * S).sum())
        k, p = self.c, self.c["time_exponent"]
        if k["form"] == "garofalo":
            phi = k["strain"] * np.sinh(size / k["stress"]) ** k["exponent"]
        else:
            phi = k["strain"] * (size / k["stress"]) ** k["exponent"]
        worth = np.exp(-k["activation_energy"] / GAS_CONSTANT * (1 / T - 1 / k["temperature"]))
        if k.get("hardening") == "time":
            rate = phi * worth * p * t ** (p - 1)  # of time that is worth the same throughout
        else:
            rate = worth * p * phi ** (1 / p) * c ** (1 - 1 / p)
        D = 1.5 * rate * S / size
        full = (
            np.array([D[0, 0], 2 * D[0, 1], 2 * D[0, 2]])
            if self.n == 3
            else np.array([D[0, 0], D[1, 1], D[2, 2], 2 * D[0, 1], 2 * D[0, 2], 2 * D[1, 2]])
        )
        return full, rate

    def through(self, elastic, c, segment):
        """Along one segment: (hours at its start and end, strain increment, temperatures at both)."""
        t0, t1, de, T0, T1 = segment
        alpha = np.where(np.arange(self.n) < (1 if self.n == 3 else 3), ALPHA, 0.0)

        def rates(w, y):  # t = t0 + w^(1/p): smooth from t = 0 on
            m = 1 / self.c["time_exponent"]
            t = t0 + w**m
            T = T0 + (t - t0) / (t1 - t0) * (T1 - T0)
            flow, rate = self.creep(y[:-1], y[-1], t, T)
            return np.append((de - alpha * (T1 - T0)) / (t1 - t0) - flow, rate) * m * w ** (m - 1)

        p = self.c["time_exponent"]
        y0 = np.append(elastic, c)
        end = solve_ivp(rates, (1e-9 * (t1 - t0) ** p, (t1 - t0) ** p), y0, "Radau", rtol=1e-9, atol=1e-13)
        assert end.success
        return end.y[:-1, -1], end.y[-1, -1]


def path(seed, components):
    """Segments from zero on: a load at once, held, changed and held again, the temperature going up and down."""
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(10.0 ** rng.uniform(0, 2.5, 4))])
    temperatures = [COLD, *rng.uniform(COLD + 20, WARM - 10, 4)]
    sizes = [0.5, 0.3, 0.0, 0.3]
    return [
        (times[k], times[k + 1], sizes[k] * 4e-3 * _unit(rng, components), temperatures[k], temperatures[k + 1])
        for k in range(4)
    ], 5e-3 * _unit(rng, components)


def _unit(rng, n):
    v = rng.normal(size=n)
    return v / np.linalg.norm(v)


def error_along(law, rates, segments, first, n):
    """Maximum error of stress at the segments' ends over the maximum stress, with n increments a segment."""
    creeping, components = CreepLaw(law.data.creep, law.parts()), rates.n
    clock = creeping.clock(0.0, COLD)
    state, _ = advance(law, unstressed(components), first, clock, clock)
    elastic, c, error, greatest = first.copy(), 1e-12, 0.0, 0.0
    for segment in segments:
        t0, t1, de, T0, T1 = segment
        parts = np.linspace(0, 1, n + 1) ** 3
        for a, b in pairwise(parts):
            after = creeping.clock(t0 + b * (t1 - t0), T0 + b * (T1 - T0), clock)
            state, _ = advance(law, state, (b - a) * de, clock, after)
            clock = after
        elastic, c = rates.through(elastic, c, segment)
        expected = rates.stress(elastic, T1)
        error = max(error, np.abs(state[:components] - expected).max())
        greatest = max(greatest, np.abs(expected).max())
    assert state[-1] == pytest.approx(c, rel=2e-3)
    return error / greatest


@pytest.mark.parametrize("seed", range(10))
def test_paths_against_scipy(seed):
    """Ten paths with changing temperature, 80 increments a segment: within 0.1 %; with half of them, 4 times as far."""
    components, entries = (3, 6)[seed % 2], (CREEP, GAROFALO)[seed // 2 % 2]
    law, rates = law_of(entries), Rates(entries, components)
    coarse, fine = (error_along(law, rates, *path(seed, components), n) for n in (40, 80))
    assert fine < 1e-3
    assert coarse / fine == pytest.approx(4, abs=0.5)


@pytest.mark.parametrize("components", [3, 6])
def test_time_hardening_against_scipy(components):
    """The rate depends on time; the temperature is that of the constants, for which the reference is written."""
    entries = CREEP | {"hardening": "time"}
    law, rates = law_of(entries), Rates(entries, components)
    segments, first = path(3, components)
    T = entries["temperature"]
    cold = (*segments[0][:2], np.zeros(components), T, T)
    clock = CreepLaw(law.data.creep, law.parts()).clock(0.0, T)
    start, _ = advance(law, unstressed(components, T), first, clock, clock)
    elastic, _ = rates.through(first, 0.0, cold)
    errors = []
    for n in (20, 40):
        state, clock = start, CreepLaw(law.data.creep, law.parts()).clock(0.0, T)
        for t in cold[1] * (np.arange(1, n + 1) / n) ** 3:
            after = CreepLaw(law.data.creep, law.parts()).clock(t, T, clock)
            state, _ = advance(law, state, cold[2], clock, after)
            clock = after
        errors.append(np.abs(state[:components] - rates.stress(elastic, T)).max() / np.abs(state[:components]).max())
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4, abs=0.6)


@pytest.mark.parametrize("hours", [1e-3, 1.0, 1e5])
def test_relaxation(hours):
    """Torsion at constant γ, time hardening: τ^(1−N) = τ₀^(1−N) + (N − 1) G A t^p with A = √3^(N+1) c₀/σ₀^N."""
    entries = CREEP | {"hardening": "time", "activation_energy": 0.0}
    law, (G, _) = law_of(entries), MODULI[COLD]
    N, p = entries["exponent"], entries["time_exponent"]
    A = np.sqrt(3) ** (N + 1) * entries["strain"] / entries["stress"] ** N
    exact = (500.0 ** (1 - N) + (N - 1) * G * A * hours**p) ** (1 / (1 - N))
    creeping = CreepLaw(law.data.creep, law.parts())
    start = unstressed(3)
    start[1] = 500.0
    errors = []
    for n in (30, 60):
        state, clock = start, creeping.clock(0.0, COLD)
        for t in hours * (np.arange(1, n + 1) / n) ** (2 / p):
            after = creeping.clock(t, COLD, clock)
            state, _ = advance(law, state, np.zeros(3), clock, after)
            clock = after
        errors.append(abs(state[1] / exact - 1))
    assert errors[1] < 5e-4
    assert errors[0] / errors[1] == pytest.approx(4, abs=0.6)


def test_creep_of_a_bar_that_yields():
    """Tension at a constant rate from first yield on, with linear hardening: dσ (1/E + 1/H) = dε − dc."""
    k0, a = 2 / 3 * 300.0**2, 4 / 3 * 5000.0
    law = law_of(GAROFALO | {"activation_energy": 0.0}, {"k0_squared": k0, "a1": 1.0, "a2": a})
    E, k = law.E, law.data.creep
    end, hours = 2e-3, 30.0
    exact = solve_ivp(
        lambda t, s: (end / hours - k.strain * np.sinh(s / k.stress) ** k.exponent) / (1 / E + 1 / 5000.0),
        (0, hours),
        [300.0],
        "Radau",
        rtol=1e-10,
        atol=1e-9,
    ).y[0, -1]
    assert exact > 303.0
    creeping, errors = CreepLaw(law.data.creep, law.parts()), []
    for n in (10, 20):
        state, clock = unstressed(3), creeping.clock(0.0, COLD)
        state[0] = 300.0
        for t in np.linspace(0, hours, n + 1)[1:]:
            after = creeping.clock(t, COLD, clock)
            state, _ = advance(law, state, np.array([end / n, 0, 0]), clock, after)
            clock = after
        errors.append(state[0] / exact - 1)
    assert abs(errors[1]) < 1e-4


@pytest.mark.parametrize("components", [3, 6])
def test_no_time_is_the_return_mapping(components):
    """Without time the law is the parameter array; rows with creep's columns take the same way, and keep them."""
    law = library.load("ck15")
    creeping = Law(law.data.model_copy(update={"creep": law_of(CREEP).data.creep}))
    over_time = law_over_step(creeping, creeping.parameters(), None, components)
    clock = {"clock": np.array([3.0, COLD, 2.0])}
    p = over_time.over(clock, clock)
    assert p.address == with_loop(law.parameters(), components).address
    rng, state = np.random.default_rng(2), points.initial_state(law, 1, components)
    row = over_time.unstressed()[0]
    row[-1] = 1e-4
    for _ in range(10):
        de = 1e-3 * rng.normal(size=components)
        state, tangent, _ = points.update(law, state, de[None])
        (row,), (C,), _ = follow(p, row[None], de[None])
        assert row[:-2].tolist() == state[0].tolist()
        assert C.tolist() == tangent[0].tolist()
    assert row[-2:].tolist() == [COLD, 1e-4]


@pytest.mark.parametrize("components", [3, 6])
@pytest.mark.parametrize("entries", [CREEP, GAROFALO, CREEP | {"hardening": "time"}])
@pytest.mark.parametrize("yielding", [False, True])
def test_tangent(components, entries, yielding):
    """The Taylor remainder σ(ε + h v) − σ(ε) − h C v falls as h², with creep of any size, warmed on the way."""
    hard = {"k0_squared": 2 / 3 * 250.0**2, "a1": 1.0, "a2": 4000.0}
    kinematic = {"a5": 5.0, "a6": 0.3, "a7": 0.0}
    law = law_of(entries, hard, kinematic) if yielding else law_of(entries)
    rng, creeping = np.random.default_rng(8), CreepLaw(law.data.creep, law.parts())
    steps, flowed = 10.0 ** np.arange(-2, -4.01, -0.5), 0
    for hours in (1e-2, 1.0, 100.0, 1e4):
        before = creeping.clock(0.0, COLD)
        state, _ = advance(law, unstressed(components), 2e-3 * _unit(rng, components), before, before)
        middle = creeping.clock(0.1 * hours, COLD + 30, before)
        state, _ = advance(law, state, 1e-3 * _unit(rng, components), before, middle)
        after = creeping.clock(hours, COLD + 60, middle)
        de, v = (2e-3 * _unit(rng, components) for _ in range(2))
        new, C = advance(law, state, de, middle, after)
        rest = []
        for h in steps:
            moved, _ = advance(law, state, de + h * v, middle, after)
            rest.append(np.linalg.norm(moved[:components] - new[:components] - h * C @ v) / np.linalg.norm(h * C @ v))
        slope = np.polyfit(np.log(steps), np.log(rest), 1)[0]
        assert rest[-1] < 2e-3
        assert slope == pytest.approx(1, abs=0.15)
        flowed += new[2 * components] > state[2 * components]
    assert (flowed > 0) == yielding


@njit(**KERNEL)
def by_iteration(law, old, de, new, C, room):
    """One increment, never in closed form."""
    return increment.advance(law, old, de, new, C, room)


@pytest.mark.parametrize("entries", [CREEP, GAROFALO, CREEP | {"hardening": "time"}])
@pytest.mark.parametrize("yielding", [False, True])
def test_both_ways_through_a_rods_point(entries, yielding):
    """In closed form where nothing yields, and by the general iteration: the same stress, creep strain and tangent."""
    law = law_of(entries, {"k0_squared": 2 / 3 * 250.0**2, "a1": 1.0, "a2": 4000.0} if yielding else "none")
    rng, creeping, n = np.random.default_rng(4), CreepLaw(law.data.creep, law.parts()), 0
    for hours in (1e-6, 1e-2, 1.0, 1e3, 1e8):
        for size in (0.0, 1e-9, 1e-4, 3e-3):
            before = creeping.clock(0.5, COLD)
            start = unstressed(3)
            start[-1] = 10.0 ** rng.uniform(-9, -4) * rng.integers(2)
            state, _ = advance(law, start, size * _unit(rng, 3), before, creeping.clock(1.0, COLD + 20, before))
            middle = creeping.clock(1.0, COLD + 20, before)
            over = creeping.over(middle, creeping.clock(1.0 + hours, COLD + 60, middle))
            de, other, D = 0.3 * size * _unit(rng, 3), np.empty_like(state), np.empty((3, 3))
            (new,), (C,), _ = follow(over, state[None], de[None])
            assert by_iteration(over, state, de, other, D, np.empty(1, ROOM)) >= 0
            np.testing.assert_allclose(new[:3], other[:3], rtol=1e-8, atol=1e-7)
            np.testing.assert_allclose(new[3:], other[3:], rtol=1e-7, atol=1e-14)
            np.testing.assert_allclose(C, D, atol=1e-6 * law.E)
            n += without_yield(over, state, (de[0], de[1], de[2]), new, C) >= 0
    assert n == 20 if not yielding else 5 <= n < 20


def test_warm_hours():
    """Two hours at a constant temperature, by Arrhenius's factor; and on a ramp, by scipy."""
    law = law_of(CREEP)
    creeping, Q = CreepLaw(law.data.creep, law.parts()), CREEP["activation_energy"] / GAS_CONSTANT
    assert creeping.worth(2.0, CREEP["temperature"], CREEP["temperature"]) == pytest.approx(2.0, rel=1e-14)
    assert creeping.worth(2.0, 400.0, 400.0) == pytest.approx(2 * np.exp(Q * (1 / 323.15 - 1 / 400.0)), rel=1e-13)
    ramp = quad(lambda t: np.exp(Q * (1 / 323.15 - 1 / (300 + 50 * t))), 0, 3, epsabs=0, epsrel=1e-12)[0]
    assert creeping.worth(3.0, 300.0, 450.0) == pytest.approx(ramp, rel=1e-10)
