"""Criteria of fatigue against closed forms, a search over all planes and moments, and rotations of the frame."""

import math

import numpy as np
import pytest

from coilset.model.physics.fatigue import criteria
from coilset.model.physics.fatigue.cycle import Cycle, tensors
from coilset.model.physics.fatigue.strength import Strength, dang_van_a, findley_k
from coilset.verification.references import fatigue_planes as brute

NU, K, A, YIELD = 0.3, 0.25, 0.4, 1500.0
CRITERIA = {
    "haigh": lambda cycle: criteria.haigh(cycle, 0.3),
    "smith_watson_topper": lambda cycle: criteria.smith_watson_topper(cycle, NU),
    "findley": lambda cycle: criteria.findley(cycle, K),
    "dang_van": lambda cycle: criteria.dang_van(cycle, A),
    "fatemi_socie": lambda cycle: criteria.fatemi_socie(cycle, K, YIELD),
}


def torsion(shear, tension=0.0):
    return tensors(np.array([tension, 0.0, shear]), ("s11", "t12", "t13"))


@pytest.fixture(scope="module")
def random():
    generator = np.random.default_rng(5)
    mean, amplitude = (generator.normal(0.0, 300.0, (6, 3, 3)) for _ in range(2))
    return Cycle(*(0.5 * (part + part.swapaxes(1, 2)) for part in (mean, amplitude)))


MEAN, SWING = 450.0, 200.0
CLOSED_TORSION = {
    "haigh": 1.3 / 1.1 * (SWING + 0.1 * MEAN),
    "smith_watson_topper": math.sqrt((1.0 + NU) * SWING * (MEAN + SWING)),
    # σ_n = (m + a) sin 2φ, τ = a cos 2φ: the greatest of a cos + k (m + a) sin
    "findley": math.hypot(SWING, K * (MEAN + SWING)) / math.hypot(1.0, K),
    "dang_van": SWING,
    # the planes of greatest shear are those across and along the wire, which carry no normal stress
    "fatemi_socie": SWING,
}


@pytest.mark.parametrize("name", CRITERIA)
def test_torsion_with_static_torsion(name):
    cycle = Cycle(torsion(MEAN), torsion(SWING))
    assert CRITERIA[name](cycle) == pytest.approx(CLOSED_TORSION[name], rel=1e-6)


@pytest.mark.parametrize("bending", [-2.0, 2.0])
def test_a_little_bending_hides_no_tension(bending):
    """It makes the amplitude of one of the planes at ±45° the greater one, perhaps of that in compression."""
    cycle = Cycle(torsion(MEAN), torsion(SWING, bending))
    found = CRITERIA["smith_watson_topper"](cycle)
    assert found == pytest.approx(CLOSED_TORSION["smith_watson_topper"], rel=0.01)


TENSION = 300.0
CLOSED_BENDING = {
    "haigh": SWING + 0.3 * TENSION / math.sqrt(3.0),
    "dang_van": SWING + A * TENSION / 3.0,
    # across the wire it is all there
    "fatemi_socie": SWING * (1.0 + K * TENSION / YIELD),
}


@pytest.mark.parametrize("name", CLOSED_BENDING)
def test_torsion_with_static_bending(name):
    cycle = Cycle(torsion(0.0, TENSION), torsion(SWING))
    assert CRITERIA[name](cycle) == pytest.approx(CLOSED_BENDING[name], rel=1e-6)


def test_planes_under_torsion_with_static_bending():
    """Those that contain the radial direction: σ = T cos²φ + |a sin 2φ|, τ̂ = |a cos 2φ|, on a fine grid."""
    cycle, angle = Cycle(torsion(0.0, TENSION), torsion(SWING)), np.linspace(0.0, math.pi, 200_001)
    swing = abs(SWING * np.sin(2 * angle))
    tension = TENSION * np.cos(angle) ** 2 + swing
    shear = SWING * abs(np.cos(2 * angle)) + K * tension
    assert criteria.findley(cycle, K) * math.hypot(1.0, K) == pytest.approx(shear.max(), rel=1e-6)
    product = (1.0 + NU) * swing * tension
    assert criteria.smith_watson_topper(cycle, NU) == pytest.approx(math.sqrt(product.max()), rel=1e-6)


def test_reversed_bending_and_torsion_are_endured_at_their_limits():
    """Constants from both limits make both tests damage alike."""
    shear, normal = 400.0, 640.0
    bend, twist = (Cycle(np.zeros((3, 3)), part) for part in (torsion(0.0, normal), torsion(shear)))
    k, a = findley_k(shear, normal), dang_van_a(shear, normal)
    for cycle in (bend, twist):
        assert criteria.findley(cycle, k) == pytest.approx(shear, rel=1e-6)
        assert criteria.dang_van(cycle, a) == pytest.approx(shear, rel=1e-9)
    assert criteria.smith_watson_topper(bend, NU) == pytest.approx(normal, rel=1e-6)
    with pytest.raises(ValueError, match="ratio"):
        findley_k(400.0, 900.0)


def test_a_search_over_all_planes_and_moments_finds_the_same(random):
    normals = brute.planes(2.0)
    found = {
        "findley": criteria.findley(random, K) * math.hypot(1.0, K),
        "dang_van": criteria.dang_van(random, A),
        "smith_watson_topper": criteria.smith_watson_topper(random, NU),
    }
    for number in range(3):
        path = brute.path(random.mean[number], random.amplitude[number], 9)
        for (name, values), constant in zip(found.items(), (K, A, NU), strict=True):
            searched = getattr(brute, name)(path, constant, normals)
            assert searched == pytest.approx(values[number], rel=1.5e-3)
            assert searched <= values[number] * (1.0 + 1e-6)


@pytest.mark.parametrize("name", CRITERIA)
def test_no_frame_is_special(random, name):
    Q, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    turned = Cycle(Q @ random.mean @ Q.T, Q @ random.amplitude @ Q.T)
    np.testing.assert_allclose(CRITERIA[name](turned), CRITERIA[name](random), rtol=2e-6)


def test_lives_lie_on_the_woehler_line():
    strength = Strength(400, None, 0.3, None, None, None, None, NU, 1e7, 8.0, 4.0, "a test")
    assert strength.lives(1.0) is None
    lives = strength.lives(0.5)
    assert lives["50"] == pytest.approx(1e7 / 2**8)
    assert lives["90"] / lives["10"] == pytest.approx(4.0)
