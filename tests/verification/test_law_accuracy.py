"""Both integrators against the high-order integration of the rate equations in conftest.py."""

import math

import numpy as np
import pytest

from coilset.model.core.material import library
from coilset.model.core.material.point import points
from coilset.verification.references import heun

INCREMENT = 1e-4
STRAIGHT = {
    "tension": [(0.15, 0, 0)],
    "torsion": [(0, 0.15 * math.sqrt(3), 0)],
    "reversed torsion": [(0, 0.10, 0), (0, -0.16, 0)],
}
ABRUPT = {"tension, torsion": [(0.05, 0, 0), (0, 0.10, 0)], "torsion, tension": [(0, 0.10, 0), (0.05, 0, 0)]}


def size(segment):
    """Equivalent strain sqrt(ε² + γ²/3) of a rod's strain increment."""
    return math.sqrt(segment[0] ** 2 + (segment[1] ** 2 + segment[2] ** 2) / 3)


def random_path(seed):
    """Four straight pieces in random directions, 15 % equivalent strain together."""
    pieces = np.random.default_rng(seed).normal(size=(4, 3)) * (1, math.sqrt(3), math.sqrt(3))
    return pieces * 0.15 / sum(size(piece) for piece in pieces)


PATHS = STRAIGHT | ABRUPT | {f"random {seed}": random_path(seed) for seed in range(10)}
CHECKPOINTS = 6  # in each piece


def follow(law, path, integrator, increment=INCREMENT, **tolerance):
    """States at the checkpoints, with increments of at most `increment`."""
    state, states = points.initial_state(law, 1), []
    for segment in np.array(path, float):
        n = math.ceil(size(segment) / CHECKPOINTS / increment - 1e-9)
        for _ in range(CHECKPOINTS):
            for _ in range(n):
                part = segment[None] / (n * CHECKPOINTS)
                state, _, _ = heun.UPDATES[integrator](law, state, part, **tolerance)
            states.append(state[0])
    return np.array(states)


def error(states, exact, k_squared):
    """Maximum difference of stress, as equivalent stress, over the flow stress sqrt(1.5 k²)."""
    difference = states[:, :3] - exact[:, [0, 3, 4]]
    flow = np.sqrt([1.5 * k_squared(b) for b in exact[:, 12]])
    return float((np.sqrt(difference[:, 0] ** 2 + 3 * (difference[:, 1:] ** 2).sum(axis=1)) / flow).max())


@pytest.fixture(scope="module")
def exact(reference):
    """Reference states and material, by path and spin."""
    material, cache = reference.ck15(), {}

    def states(name, spin):
        if (name, spin) not in cache:
            cache[name, spin] = reference.Reference(material, spin=spin).path(PATHS[name], CHECKPOINTS)
        return cache[name, spin], material.k2

    return states


@pytest.mark.parametrize("spin", [False, True])
@pytest.mark.parametrize("name", PATHS)
def test_heun_is_within_a_thousandth(name, spin, exact):
    """Stated: 0.1 % for increments of 1e-4; measured 1e-5 at most."""
    states = follow(library.load("ck15", spin=spin), PATHS[name], "heun")
    assert error(states, *exact(name, spin)) < 5e-5


@pytest.mark.parametrize("name", PATHS)
def test_return_mapping_is_within_a_thousandth(name, exact):
    """Stated: 0.1 % for increments of 1e-4; measured 2.2e-5 at most, 3.3e-3 for increments of 1e-3.

    But 1.8e-4 on a path through the cone of neutral loading, where the κ of `local` is of first order.
    """
    law = library.load("ck15", spin=False)
    assert error(follow(law, PATHS[name], "return_mapping", 1e-3), *exact(name, False)) < 5e-3
    assert error(follow(law, PATHS[name], "return_mapping"), *exact(name, False)) < (
        3e-4 if name == "random 3" else 3e-5
    )


