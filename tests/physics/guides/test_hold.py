"""Plates, grooves and mounts: exact derivatives, and a plate that turns with its wire sees it stay."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coilset.model.core.contact.base import TrialPositions
from coilset.model.core.contact.plate import Plate
from coilset.model.physics.guides.hold import Groove, Mount

SEATS = np.array([0.03, -0.02, 0.1, 1e-2, 2e-2, 5e-2, -0.04, 0.01, 27.5, -1e-2, 3e-2, -2e-2])
LEVEL = np.where(np.arange(12) == 8, 27.5, 0.0)


@pytest.mark.parametrize("end", ["bottom", "top"])
def test_groove_is_an_energy(points, helix, dense, end):
    """Forces are the slope of ½ c (s − s0)², stiffness is that of the forces; central differences with h = 1e-6."""
    groove = Groove(end, points(), 0.7, helix(9.0), 1e3, LEVEL)
    x, h, rng = helix(8.8, seed=1, noise=0.02), 1e-6, np.random.default_rng(3)

    def energy(x, seats):
        q = groove.plate.to_seat_frame(groove.wire.at(x)[groove.at], seats)
        s = np.append(np.hypot(*q[:-1, :2].T), q[-1] @ groove.along)
        return 0.5 * groove.stiffness @ (s - groove.start) ** 2

    direction = rng.normal(size=x.size + 12)
    u, v = direction[:-12].reshape(-1, 3), direction[-12:] * np.tile([1, 1, 1, 0.05, 0.05, 0.05], 2)
    direction = np.append(u, v)
    f, K, part = dense(groove, x, SEATS)
    assert part.closed == 0  # it is no contact in the count
    slope = (energy(x + h * u, SEATS + h * v) - energy(x - h * u, SEATS - h * v)) / (2 * h)
    assert slope == pytest.approx(f @ direction, rel=1e-7)
    change = (dense(groove, x + h * u, SEATS + h * v)[0] - dense(groove, x - h * u, SEATS - h * v)[0]) / (2 * h)
    np.testing.assert_allclose(K @ direction, change, rtol=0, atol=1e-7 * np.abs(change).max())


def test_a_wire_that_turns_with_its_plate_stays_where_it_was_in_its_frame(helix):
    """R(θ)ᵀ undoes the rotation by θ."""
    plate, x = Plate("top", 41), helix(9.0)
    θ = np.array([0.6, -0.7, 0.4])
    seats = np.concatenate([np.zeros(6), [1.0, 2.0, 3.0], θ])
    turned = Rotation.from_rotvec(θ).apply(x) + seats[6:9]
    np.testing.assert_allclose(plate.to_seat_frame(turned, seats), x, atol=1e-13 * 27.0)


def test_a_plate_in_a_rigid_motion_gets_balanced_forces(points, helix):
    """What the groove does to the wire it does in reverse to its plate: forces, and moments M about its centre.
    To the rotation vector belongs Jᵀ M, J = 1 + ½ [θ] + ⅙ [θ]² to the third order: 2e-5 for 0.05 rad."""
    groove = Groove("bottom", points(), 0.7, helix(9.0), 1e3, LEVEL)
    x = helix(8.8, seed=1, noise=0.02)
    for seats, within in ((LEVEL, 1e-12), (SEATS, 2e-5)):
        part = groove.evaluate(TrialPositions(x, seats))
        on_wire = -part.forces[:, :12].reshape(-1, 4, 3)
        at = x[part.dofs[:, :12:3] // 3]
        on_plate = -part.forces[:, 12:].sum(axis=0)
        np.testing.assert_allclose(on_wire.sum(axis=(0, 1)), -on_plate[:3], atol=1e-9 * np.abs(part.forces).max())
        moment = np.cross(at - seats[:3], on_wire).sum(axis=(0, 1))
        turning = np.cross(moment, seats[3:6])  # [θ]ᵀ M
        moment = moment + turning / 2 + np.cross(turning, seats[3:6]) / 6
        np.testing.assert_allclose(moment, -on_plate[3:], rtol=0, atol=within * np.abs(moment).max())


def test_a_mount_pushes_its_seat_back(dense, helix):
    mount = Mount("top", 41, [1.0, 2, 0, 30, 40, 50], LEVEL)
    f, K, _ = dense(mount, helix(9.0), SEATS)
    np.testing.assert_allclose(f[-6:], [1 * -0.04, 2 * 0.01, 0, 30 * -1e-2, 40 * 3e-2, 50 * -2e-2], rtol=1e-12)
    np.testing.assert_allclose(np.diag(K)[-6:], [1, 2, 0, 30, 40, 50])
    assert np.count_nonzero(f[:-6]) == 0
