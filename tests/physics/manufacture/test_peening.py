"""Peening at a section: closed forms of a straight bar and of a bent one, and a layer that yields."""

import numpy as np
import pytest
from scipy.integrate import quad

from coilset.model.core.material import library
from coilset.model.core.material.point.points import initial_state
from coilset.model.core.section.rules import polar, rim
from coilset.model.physics.manufacture.peening import Layer, peen, peening_warnings

RADIUS = 2.5
LAYER = Layer(np.array([0.0, 0.5, 1.5]), np.array([2e-3, 2.5e-3, 0.0]))


def peened(law, rule, bend=0.0, layer=LAYER):
    return peen(law.parameters(), rule, RADIUS, bend, bend > 0.0, initial_state(law, 1), layer)


def mean_strain():
    """⟨ε*⟩ = 2/R² ∫ ε* r dr."""
    breaks = RADIUS - LAYER.depth[1:]
    return quad(lambda r: 2.0 / RADIUS**2 * LAYER.at(RADIUS - r) * r, 0.0, RADIUS, points=breaks, epsrel=1e-12)[0]


def test_an_elastic_bar():
    """σ(r) = −E (ε*(r) − ⟨ε*⟩), at the section's points and at the surface, without shear."""
    law, rule = library.load("elastic"), polar(64, 8)
    rows = peened(law, rule)
    r = RADIUS * np.hypot(*np.concatenate([rule.points, rim()]).T)
    exact = -law.E * (LAYER.at(RADIUS - r) - mean_strain())
    np.testing.assert_allclose(rows[:, 0], exact, atol=1e-4 * np.abs(exact).max())
    assert np.abs(rows[:, 1:3]).max() < 1e-9 * law.E
    assert rows[-1, 0] == pytest.approx(-law.E * (2e-3 - mean_strain()), rel=5e-4)


def test_an_elastic_bent_bar():
    """A bent wire grows in all fibres alike, ε/(1 − κ y) with ε = ⟨ε*⟩ (1 − κ y): the stress of the straight one."""
    law, rule = library.load("elastic"), polar(64, 16)
    straight, bent = peened(law, rule), peened(law, rule, 0.1)
    np.testing.assert_allclose(bent, straight, atol=1e-6 * np.abs(straight).max())


def test_a_layer_that_yields():
    """Without hardening the layer bears no more than −σy, and the core σy f/(1 − f), with f its share of the area."""
    law, rule = library.load("ideal_plastic"), polar(16, 8)
    step = Layer(np.array([0.0, 0.5, 0.5001, 1.0]), np.array([0.02, 0.02, 0.0, 0.0]))
    inside = np.hypot(*rule.points.T) < 0.8
    rows = peened(law, rule, layer=step)
    f = rule.weights[~inside].sum()
    np.testing.assert_allclose(rows[: len(rule)][~inside, 0], -law.yield_stress, rtol=1e-6)
    np.testing.assert_allclose(rows[: len(rule)][inside, 0], law.yield_stress * f / (1.0 - f), rtol=1e-6)


def test_thin_layers_are_warned_of():
    thin, thick = Layer(np.array([0.0, 0.1]), np.array([1e-3, 0.0])), LAYER
    (found,) = peening_warnings(thin, polar(), RADIUS)
    assert found.message.startswith("the peened layer of 0.1 mm holds 1 of 8 rings of section points")
    assert not peening_warnings(thick, polar(), RADIUS)