@pytest.mark.parametrize("name", ["tension", "reversed torsion", "tension, torsion", "random 0"])
@pytest.mark.parametrize("integrator", heun.UPDATES)
def test_order_of_convergence(name, integrator, exact):
    """One step an increment; halving it divides the error by 4."""
    law, tolerance = library.load("ck15"), {"tolerance": math.inf} if integrator == "heun" else {}
    states = [follow(law, PATHS[name], integrator, h, **tolerance) for h in (4e-4, 2e-4, 1e-4)]
    errors = [error(one, *exact(name, False)) for one in states]
    slopes = np.log2(errors[:-1]) - np.log2(errors[1:])
    # The yield point falls anywhere within an increment, which disturbs single slopes.
    assert np.mean(slopes) == pytest.approx(2, abs=0.15)
    assert errors[-1] < 5e-4


def test_spin_gives_the_axial_stress_of_large_torsion(exact):
    """With the spin terms torsion at fixed length stretches: σ11 as in the reference, and none without them."""
    path = STRAIGHT["torsion"]
    with_spin = follow(library.load("ck15", spin=True), path, "return_mapping")[-1]
    without = follow(library.load("ck15", spin=False), path, "return_mapping")[-1]
    states, _ = exact("torsion", True)
    assert without[0] == 0.0
    assert abs(states[-1, 0]) > 0.1
    assert with_spin[0] == pytest.approx(states[-1, 0], rel=3e-3)


@pytest.mark.parametrize("integrator", heun.UPDATES)
def test_full_stress_state(integrator, reference):
    """Three pieces of random strain in all six components; the reference has free choice of components, too."""
    path = np.random.default_rng(11).normal(size=(3, 6)) * 0.01
    material = reference.ck15()
    exact = reference.Reference(material, rod=False).path(path)
    law, n, tolerance = library.load("ck15"), 400, {"tolerance": 2e-6} if integrator == "heun" else {}
    state, states = points.initial_state(law, 1, 6), []
    for segment in path:
        for _ in range(n):
            state, _, _ = heun.UPDATES[integrator](law, state, segment[None] / n, **tolerance)
        states.append(state[0])
    difference = np.array(states)[:, :6] - exact[:, :6]
    flow = np.sqrt([1.5 * material.k2(b) for b in exact[:, 12]])
    assert (np.abs(difference).max(axis=1) / flow).max() < (1e-3 if integrator == "return_mapping" else 2e-5)


def test_neutral_loading(reference):
    """In the cone where the rod's law has no answer with λ ≥ 0, the stress slides along the surface with a smaller κ.

    The reference finds that κ by bisection of the multiplier; the direction is in the middle of the cone: n:T° is
    positive with the elastic answer, negative with the plastic one.
    """
    material = reference.ck15()
    ref, law = reference.Reference(material), library.load("ck15", spin=False)
    row = follow(law, [(0.06, 0.12, 0)], "heun", 1e-3)[-1]
    y = np.zeros(14)
    y[[0, 3, 4, 6, 9, 10, 12]], y[[7, 8]] = row, -row[3] / 2
    n1, n2 = row[0] / 1.5 - row[3], row[1] - row[4]
    # n:T° = n11 E ε11 x_a + 2 n12 G γ12 x_c, with x = 1 in the elastic case; x_a/x_c is `ratio`.
    kappa, zeta = material.kappa(y[12]), material.zeta(y[12])
    E, G = 2 * material.G * (1 + material.nu), material.G
    ratio = (1 + kappa * (zeta + 2 * G)) / (1 + kappa * (zeta + E / 1.5))
    assert ratio > 1.1
    de11 = -1.0 / (n1 * E)
    dg12 = math.sqrt(ratio) / (2 * n2 * G)
    de11, dg12 = np.array([de11, dg12]) * 1e-4 / max(abs(de11), abs(dg12))
    D = np.array([de11, 0, 0, dg12 / 2, 0, 0])
    rate, stays = ref._solve(y, D, None)
    assert stays > 0  # elastic: leaves the surface
    assert ref._solve(y, D, kappa)[1] < 0  # plastic: moves inside
    sliding = ref.rates(y, D, None)[[0, 3]]
    assert not np.allclose(sliding, rate[[0, 3]], rtol=1e-2)
    for integrator in heun.UPDATES:
        new, _, count = heun.UPDATES[integrator](law, row[None], 1e-3 * np.array([[de11, dg12, 0]]))
        assert count[0] > 0
        np.testing.assert_allclose((new[0, :2] - row[:2]) / 1e-3, sliding, rtol=1e-3)
