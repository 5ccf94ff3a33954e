"""Finite increments against scipy's polar decomposition and matrix logarithm, and Jaumann's rate in closed form."""

import numpy as np
from scipy.linalg import expm, logm, polar
from scipy.spatial.transform import Rotation
from solid_laws import Elastic

from coilset.model.core.material import library
from coilset.model.physics.solid.kinematics import push_forward, stretches
from coilset.model.physics.solid.points import MaterialPoints

DOUBLE = np.array([1.0, 1, 1, 2, 2, 2])


def tensor(t):
    return np.array([[t[0], t[3], t[4]], [t[3], t[1], t[5]], [t[4], t[5], t[2]]])


def components(T):
    return np.array([T[0, 0], T[1, 1], T[2, 2], T[0, 1], T[0, 2], T[1, 2]])


def increment(F, old, law, symmetric=False):
    """Strain, new state and moduli after the increments F, shape (n, 3, 3), from the states `old`."""
    n = len(F)
    strain, axes, R, ln = np.empty((n, 6)), np.empty((n, 3, 3)), np.empty((n, 3, 3)), np.empty((n, 3))
    assert stretches(np.eye(3) - np.linalg.inv(F), strain, axes, R, ln) == 0
    new, C, stress, moduli = np.empty_like(old), np.empty((n, 6, 6)), np.empty((n, 6)), np.empty((n, 6, 6))
    law.update(old, strain, new, C)
    push_forward(new, C, axes, R, ln, stress, moduli, symmetric)
    return strain, new, moduli


def large_increments(n):
    rng = np.random.default_rng(1)
    F = np.eye(3) + 0.25 * rng.normal(size=(n, 3, 3))
    F = F[np.linalg.det(F) > 0.2]
    old = np.zeros((len(F), 13))
    old[:, :12] = 1e4 * rng.normal(size=(len(F), 12))
    return F, old


def test_logarithm_rotation_and_turned_state():
    law = Elastic()
    F, old = large_increments(40)
    strain, new, _ = increment(F, old, law)
    for i in range(len(F)):
        R, U = polar(F[i])
        ln = logm(U).real
        assert np.allclose(tensor(strain[i] / DOUBLE), ln, atol=1e-12)
        turned = R @ tensor(old[i, :6] + law.C @ (DOUBLE * components(ln))) @ R.T
        assert np.allclose(tensor(new[i]), turned, rtol=1e-12, atol=1e-7)
        assert np.allclose(tensor(new[i, 6:12]), R @ tensor(old[i, 6:12]) @ R.T, atol=1e-9)


def test_moduli_are_the_derivative_of_the_virtual_work():
    # ∂/∂t of J σ : (δx-gradient) along F(t) = (1 + t l) F, central difference of error 1e-9 (step 1e-5 at unit rates)
    law = Elastic()
    F, old = large_increments(12)
    rng = np.random.default_rng(2)
    moduli, state = increment(F, old, law)[2], increment(F, old, law)[1]
    h = 1e-5
    for i in range(len(F)):
        l, g = rng.normal(size=(2, 3, 3))

        def work(G, i=i, g=g):
            σ = increment(G[None], old[i : i + 1], law)[1][0, :6]
            return np.linalg.det(G) * np.sum(tensor(σ) * (g @ F[i] @ np.linalg.inv(G)))

        difference = work((np.eye(3) + h * l) @ F[i]) - work((np.eye(3) - h * l) @ F[i])
        difference /= 2 * h * np.linalg.det(F[i])
        d, δd = (DOUBLE * components(0.5 * (a + a.T)) for a in (l, g))
        exact = δd @ moduli[i] @ d + np.sum(g * (l @ tensor(state[i])))
        scale = np.linalg.norm(moduli[i]) * np.linalg.norm(l) * np.linalg.norm(g)
        assert abs(difference - exact) < 1e-8 * scale


def test_symmetric_moduli_are_the_symmetric_part():
    F, old = large_increments(5)
    full, part = (increment(F, old, Elastic(), symmetric)[2] for symmetric in (False, True))
    assert np.allclose(part, 0.5 * (full + np.swapaxes(full, 1, 2)), rtol=1e-13)
    assert not np.allclose(part, full, rtol=1e-6)


def test_simple_shear_is_jaumanns():
    # σ̌ = 2G D in simple shear γ: σ12 = G sin γ, σ11 = −σ22 = G (1 − cos γ) (Dienes 1979). Reset every increment,
    # the error falls with the square of the increment.
    law, γ = Elastic(), 1.5
    exact = law.G * np.array([1 - np.cos(γ), np.cos(γ) - 1, 0.0, np.sin(γ), 0.0, 0.0])
    errors = []
    for n in (20, 40):
        state = np.zeros((1, 13))
        F = np.eye(3)[None].copy()
        F[0, 0, 1] = γ / n
        for _ in range(n):
            state = increment(F, state, law)[1]
        errors.append(np.abs(state[0, :6] - exact).max() / law.G)
    assert errors[1] < 1e-3
    assert 1.8 < np.log2(errors[0] / errors[1]) < 2.2


def test_superposed_rotation_only_turns_the_result():
    F, old = large_increments(10)
    Q = polar(np.random.default_rng(3).normal(size=(3, 3)))[0]
    Q *= np.sign(np.linalg.det(Q))
    plain, turned = increment(F, old, Elastic())[1], increment(Q @ F, old, Elastic())[1]
    for a, b in zip(plain, turned, strict=True):
        assert np.allclose(Q @ tensor(a[:6]) @ Q.T, tensor(b[:6]), rtol=1e-12, atol=1e-7)


def test_a_rotation_between_two_increments_only_turns_what_follows():
    """All of the state turns with the material, each of several back stresses among it, which recover on their own."""
    rng = np.random.default_rng(4)
    first, second = (expm(0.01 * (a + a.T)) for a in rng.normal(size=(2, 3, 3)))
    Q = Rotation.from_rotvec([0.4, 1.0, -0.3]).as_matrix()
    for name in ("chaboche", "ck15"):
        law = MaterialPoints(library.load(name))

        def along(path, law=law):
            state = law.initial_state(1)
            for F in path:
                state = increment(F[None], state, law)[1]
            return state[0]

        still, turned = along([first, second]), along([first, Q, Q @ second @ Q.T])
        expected = still.copy()  # σ, B, b* and the parts of B
        for begin in (0, 6, *range(13, len(still) - 5, 6)):
            expected[begin : begin + 6] = components(Q @ tensor(still[begin : begin + 6]) @ Q.T)
        assert np.allclose(turned, expected, rtol=1e-9, atol=1e-8), name


def test_a_point_turned_inside_out_is_reported():
    F = np.diag([1.0, 1.0, -0.5])[None]
    n = 1
    arrays = np.empty((n, 6)), np.empty((n, 3, 3)), np.empty((n, 3, 3)), np.empty((n, 3))
    assert stretches(np.eye(3) - np.linalg.inv(F), *arrays) == -1
