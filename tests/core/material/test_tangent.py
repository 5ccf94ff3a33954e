"""The return mapping's tangent: the Taylor remainder σ(ε + h v) − σ(ε) − h C v shrinks as h²."""

import numpy as np
import pytest

from coilset.model.core.material import library
from coilset.model.core.material.law.functions import HELD
from coilset.model.core.material.point import points
from coilset.model.core.material.point.loops import follow

STEPS = 10.0 ** np.arange(-2.5, -4.01, -0.5)


def remainders(law, state, D, v):
    """Taylor remainders of stress relative to the first-order change, for `STEPS` times |D|."""
    n = D.size
    new, C, _ = points.update(law, state[None], D[None])
    v = v / np.linalg.norm(v) * np.linalg.norm(D)
    moved, _, _ = points.update(law, np.repeat(state[None], STEPS.size, 0), D + STEPS[:, None] * v)
    rest = moved[:, :n] - new[0, :n] - STEPS[:, None] * (C[0] @ v)
    return np.linalg.norm(rest, axis=1) / np.linalg.norm(moved[:, :n] - new[0, :n], axis=1)


def assert_second_order(relative):
    """Relative remainders fall as h, whole ones as h², until rounding (1e-9) takes over."""
    assert relative[-1] < 2e-3
    clear = relative > 1e-8
    if clear.sum() >= 3:
        slope = np.polyfit(np.log(STEPS[clear]), np.log(relative[clear]), 1)[0]
        assert slope + 1 == pytest.approx(2, abs=0.1)


def random_states(law, components, seed, spread=-1.5):
    """States after a few random increments, some of them reversals of the one before."""
    rng = np.random.default_rng(seed)
    states = points.initial_state(law, 40, components)
    D = rng.normal(size=(40, components)) * 1e-3
    for _ in range(4):
        fresh = rng.normal(size=D.shape) * 10 ** rng.uniform(-4, spread, size=(40, 1))
        D = np.where(rng.uniform(size=(40, 1)) < 0.3, -0.5 * D, fresh)
        states = points.update(law, states, D)[0]
    return states, D, rng


@pytest.mark.parametrize("name", ["ck15", "mixed", "voce"])
@pytest.mark.parametrize(("components", "spin"), [(3, False), (3, True), (6, False)])
def test_random_states(name, components, spin):
    """Forty random states: going on, in a new direction, and reversed through the elastic range to the other side."""
    law = library.load(name, spin=spin)
    states, last, rng = random_states(law, components, 21)
    yielding = 0
    for state, old in zip(states, last, strict=True):
        fresh = rng.normal(size=components) * 10 ** rng.uniform(-3.5, -1.5)
        for D in (old + 1e-4 * rng.normal(size=components), fresh, -0.02 * old / np.linalg.norm(old)):
            _, _, count = points.update(law, state[None], D[None])
            if count[0] == 0:
                continue
            relative = remainders(law, state, D, rng.normal(size=components))
            if near_a_kink(law, state, D):
                continue
            assert_second_order(relative)
            yielding += 1
    assert yielding > 70


def near_a_kink(law, state, D):
    """Whether some point of the stencil is elastic, or enters the yield surface elsewhere: the map has a kink there."""
    directions = np.random.default_rng(0).normal(size=(20, D.size))
    directions *= 0.02 * np.linalg.norm(D) / np.linalg.norm(directions, axis=1, keepdims=True)
    _, _, count = points.update(law, np.repeat(state[None], 20, 0), D + directions)
    return bool((count == 0).any())


@pytest.mark.parametrize("components", [3, 6])
def test_elastic_plastic_transition(components):
    """From zero state, and from a released state with high κ, increments that leave the yield surface half way."""
    law = library.load("ck15")
    rng = np.random.default_rng(5)
    unit = np.eye(components)[0]
    loaded = points.update(law, points.initial_state(law, 1, components), 0.12 * unit[None])[0]
    released = points.update(law, loaded, -0.5e-3 * unit[None])[0]
    for state in (points.initial_state(law, 1, components)[0], released[0]):
        for _ in range(10):
            direction = rng.normal(size=components)
            D = 6e-3 * direction / np.linalg.norm(direction)
            _, _, count = points.update(law, np.array([state, state]), np.array([D, 1e-2 * D]))
            assert count[0] > 0
            assert count[1] == 0
            assert_second_order(remainders(law, state, D, rng.normal(size=components)))


