"""Gap elements between given stations, and stops on planes: the law of the onset, and exact derivatives."""

import numpy as np
import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.core.contact.base import TrialPositions, one_sided
from coilset.model.core.contact.elements import one_sided_at
from coilset.model.physics.guides.thesis_gaps import Gaps, gaps_one_turn_apart
from coilset.verification.stops import Stops

SEATS = np.zeros(12)
C, ONSET = 1e3, 0.05  # N/mm, mm
X = np.array([[0.0, 0, 0], [1.0, 2, 5], [0.3, 0.1, 4.9], [5.0, 0, 0], [9.0, 1, 1]])


def gaps():
    """Distances 5.477, 4.910 and 4.243 mm: open, within its onset, and beyond it."""
    return Gaps([[0, 1], [0, 2], [3, 4]], [5.4, 4.95, 4.5], C, ONSET)


def stops():
    """Planes across an oblique normal that the stations 1, 2 and 4 miss, touch within the onset, and sink deep into."""
    normal = np.array([2.0, -1.0, 2.0]) / 3.0
    return Stops([1, 2, 4], normal, X[[1, 2, 4]] @ normal + [-0.1, 0.03, 0.3], C, ONSET)


@pytest.mark.parametrize("make", [gaps, stops])
def test_stiffness_is_the_derivative_of_the_forces(dense, make):
    """Taylor's remainder f(x + h d) − f(x) − h K d is of second order."""
    contact, d = make(), np.random.default_rng(2).normal(size=X.shape)
    f, K, part = dense(contact, X, SEATS)
    assert part.closed == 2
    np.testing.assert_allclose(K, K.T, rtol=0, atol=1e-12 * np.abs(K).max())
    rests = []
    for h in 1e-3 * 2.0 ** -np.arange(4):
        rest = dense(contact, X + h * d, SEATS)[0] - f - h * K[:, :-12] @ d.ravel()
        rests.append(np.abs(rest).max())
    np.testing.assert_allclose(np.log2(np.divide(rests[:-1], rests[1:])), 2.0, atol=0.02)


@pytest.mark.parametrize("make", [gaps, stops])
def test_pressure_follows_the_law_of_the_onset(make):
    """c p²/(4 w) up to p = 2 w, c (p − w) beyond; open elements have no force."""
    contact = make()
    part = contact.evaluate(TrialPositions(X, SEATS))
    p = part.penetration
    assert p[0] < 0.0 < p[1] < 2 * ONSET < p[2]
    np.testing.assert_allclose(part.pressure, [0.0, C * p[1] ** 2 / (4 * ONSET), C * (p[2] - ONSET)], rtol=1e-12)


def test_gaps_push_their_stations_apart(dense):
    """Along the connection, with equal forces: forces are minus what acts on the stations."""
    f, _, part = dense(gaps(), X, SEATS)
    force = -f[:-12].reshape(-1, 3)
    along = (X[4] - X[3]) / np.linalg.norm(X[4] - X[3])
    np.testing.assert_allclose(force[4], part.pressure[2] * along, rtol=1e-12)
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-10)


def test_the_compiled_onset_is_that_of_the_arrays():
    """The latter takes complex gaps, for derivatives; the former stands in the compiled loops."""
    gaps = np.linspace(-5.0, 2.0, 29) * ONSET
    compiled = [one_sided_at(gap, C, ONSET) for gap in gaps]
    assert np.transpose(compiled) == pytest.approx(np.array(one_sided(gaps, C, ONSET)), rel=1e-14)


def test_gap_elements_join_stations_one_turn_apart():
    """2.3 turns in 37 elements: those one element farther on lie 7 mm aside, and never come as near as 5 mm."""
    helix = 2 * np.pi * 20.0

    def joined(elements):
        turns = np.linspace(0.0, 2.3, elements + 1)
        lengths = helix * np.diff(turns)
        return gaps_one_turn_apart(turns, np.full(elements + 1, 2.5), lengths, C, ONSET).pairs

    np.testing.assert_array_equal(joined(23), np.arange(14)[:, None] + [0, 10])
    with pytest.raises(InputError, match=r"^contact\.coils: gaps join nodes one turn apart, .* up to 0\.679 mm beside"):
        joined(37)
