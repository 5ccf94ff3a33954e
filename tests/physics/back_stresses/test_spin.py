"""The rod's spin (5.2.33): closed elastic paths, its derivatives, and what it is beside the rates."""

import numpy as np
import pytest

from coilset.model.core.material import library
from coilset.model.core.material.point import points
from coilset.model.physics.back_stresses.spin import WHOLE, Crossing, spun

STATE, BACK = np.array([300.0, 150.0, -80.0]), np.array([20.0, -30.0, 10.0])
INCREMENT, NONE = np.array([1.1e-3, 2.3e-3, -0.7e-3]), (0.0, 0.0, 0.0)


def after(law, increment, stress=STATE, back=BACK, crossing=WHOLE):
    """Stress and back stress after an increment without plastic flow."""
    end = spun(tuple(stress), tuple(back), law.E, law.G, *increment, crossing)
    return np.array(end.stress) + np.array([law.E, law.G, law.G]) * increment, np.array(end.back)


@pytest.fixture(scope="module")
def law():
    return library.load("ck15", spin=True)


@pytest.mark.parametrize("spin", [False, True])
def test_closed_elastic_paths_close(spin):
    """Random closed paths of eight pieces inside the yield surface of states with back stress: found 2e-10 MPa."""
    law, rng = library.load("ck15", spin=spin), np.random.default_rng(0)
    D = rng.normal(size=(200, 3)) * (1.0, 1.7, 1.7) * 3e-3
    start = points.initial_state(law, 200)
    for _ in range(3):
        start = points.update(law, start, D)[0]
    start = points.update(law, start, -2e-3 * D / np.linalg.norm(D, axis=1)[:, None])[0]
    pieces = rng.normal(size=(7, 200, 3)) * 2e-4
    state = start
    for piece in [*pieces, -pieces.sum(axis=0)]:
        for _ in range(5):
            state = points.update(law, state, piece / 5)[0]
    elastic = state[:, 6] == start[:, 6]
    assert elastic.sum() > 100
    assert np.abs(state - start)[elastic].max() < 1e-8
    if spin:  # and the path is long enough for (5.2.33) to matter
        half = [points.update(library.load("ck15", spin=on), start, pieces[0])[0] for on in (False, True)]
        assert np.abs(half[0] - half[1])[elastic].max() > 0.01


def test_in_one_piece_or_in_many(law):
    """The end does not depend on the steps, nor on the way."""
    whole = after(law, INCREMENT)
    stress, back = STATE, BACK
    for piece in (INCREMENT * (1, 0, 0), INCREMENT * (0, 0, 1), INCREMENT * (0, 1, 0)):
        for _ in range(4):
            stress, back = after(law, piece / 4, stress, back)
    np.testing.assert_allclose(stress, whole[0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(back, whole[1], rtol=0, atol=1e-9)


def test_tension_then_torsion_is_the_closed_form(law):
    """σ + 2G = (2G + Eε) cos θ, τ = (G + ½Eε) sin θ √2, θ = γ/√2: the integral of (5.2.33); tension is Hooke's."""
    stress, _ = after(law, (0.01, 0.0, 0.0), np.zeros(3), np.zeros(3))
    np.testing.assert_allclose(stress, [law.E * 0.01, 0.0, 0.0], rtol=1e-12)
    stress, _ = after(law, (0.0, 0.0, 0.3), stress, np.zeros(3))
    θ, a = 0.3 / np.sqrt(2.0), 2.0 * law.G + law.E * 0.01
    expected = [a * np.cos(θ) - 2.0 * law.G, 0.0, a / np.sqrt(2.0) * np.sin(θ)]
    np.testing.assert_allclose(stress, expected, rtol=1e-12)


def test_back_stress_turns_without_growing(law):
    """¾ B11² + B12² + B13², the work against the back stress, is kept; to first order it changes by (5.2.33)."""
    _, back = after(law, INCREMENT)
    size = np.array([0.75, 1.0, 1.0])
    assert size @ back**2 == pytest.approx(size @ BACK**2, rel=1e-13)
    h, (_, g2, g3) = 1e-7, INCREMENT / np.abs(INCREMENT).max()
    rate = (after(law, (0.0, h * g2, h * g3))[1] - BACK) / h
    # half of the elastic γ, 1e-3, turns it about, too
    expected = np.array([-g2 * BACK[1] - g3 * BACK[2], 0.75 * g2 * BACK[0], 0.75 * g3 * BACK[0]])
    np.testing.assert_allclose(rate, expected, rtol=0, atol=3e-3 * np.abs(BACK).max())


@pytest.mark.parametrize("increment", [INCREMENT, 60.0 * INCREMENT])
@pytest.mark.parametrize("beta", [1.0, 0.3, 0.0])
def test_derivatives(law, increment, beta):
    """Central differences; with small angles, of which the series are summed, and great ones, and a β that changes."""
    slope, h = np.array([2.0, -3.0, 1.5]) if beta == 0.3 else np.zeros(3), 1e-6
    end = spun(tuple(STATE), tuple(BACK), law.E, law.G, *increment, Crossing(beta, tuple(slope)))
    for k, modulus in enumerate((law.E, law.G, law.G)):
        up, down = (
            after(law, increment + sign * h * np.eye(3)[k], crossing=Crossing(beta + sign * h * slope[k], NONE))
            for sign in (1, -1)
        )
        stress = (up[0] - down[0]) / (2 * h) - modulus * np.eye(3)[k]
        np.testing.assert_allclose(end.d_stress[k], stress, rtol=0, atol=1e-3)
        np.testing.assert_allclose(end.d_back[k], (up[1] - down[1]) / (2 * h), rtol=0, atol=1e-6)
