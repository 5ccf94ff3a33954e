"""Flat faces on seats and on each other: the line of contact has a width and carries a moment about the wire."""

import numpy as np
import pytest

from coilset.meshes.sections.boundary import Boundary
from coilset.meshes.sections.shapes import Oval, rectangle
from coilset.model.core.contact.base import TrialPositions
from coilset.model.physics.outlines.faces import FacedCoils, FacedSeat, arms_table, flat, seat_arms

WIDTH, HEIGHT, CORNER, BEDDING, ONSET = 8.0, 5.0, 0.5, 1e3, 1e-9
FACE = WIDTH - 2.0 * CORNER  # width of its flats, mm
SECTION = Boundary.of(rectangle(WIDTH, HEIGHT, CORNER)).scaled(2.0 / HEIGHT, 2.0 / HEIGHT)
LEVELS = np.zeros(12)


def tilted(x, slope):
    """Rotations about the wire of all stations, shape (n, 3), by which their outward directions rise."""
    out = x[:, :2] / np.hypot(x[:, 0], x[:, 1])[:, None]
    return slope * np.column_stack([out[:, 1], -out[:, 0], np.zeros(len(x))])


def moment(part, x, slope):
    """Work of the contact on the sections per unit of tilt, N mm; moments of elements on the rotations of stations."""
    first = x.size + 12
    turn = tilted(x, 1.0).ravel()
    on = part.dofs >= first
    return -float(np.sum(part.forces[on] * turn[part.dofs[on] - first]))


@pytest.fixture
def seat(points, helix):
    """The bottom seat of a flat ring of this wire, on which all of it bears."""
    wire, x = points(), helix(0.0, lift=2.5)
    arms = seat_arms(SECTION, np.full(len(wire), 2.5), wire.radius, 1.0)
    return FacedSeat("bottom", wire, wire.radius, x, LEVELS, BEDDING, ONSET, arms)


def test_a_block_pressed_with_a_tilt_carries_c_w3_12(seat, helix):
    """The moment is k w²/12 times the tilt, k the bedding of its length, and the force that of its middle."""
    pressed, slope = 0.02, 0.004
    x = helix(0.0, lift=2.5 - pressed)
    part = seat.evaluate(TrialPositions(x, LEVELS, tilted(x, slope)))
    k = seat.stiffness.sum()
    assert part.pressure.sum() == pytest.approx(k * pressed, rel=1e-4)
    assert moment(part, x, slope) == pytest.approx(-k * FACE**2 / 12.0 * slope, rel=1e-3)


def test_a_block_that_has_lifted_stands_on_its_edge(seat, helix):
    """Pressed in by less than the tilt lifts its middle: the resultant is at the lower edge."""
    slope = 0.02
    x = helix(0.0, lift=2.5 + 0.5 * FACE * slope - 0.005)
    part = seat.evaluate(TrialPositions(x, LEVELS, tilted(x, slope)))
    assert moment(part, x, slope) == pytest.approx(-0.5 * FACE * part.pressure.sum(), rel=1e-3)


@pytest.mark.parametrize(("aside", "width"), [(0.0, FACE), (3.0, FACE - 3.0), (-3.0, FACE - 3.0)])
def test_arms_of_two_faces(aside, width):
    """Rectangles on each other, one aside of the other: they touch where both are."""
    half, table = 0.5 * HEIGHT, arms_table(SECTION)
    α, directions = np.arctan2(HEIGHT, aside), np.pi * np.arange(len(table)) / (len(table) - 1)
    low, high = (half * np.interp(α, directions, one) for one in table.T)
    assert high - low == pytest.approx(width, abs=0.01)
    assert 0.5 * (low + high) == pytest.approx(-0.5 * aside, abs=0.01)


def test_an_oval_touches_in_a_point():
    """Its face has no width, below its centre line."""
    np.testing.assert_allclose(flat(Boundary.of(Oval(4.0, 5.0)), np.array([0.0, -1.0])), 0.0, atol=5e-3)


def test_coils_carry_the_moment_of_their_faces(points, helix):
    """Two coils, the upper one tilted: its moment is k w²/12 times the tilt, and that on the lower the opposite."""
    wire = points()
    coils = FacedCoils(wire, helix(5.0), BEDDING, ONSET, SECTION)
    x, slope = helix(4.95), 0.002
    upper = np.arange(41) >= 26  # stations; those of the lower coils that they press on do not tilt
    turned = tilted(x, slope) * upper[:, None]
    part, flat_part = (coils.evaluate(TrialPositions(x, LEVELS, one)) for one in (turned, np.zeros_like(turned)))
    f = np.zeros(2 * x.size + 12)
    for dofs, force in zip(part.dofs, part.forces, strict=True):
        np.add.at(f, dofs, force)
    by_station = np.sum(f[x.size + 12 :].reshape(-1, 3) * tilted(x, 1.0), axis=1)
    k = BEDDING * 2 * np.pi * 20.0 / 16
    assert by_station[32] == pytest.approx(k * FACE**2 / 12.0 * slope, rel=0.02)
    assert by_station[16] == pytest.approx(-by_station[32], rel=0.02)
    assert part.pressure.sum() == pytest.approx(flat_part.pressure.sum(), rel=1e-3)


def test_stiffness_of_coils_and_seats(points, helix, seat):
    """By differences, within a long onset; changes of arms and second derivatives of tilts are left out."""
    wire, random = points(), np.random.default_rng(3)
    coils = FacedCoils(wire, helix(5.4), BEDDING, 0.5, SECTION)
    seat.onset = 0.5
    for contact, x in ((coils, helix(4.8, taper=0.5, seed=1, noise=0.01)), (seat, helix(0.0, lift=2.45))):
        θ, direction = 0.004 * random.normal(size=x.shape), random.normal(size=2 * x.size + 12)
        direction[x.size : x.size + 12] = 0.0

        def forces(h, contact=contact, x=x, θ=θ, direction=direction):
            u, v = (h * part.reshape(-1, 3) for part in (direction[: x.size], direction[x.size + 12 :]))
            part = contact.evaluate(TrialPositions(x + u, LEVELS, θ + v))
            f, change = np.zeros(len(direction)), np.zeros(len(direction))
            for dofs, force, k in zip(part.dofs, part.forces, part.stiffness, strict=True):
                np.add.at(f, dofs, force)
                np.add.at(change, dofs, k @ direction[dofs])
            return f, change

        change = (forces(1e-6)[0] - forces(-1e-6)[0]) / 2e-6
        np.testing.assert_allclose(forces(0.0)[1], change, rtol=0, atol=0.03 * np.abs(change).max())