def test_neutral_loading_of_the_rod():
    """In the middle of the cone of neutral loading (see `local`), from the yield surface."""
    law = library.load("ck15", spin=False)
    state = points.initial_state(law, 1)
    for _ in range(20):
        state = points.update(law, state, np.array([[0.003, 0.006, 0.0]]))[0]
    s = state[0]
    n1, n2 = s[0] / 1.5 - s[3], s[1] - s[4]
    _, _, zeta, _, kappa, _ = law.functions(s[6])
    ratio = (1 + kappa * (zeta + 2 * law.G)) / (1 + kappa * (zeta + law.E / 1.5))
    D = np.array([-1 / (n1 * law.E), np.sqrt(ratio) / (2 * n2 * law.G), 0.0])
    D *= 1e-5 / np.abs(D).max()
    assert points.update(law, state, D[None])[2][0] > 0
    relative = remainders(law, s, D, np.array([1.0, 1.3, 0.4]))
    assert_second_order(relative)


def test_held_tangents_are_positive_where_kappa_sets_in():
    """Nearly along the yield surface, within its cone of neutral loading and entering it: the same stresses.

    The derivatives have negative eigenvalues there, of several moduli. Tangents that hold the place of the onset and
    the smaller κ have none, and elsewhere they are the same.
    """
    law = library.load("ck15", spin=False)
    state = points.initial_state(law, 1)
    for _ in range(20):
        state = points.update(law, state, np.array([[0.003, 0.006, 0.0]]))[0]
    n = np.array([state[0, 0] / 1.5 - state[0, 3], *(state[0, 1:3] - state[0, 4:6])])
    outward = np.array([1.5 * n[0] * law.E / 1.5, 2.0 * n[1] * law.G, 0.0])  # n:e of unit strains
    along = np.array([-outward[1], outward[0], 0.0]) / np.linalg.norm(outward)
    inside = state.copy()
    inside[0, :3] -= 1e-6 * np.array([1.5, 1.0, 1.0]) * n
    parameters = law.parameters()
    parameters[HELD] = 1.0
    negative = []
    for start, strain in ((state, along), (inside, along), (state, outward / np.linalg.norm(outward))):
        exact, held = (follow(one, start, 1e-4 * strain[None]) for one in (law.parameters(), parameters))
        np.testing.assert_allclose(held[0], exact[0], rtol=1e-14)
        assert held[2][0] > 0
        least = [np.linalg.eigvalsh(C[0] + C[0].T)[0] / 2 for C in (exact[1], held[1])]
        assert least[1] > 0.0
        negative.append(least[0] < -law.G)
    assert negative == [True, True, False]


def test_elastic_tangent():
    """Hooke's law, with the rod's spin: σ11 loses γ12 τ12, τ12 gains ½ γ12 σ11 (5.2.33) and E/2G ε11 τ12."""
    state = np.array([[50.0, 20.0, -10.0, 0, 0, 0, 0]])
    law = library.load("ck15")
    _, C, _ = points.update(law, state, np.array([[1e-5, 2e-5, 0]]))
    np.testing.assert_allclose(C[0], np.diag([law.E, law.G, law.G]), rtol=1e-12)
    _, C, _ = points.update(library.load("ck15", spin=True), state, np.zeros((1, 3)))
    grows = 1 + law.nu
    turn = np.array([[0, -20.0, 10.0], [20.0 * grows, 25.0, 0], [-10.0 * grows, 0, 25.0]])
    # what is left is of the order θ², 1e-8 of the moduli, and σ/2G, 3e-4 of the new term
    np.testing.assert_allclose(C[0] - np.diag([law.E, law.G, law.G]), turn, rtol=1e-3, atol=5e-3)
    _, C, _ = points.update(law, points.initial_state(law, 1, 6), np.full((1, 6), 1e-6))
    bulk = law.E / (3 * (1 - 2 * law.nu))
    expected = np.zeros((6, 6))
    expected[:3, :3] = bulk - 2 * law.G / 3
    expected += np.diag([2 * law.G] * 3 + [law.G] * 3)
    np.testing.assert_allclose(C[0], expected, rtol=1e-12)
