"""What all kinds of contact have in common: the protocols, and when a point counts as closed."""

import numpy as np
import pytest

from coilset.model.core.contact.base import TrialPositions
from coilset.model.core.contact.coils import Coils
from coilset.model.core.contact.seat import Seat
from coilset.model.physics.friction.friction import CoilFriction, SeatFriction
from coilset.model.physics.guides.hold import Groove, Mount
from coilset.model.physics.guides.thesis_gaps import Gaps
from coilset.verification.stops import Stops

LEVEL = np.where(np.arange(12) == 8, 27.5, 0.0)
PRESSED = np.where(np.arange(12) == 8, 12.2, 0.0)
ONSET = 0.005


@pytest.fixture
def kinds(points, helix):
    """One of each kind, on one wire."""

    def make(bedding=1e3):
        wire, x = points(), helix(9.0, lift=2.5)
        coils, seat = Coils(wire, x, bedding, ONSET), Seat("top", wire, wire.radius, x, LEVEL, bedding, ONSET)
        held = [Groove("top", wire, 0.7, x, bedding, LEVEL), Mount("top", len(x), np.ones(6), LEVEL)]
        frictions = [CoilFriction(coils, 0.1, x, LEVEL), SeatFriction(seat, 0.1, x, LEVEL)]
        gaps = [Gaps([[0, 16]], 5.0, bedding, ONSET), Stops([40], [[0.0, 0, -1]], -14.6, bedding, ONSET)]
        return [coils, seat, *held, *frictions, *gaps]

    return make


@pytest.fixture
def trial(helix):
    """The wire pressed until coils and seats overlap by tenths of a millimetre, narrower, and rotated a little."""
    return TrialPositions(helix(4.95, taper=0.05, lift=2.5), PRESSED, np.full((41, 3), 1e-3))


def test_kinds_say_what_they_do(kinds):
    made = kinds()
    assert {type(kind) for kind in made if kind.limits_step} == {Coils, Seat}
    assert {type(kind) for kind in made if kind.multiplier_offset is not None} == {Coils, Seat}
    assert {type(kind) for kind in made if kind.memory is not None} == {Coils, Seat, CoilFriction, SeatFriction}
    assert {type(kind) for kind in made if kind.needs_rotations} == {CoilFriction, SeatFriction}


def test_shapes_agree_and_the_last_equilibrium_stays(kinds, trial):
    """Each kind bears at this state; evaluation changes no committed array."""
    for kind in kinds():
        before = {k: v.equilibrium.copy() for k, v in kind.memory.state.items()} if kind.memory is not None else {}
        part = kind.evaluate(trial)
        m, k = part.dofs.shape
        assert part.forces.shape == (m, k), kind.name
        assert part.stiffness.shape == (m, k, k), kind.name
        assert {one.shape for one in (part.pressure, part.penetration, part.point, part.onset_force)} == {(m,)}
        assert np.abs(part.forces).max() > 0.0, kind.name
        if kind.limits_step:
            assert kind.max_penetration(trial) == part.penetration.max() > 0.0, kind.name
        for name, values in before.items():
            np.testing.assert_array_equal(kind.memory.committed(name), values, err_msg=kind.name)


def test_an_offset_presses_as_much_as_it_was_sunk_in(kinds, trial):
    """After `augment` the pressure is the law's at twice the penetration, until the memory goes back.

    Beyond the onset that is c (2 p − w), but for a seat's tip, which bears without an onset."""
    for kind in kinds():
        if kind.multiplier_offset is not None:
            before = kind.evaluate(trial)
            kind.augment(trial)
            after = kind.evaluate(trial)
            np.testing.assert_allclose(kind.multiplier_offset.max(), before.penetration.max(), rtol=1e-14)
            deep = np.argmax(np.where(before.point == getattr(kind, "tip", -1), 0.0, before.penetration))
            p = before.penetration[deep]
            assert p > 2 * ONSET
            found = after.pressure[after.point == before.point[deep]].max()
            c = before.onset_force[deep] / ONSET
            assert found == pytest.approx(c * (2 * p - ONSET), rel=1e-9), kind.name
            kind.memory.state.restore()
            np.testing.assert_array_equal(kind.evaluate(trial).pressure, before.pressure)


@pytest.mark.parametrize("bedding", [1e-6, 1e3, 1e9])
def test_what_counts_as_closed_does_not_hang_on_the_unit_of_force(kinds, trial, bedding):
    """By the law of the onset a point is closed from p = 4e-4 w on, whatever its stiffness."""
    counts = [kind.evaluate(trial).closed for kind in kinds(bedding)]
    assert counts == [kind.evaluate(trial).closed for kind in kinds(1.0)]
    assert counts[0] > 10
    stop = kinds(bedding)[-1]
    for share, closed in ((3.9e-4, 0), (4.1e-4, 1)):
        x = trial.x.copy()
        x[40, 2] = 14.6 + share * ONSET
        assert stop.evaluate(TrialPositions(x, PRESSED)).closed == closed
