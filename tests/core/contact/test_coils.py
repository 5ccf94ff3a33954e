"""Wire on wire: exact derivatives, balance, symmetry, and where coils touch."""

import numpy as np
import pytest

from coilset.model.core.contact.base import TrialPositions
from coilset.model.core.contact.coils import Coils
from coilset.model.core.contact.curve import curve_weights

SEATS = np.zeros(12)


@pytest.fixture
def make_coils(points, helix):
    def make(bedding=1e3, onset=0.005, **wire):
        return Coils(points(**wire), helix(12.0), bedding, onset)

    return make


def energy(coils, x):
    """The integral of the force law with its onset: c p²/(4w), then c (p − w)."""
    pair, where, _ = coils.near(TrialPositions(x, SEATS))
    p, w = -where[:, 1], coils.onset
    soft, hard = np.minimum(p, 2 * w), np.maximum(p - 2 * w, 0.0)
    return float(coils.stiffness[pair[:, 0]] @ (soft**3 / (12 * w) + hard * (hard / 2 + w)))


@pytest.mark.parametrize("wire", [{}, {"thin": 2.2, "thick": 2.8}], ids=["even", "growing wire"])
@pytest.mark.parametrize("taper", [0.0, 1.5])
def test_forces_and_stiffness_are_derivatives_of_the_energy(make_coils, helix, dense, taper, wire):
    """Central differences with h = 1e-6 mm are good to some 1e-8 of curved functions on the scale of 0.01 mm."""
    coils, x = make_coils(**wire), helix(4.4, taper, seed=1, noise=0.02)
    f, K, part = dense(coils, x, SEATS)
    assert part.closed >= 40
    direction, h = np.random.default_rng(2).normal(size=x.shape), 1e-6
    slope = (energy(coils, x + h * direction) - energy(coils, x - h * direction)) / (2 * h)
    assert slope == pytest.approx(f[:-12] @ direction.ravel(), rel=1e-6)
    change = (dense(coils, x + h * direction, SEATS)[0] - dense(coils, x - h * direction, SEATS)[0]) / (2 * h)
    np.testing.assert_allclose(K[:, :-12] @ direction.ravel(), change, rtol=0, atol=1e-6 * np.abs(change).max())
    np.testing.assert_allclose(K, K.T, rtol=0, atol=1e-9 * np.abs(K).max())


def test_forces_are_in_balance(make_coils, helix, dense):
    """Contact is an inner force: its sum and its moment vanish, but for rounding of sums of some hundred terms."""
    x = helix(4.85, taper=1.0, seed=3, noise=0.02)
    f = dense(make_coils(), x, SEATS)[0][:-12].reshape(-1, 3)
    size = np.abs(f).max()
    assert size > 1.0
    np.testing.assert_allclose(f.sum(axis=0), 0.0, atol=1e-11 * size)
    np.testing.assert_allclose(np.cross(x, f).sum(axis=0), 0.0, atol=1e-10 * size)


def test_coils_upside_down_press_the_same(make_coils, helix, dense):
    """Neither coil is the master: the mirrored spring, its stations counted from the other end, has mirrored forces."""
    x = helix(4.9, seed=4, noise=0.01)
    f = dense(make_coils(), x, SEATS)[0][:-12].reshape(-1, 3)
    mirrored = dense(make_coils(), (x * [1, 1, -1])[::-1], SEATS)[0][:-12].reshape(-1, 3)
    np.testing.assert_allclose(mirrored[::-1] * [1, 1, -1], f, rtol=0, atol=1e-9 * np.abs(f).max())


def test_true_distance_of_the_coils_of_a_helix(make_coils, helix):
    """Coils of a helix are nearest not above each other but across the wire: distance p cos α but for terms of α⁴."""
    pitch = 4.9
    pair, where, _ = make_coils().near(TrialPositions(helix(pitch), SEATS), margin=0.5)
    slope = np.arctan(pitch / (2 * np.pi * 20.0))
    inside = (pair[:, 0] > 10) & (pair[:, 0] < 70) & (pair[:, 1] > 2) & (pair[:, 1] < 37)
    assert inside.sum() > 60
    np.testing.assert_allclose(where[inside, 1], pitch * np.cos(slope) - 5.0, atol=5e-4)


def test_coils_of_a_flat_cone_touch_sideways(make_coils, helix):
    """Turns that lie in one plane, 4.9 mm apart: the gap is −0.1 mm wherever one lies beside the other."""
    pair, where, p = make_coils().near(TrialPositions(helix(0.0, taper=4.9), SEATS))
    assert {0, 1} == {int(turn) for turn in make_coils().points.turns[pair[:, 0]] // 1.5}
    ρ = np.hypot(*p[pair[:, 0], :2].T)
    middle = (pair[:, 0] > 2) & (pair[:, 0] < 78) & (pair[:, 1] > 1) & (pair[:, 1] < 38)
    # a spiral of slope 4.9/(2π ρ): the distance of its arms is 4.9 cos of that; the smooth curve misses 6e-4 ρ
    np.testing.assert_allclose(where[middle, 1], 4.9 * np.cos(4.9 / (2 * np.pi * ρ[middle])) - 5.0, atol=0.012)


def test_open_coils_do_not_touch(make_coils, helix):
    assert make_coils().evaluate(TrialPositions(helix(5.1), SEATS)).closed == 0
    assert make_coils().max_penetration(TrialPositions(helix(5.1), SEATS)) == 0.0


def test_coils_that_lie_on_each_other_from_the_start_are_free_of_force(points, helix):
    """Closed ends: what overlaps in the stress-free state counts as touching."""
    x = helix(4.95)
    coils = Coils(points(), x, 1e3, 0.005)
    assert coils.evaluate(TrialPositions(x, SEATS)).closed == 0
    squeezed = TrialPositions(x * [1, 1, 0.99], SEATS)
    assert coils.evaluate(squeezed).closed > 40
    # 1 % of the pitch closer: 0.0495 mm but for the slope of the coils
    assert coils.max_penetration(squeezed) == pytest.approx(0.0495, rel=0.01)


def test_what_is_not_sought_does_not_touch(make_coils, helix, monkeypatch):
    """Coils that come nearer by small steps: as if they had been sought at each, and most of it is not."""
    coils, sought, near = make_coils(), [], Coils.near
    monkeypatch.setattr(Coils, "near", lambda self, *given: (sought.append(self is coils), near(self, *given))[1])
    pitches = np.linspace(7.0, 4.9, 90)
    for seed, pitch in enumerate(pitches):
        trial = TrialPositions(helix(pitch, seed=seed, noise=0.004), SEATS)
        found, expected = coils.evaluate(trial), make_coils().evaluate(trial)
        np.testing.assert_array_equal(found.dofs, expected.dofs)
        np.testing.assert_array_equal(found.forces, expected.forces)
    assert found.closed > 40
    assert sum(sought) < 25


def test_no_point_moves_farther_than_by_the_amplification(points):
    """The bound is met by the worst of all motions of the stations, each by 1 mm to and fro."""
    line = points(thin=2.2).line
    xi = np.linspace(0.0, 1.0, 201)
    weights = np.array([curve_weights(np.repeat(cubic[None], len(xi), 0), xi) for cubic in line.cubic])
    assert 1.0 < np.abs(weights).sum(axis=2).max() <= line.amplification() < 1.5
