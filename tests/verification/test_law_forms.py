"""The rod's form, the full form and closed solutions against each other."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coilset.model.core.material import library
from coilset.model.core.material.point import points
from coilset.verification.references import heun

FREE = [1, 2, 5]  # σ22, σ33, τ23 of the rod vanish
HELD = [0, 3, 4]


def as_matrix(v, shear=1.0):
    """Symmetric matrix of six components; `shear` is ½ for engineering strains."""
    a, b, c, d, e, f = v
    return np.array([[a, shear * d, shear * e], [shear * d, b, shear * f], [shear * e, shear * f, c]])


def as_vector(m, shear=1.0):
    return np.array([m[0, 0], m[1, 1], m[2, 2], m[0, 1] / shear, m[0, 2] / shear, m[1, 2] / shear])


def turned(v, R, shear=1.0):
    return as_vector(R @ as_matrix(v, shear) @ R.T, shear)


def random_strains(seed, steps, components, largest):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(steps, components)) * 10 ** rng.uniform(-4, math.log10(largest), size=(steps, 1))


def with_free_sides(law, state, strain):
    """Full-form step with the rod's strain, lateral strains found by Newton so that FREE stresses vanish."""
    D = np.array([strain[0], -law.nu * strain[0], -law.nu * strain[0], strain[1], strain[2], 0.0])
    for _ in range(40):
        new, C, _ = points.update(law, state[None], D[None])
        residual = new[0, FREE]
        if np.abs(residual).max() < 1e-9:
            condensed = C[0][np.ix_(HELD, HELD)] - C[0][np.ix_(HELD, FREE)] @ np.linalg.solve(
                C[0][np.ix_(FREE, FREE)], C[0][np.ix_(FREE, HELD)]
            )
            return new[0], condensed
        D[FREE] -= np.linalg.solve(C[0][np.ix_(FREE, FREE)], residual)
    raise AssertionError("no lateral strain found")


def parts_at_yield(law, row, strain):
    """The increment cut where it leaves the yield surface: beyond it the lateral strain of the rod turns off."""
    n = np.array([row[0] / 1.5 - row[3], row[1] - row[4], row[2] - row[5]])
    e = np.array([law.E * strain[0] / 1.5, law.G * strain[1], law.G * strain[2]])
    weight = np.array([1.5, 2, 2])
    k2 = law.functions(row[6])[0]
    a, b, c = np.dot(weight * e, e), np.dot(weight * n, e), np.dot(weight * n, n) - k2
    if a + 2 * b + c <= 0:
        return [strain]
    beta = (-b + math.sqrt(max(b * b - a * c, 0.0))) / a
    return [strain] if beta < 1e-9 else [beta * (1 - 1e-14) * strain, (1 - beta) * strain]


def differences(law, parts):
    """Rod against the full form with free sides, each increment in so many parts: stress and b* at the paths' ends."""
    found = []
    for seed in range(6):
        rod, full = points.initial_state(law, 1)[0], points.initial_state(law, 1, 6)[0]
        rng = np.random.default_rng(seed)
        start = rng.normal(size=3) * (1, 1.5, 1.5)
        for size in rng.uniform(1e-4, 2e-3, size=6):
            start += 0.3 * rng.normal(size=3)
            whole = size * start / np.linalg.norm(start)
            for strain in parts_at_yield(law, rod, whole):
                for _ in range(parts):
                    rod = points.update(law, rod[None], strain[None] / parts)[0][0]
                    full, _condensed = with_free_sides(law, full, strain / parts)
        scale = np.sqrt(1.5 * law.functions(rod[6])[0])
        found.append([np.abs(full[HELD] - rod[:3]).max() / scale, abs(full[12] / rod[6] - 1)])
        C = points.update(law, rod[None], strain[None] / parts)[1][0]
        np.testing.assert_allclose(with_free_sides(law, full, strain / parts)[1], C, atol=0.02 * law.E)
    return np.array(found).T


@pytest.mark.parametrize("name", ["ck15", "mixed", "voce"])
def test_rod_and_full_form_agree(name):
    """In the rod no stress stands across it at any time, in the full form with free sides at the increments' ends.

    So they differ by an error of second order: a quarter with half of the increments.
    """
    law = library.load(name, spin=False)
    coarse, fine = differences(law, 2), differences(law, 4)
    assert coarse[0].max() < 2e-3
    assert fine.max() < 1e-3
    assert np.median(fine / coarse) == pytest.approx(0.25, abs=0.05)


@pytest.mark.parametrize("integrator", heun.UPDATES)
def test_objective_under_a_fixed_turn(integrator):
    """The same path in a turned frame gives the turned stress and back stress, and the same b*."""
    law = library.load("ck15")
    R = Rotation.from_rotvec([0.7, -1.1, 2.3]).as_matrix()
    a = b = points.initial_state(law, 1, 6)
    for D in random_strains(5, 12, 6, 1e-2):
        a = heun.UPDATES[integrator](law, a, D[None])[0]
        b = heun.UPDATES[integrator](law, b, turned(D, R, 0.5)[None])[0]
        scale = np.abs(a[0, :6]).max()
        np.testing.assert_allclose(b[0, :6], turned(a[0, :6], R), atol=1e-10 * scale)
        np.testing.assert_allclose(b[0, 6:12], turned(a[0, 6:12], R), atol=1e-10 * scale)
        assert b[0, 12] == pytest.approx(a[0, 12], rel=1e-10)


