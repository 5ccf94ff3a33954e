"""Wire on seats: exact derivatives, and where they bear."""

import numpy as np
import pytest

from coilset.model.core.contact.base import TrialPositions
from coilset.model.core.contact.seat import Seat

BEDDING, ONSET = 1e3, 0.005
LEVEL = np.array([0.0, 0, 0, 0, 0, 0, 0, 0, 6.05, 0, 0, 0])
TURNED = LEVEL + np.array([0.03, -0.02, 0, 1e-3, 2e-3, 5e-3, -0.04, 0.01, 0, -1e-3, 3e-3, -2e-3])


@pytest.fixture
def make_seat(points, helix):
    """A seat of the spring of pitch 9 whose axis begins at z = 2.5, where a wire of radius 2.5 mm touches z = 0."""

    def make(end, **kind):
        wire, x = points(), helix(9.0, lift=2.5)
        start = np.where(np.arange(12) == 8, 27.5, 0.0)
        return Seat(end, wire, wire.radius, x, start, BEDDING, ONSET, **kind)

    return make


KINDS = [{}, {"moves": True}, {"slope": 0.2}, {"slope": -0.1, "moves": True}, {"stepped": 0.7}]


@pytest.mark.parametrize("kind", KINDS, ids=str)
@pytest.mark.parametrize("end", ["bottom", "top"])
def test_stiffness_is_the_derivative_of_the_forces(make_seat, helix, dense, end, kind):
    """Within a long onset, so that no point comes to its end by the differences."""
    seat = make_seat(end, **kind)
    seat.onset = 0.5
    seats = TURNED if kind.get("moves") else LEVEL
    x = helix(0.5, seed=1, noise=0.01, lift=2.4)
    f, K, part = dense(seat, x, seats)
    assert part.closed >= 2
    direction, h = np.random.default_rng(2).normal(size=f.shape), 1e-7
    if not (kind.get("moves") or kind.get("slope")):
        direction[-12:] *= np.arange(12) % 6 == 2  # only levels are variables of such a seat
    u, v = h * direction[:-12].reshape(-1, 3), h * direction[-12:]
    moved = [dense(seat, x + s * u, seats + s * v)[0] for s in (1, -1)]
    change = (moved[0] - moved[1]) / (2 * h)
    np.testing.assert_allclose(K @ direction, change, rtol=0, atol=1e-6 * np.abs(change).max())
    np.testing.assert_allclose(K, K.T, rtol=0, atol=1e-12 * np.abs(K).max())


def test_a_flat_seat_supports_each_point_by_its_length_and_penetration(make_seat, helix):
    """Beyond the onset w the pressure is bedding · length · (penetration − w)."""
    seat = make_seat("bottom")
    x = helix(0.0, lift=2.48)
    part = seat.evaluate(TrialPositions(x, LEVEL))
    assert part.closed == 81
    np.testing.assert_allclose(part.penetration, 0.02, rtol=1e-12)
    bulk = part.point != 0  # the tip bears from the first touch
    np.testing.assert_allclose(part.pressure[bulk], BEDDING * seat.points.length[bulk] * 0.015, rtol=1e-12)
    np.testing.assert_allclose(part.forces[:, :-1].sum(axis=1), -part.pressure, rtol=1e-12)
    np.testing.assert_allclose(part.forces[:, -1], part.pressure, rtol=1e-12)


def test_a_stepped_seat_touches_the_unloaded_wire_over_its_turns(make_seat, helix):
    """0.7 turns of 16 elements with two points each: points 0 … 22 touch, the rest is above."""
    seat = make_seat("bottom", stepped=0.7)
    gap = seat.gaps(seat.points.at(helix(9.0, lift=2.5)), LEVEL)
    np.testing.assert_allclose(gap[:23], 0.0, atol=1e-12)
    assert np.all(gap[23:] > 0.1)


def test_a_conical_seat_acts_across_its_surface(make_seat, helix, dense):
    """A cone with tan β = 0.5: the force on the wire has a radial share tan β of its axial one, inwards; points between
    the stations, 6e-4 of the radius off the circle, share theirs out over neighbours that point elsewhere."""
    seat = make_seat("bottom", slope=0.5)
    x = helix(0.0, lift=2.48)
    f, _, part = dense(seat, x, LEVEL)
    assert part.closed == 81
    force = f[:-12].reshape(-1, 3)
    inner = slice(2, -2)
    e = x[inner, :2] / np.hypot(*x[inner, :2].T)[:, None]
    radial = (force[inner, :2] * e).sum(axis=1)
    # forces are minus what acts on the wire
    np.testing.assert_allclose(radial / -force[inner, 2], 0.5, rtol=5e-3)


def test_moments_on_a_tilting_seat_are_those_of_its_pressure(make_seat, helix):
    seat = make_seat("bottom", moves=True)
    part = seat.evaluate(TrialPositions(helix(0.0, lift=2.48), LEVEL))
    p = seat.points.at(helix(0.0))[part.point]
    np.testing.assert_allclose(part.forces[:, -3], part.pressure * p[:, 1], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(part.forces[:, -2], -part.pressure * p[:, 0], rtol=1e-9, atol=1e-9)