def test_objective_under_a_growing_turn():
    """A body that turns while it strains: its state is turned before every update, the increments' frame with it."""
    law = library.load("ck15")
    step = Rotation.from_rotvec([0.05, -0.02, 0.08]).as_matrix()
    still = moving = points.initial_state(law, 1, 6)
    R = np.eye(3)
    for D in random_strains(6, 30, 6, 3e-3):
        R = step @ R
        stress, back, work = moving[0, :6], moving[0, 6:12], moving[0, 12:]
        row = np.concatenate([turned(stress, step), turned(back, step), work])
        moving = points.update(law, row[None], turned(D, R, 0.5)[None])[0]
        still = points.update(law, still, D[None])[0]
    np.testing.assert_allclose(moving[0, :6], turned(still[0, :6], R), atol=1e-10 * np.abs(still[0, :6]).max())


@pytest.mark.parametrize("integrator", heun.UPDATES)
@pytest.mark.parametrize("components", [3, 6])
def test_plastic_work_never_falls(integrator, components):
    """600 random increments, reversals and turns among them; the end of each plastic one lies on the yield surface."""
    law = library.load("ck15")
    state = points.initial_state(law, 20, components)
    rng = np.random.default_rng(8)
    for _ in range(30):
        D = rng.normal(size=(20, components)) * 10 ** rng.uniform(-5, -2.3, size=(20, 1))
        new, _, count = heun.UPDATES[integrator](law, state, D)
        assert (new[:, 2 * components] >= state[:, 2 * components]).all()
        stress, back = new[:, :components], new[:, components : 2 * components]
        weight = np.array([1.5, 2, 2]) if components == 3 else np.array([1, 1, 1, 2, 2, 2])
        mean = np.outer(stress[:, :3].mean(axis=1), [1] * 3 + [0] * 3)
        deviator = stress / (1.5, 1, 1) if components == 3 else stress - mean
        excess = (weight * (deviator - back) ** 2).sum(axis=1) / law.functions(new[:, 2 * components])[0] - 1
        assert np.abs(excess[count > 0]).max(initial=0.0) < 1e-10
        assert excess.max() < 1e-10
        state = new


def test_radial_return_of_linear_hardening():
    """κ = ζ = 0: σeq = σtrial − 3G Δεp, Δεp = (σtrial − σ0)/(3G + H), along the trial deviator; 200 random directions.

    On the straight path of each direction the law has this closed solution, with increments of any size.
    """
    law = library.load("linear_isotropic")
    G, yield_stress, plastic = law.G, law.yield_stress, np.zeros(200)
    H = 0.75 * 2666.6667  # a1 a2 = 4/3 H in the material file
    state = points.initial_state(law, 200, 6)
    rng = np.random.default_rng(9)
    direction = rng.normal(size=(200, 6))
    for _ in range(5):
        D = direction * 10 ** rng.uniform(-4, -1, size=(200, 1))
        new, _, count = points.update(law, state, D)
        volume = D[:, :3].sum(axis=1)
        e = D * ([1] * 3 + [0.5] * 3) - np.outer(volume / 3, [1] * 3 + [0] * 3)
        mean = state[:, :3].mean(axis=1)
        T = state[:, :6] - np.outer(mean, [1] * 3 + [0] * 3) + 2 * G * e
        trial = np.sqrt(1.5 * (T**2 * ([1] * 3 + [2] * 3)).sum(axis=1))
        growth = np.maximum(trial - yield_stress - H * plastic, 0) / (3 * G + H)
        plastic += growth
        bulk = law.E / (3 * (1 - 2 * law.nu))
        expected = T * (1 - 3 * G * growth / trial)[:, None] + np.outer(mean + bulk * volume, [1] * 3 + [0] * 3)
        assert (count > 0).sum() > 100
        np.testing.assert_allclose(new[:, :6], expected, atol=1e-10 * trial.max())
        state = new
    # b* is the uniaxial work ∫σ dεp.
    np.testing.assert_allclose(state[:, 12], yield_stress * plastic + H * plastic**2 / 2, rtol=1e-10)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("elastic", lambda law, e: law.E * e),
        ("ideal_plastic", lambda law, e: 400.0),
        ("linear_isotropic", lambda law, e: 400 + 2000 * (law.E * e - 400) / (law.E + 2000)),
        ("linear_kinematic", lambda law, e: 400 + 2000 * (law.E * e - 400) / (law.E + 2000)),
    ],
)
def test_generic_laws_in_tension(name, expected):
    """Closed solutions of uniaxial tension to 5 % in one increment."""
    law = library.load(name)
    new, _, _ = points.update(law, points.initial_state(law, 1), np.array([[0.05, 0, 0]]))
    assert new[0, 0] == pytest.approx(expected(law, 0.05), rel=1e-7)  # the constants are typed with 7 digits and more


def test_kinematic_hardening_yields_early_on_reversal():
    """Prager: the elastic range stays 2σ0; compression from 4 % strain yields at σ − 2σ0."""
    law = library.load("linear_kinematic")
    state = points.update(law, points.initial_state(law, 1), np.array([[0.04, 0, 0]]))[0]
    top = state[0, 0]
    back = np.array([[-2 * 400 / law.E, 0, 0]])
    almost, _, count = points.update(law, state, 0.9999 * back)
    assert count[0] == 0
    beyond, _, count = points.update(law, state, 1.001 * back)
    assert count[0] > 0
    assert almost[0, 0] == pytest.approx(top - 2 * 400 * 0.9999, rel=1e-9)
    assert beyond[0, 0] == pytest.approx(top - 2 * 400 - 2000 / (law.E + 2000) * 0.001 * 800, rel=1e-3)
