"""Curvature, torsion and normal of the centre line, and how sections stand in it."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.meshes.springs.ends import OPEN
from coilset.meshes.springs.placement import section_placement
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check
from coilset.model.core.rotations.triads import chord_triads as triads

ABSCISSAE = np.array([0.2, 0.8])
CONE = {"shape": "cone", "bottom": 60.0, "top": 30.0}


def spring(diameter=40.0, **entries):
    entries = {"wire_diameter": 5.0, "mean_diameter": diameter, "turns": 5.0, "pitch": 14.0} | entries
    return SpringSpec(**entries).build()


@pytest.mark.parametrize("hand", ["right", "left"])
def test_helix(hand):
    wire, h = spring(hand=hand), 14.0 / (2 * np.pi)
    turn = np.linspace(0, 5, 7)
    sign = 1 if hand == "right" else -1
    np.testing.assert_allclose(wire.torsion(turn), sign * h / (20**2 + h**2), rtol=1e-12)
    vector = wire.curvature_vector(turn)
    np.testing.assert_allclose(np.linalg.norm(vector, axis=-1), 20 / (20**2 + h**2), rtol=1e-12)
    axis = wire.centre_line(turn)[:, :2] * -1
    np.testing.assert_allclose(vector[:, :2], axis / 20 * 20 / (20**2 + h**2), atol=1e-14)


def test_torsion_is_the_turning_of_the_binormal():
    """Of a cone, against differences of the binormal: db/ds = −τ n."""
    wire, turn, step = spring(CONE), np.array([0.7, 2.3, 4.1]), 1e-4

    def binormal(t):
        b = np.cross(wire.velocity(t), wire.acceleration(t))
        return b / np.linalg.norm(b, axis=-1, keepdims=True)

    rate = (binormal(turn + step) - binormal(turn - step)) / (2 * step) / wire.speed(turn)[:, None]
    normal = wire.curvature_vector(turn)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    np.testing.assert_allclose(wire.torsion(turn), -np.sum(rate * normal, axis=-1), rtol=1e-6)


@pytest.mark.parametrize("hand", ["right", "left"])
@pytest.mark.parametrize("shape", [40.0, CONE])
def test_sections_stand_with_y_along_the_normal(shape, hand):
    """Rows of P's lower right block are the section's axes in the chord's triad."""
    wire = spring(shape, hand=hand)
    turns = wire.stations(12)
    frame = triads(np.diff(wire.centre_line(turns), axis=0))
    place = section_placement(wire, turns, frame, ABSCISSAE, curved=True)
    axes = np.einsum("ngij,nkj->ngik", place.matrices[..., 3:, 3:] * place.stretch[..., None, None], frame)
    turn = turns[:-1, None] + np.diff(turns)[:, None] * ABSCISSAE
    np.testing.assert_allclose(axes[..., 0, :], wire.tangent(turn), atol=1e-12)
    np.testing.assert_allclose(place.curvature[..., None] * axes[..., 1, :], wire.curvature_vector(turn), atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(axes), 1, rtol=1e-12)
    np.testing.assert_allclose(place.curvature, wire.curvature(turn), rtol=1e-12)


def test_sections_that_know_of_no_curvature_stay_as_they_were():
    """Least turn from chord to tangent: no spin about the tangent, κ and τ zero."""
    wire = spring()
    turns = wire.stations(12)
    frame = triads(np.diff(wire.centre_line(turns), axis=0))
    place = section_placement(wire, turns, frame, ABSCISSAE)
    Q = np.swapaxes(place.matrices[..., 3:, 3:] * place.stretch[..., None, None], -1, -2)
    np.testing.assert_allclose(Q[..., 1, 2], Q[..., 2, 1], atol=1e-15)
    assert not place.curvature.any()
    assert not place.torsion.any()


class Straight:
    """A wire along x, as far as the placement asks."""

    bottom = top = OPEN

    def centre_line(self, turn):
        return np.stack([10.0 * np.asarray(turn), 0.0 * np.asarray(turn), 0.0 * np.asarray(turn)], axis=-1)

    def tangent(self, turn):
        return np.broadcast_to([1.0, 0.0, 0.0], (*np.shape(turn), 3))

    def speed(self, turn):
        return np.full(np.shape(turn), 10.0)

    def curvature_vector(self, turn):
        return np.zeros((*np.shape(turn), 3))

    def torsion(self, turn):
        return np.zeros(np.shape(turn))


def test_a_straight_wire_needs_no_normal():
    wire, turns = Straight(), np.linspace(0.0, 1.0, 4)
    place = section_placement(wire, turns, triads(np.diff(wire.centre_line(turns), axis=0)), ABSCISSAE, curved=True)
    np.testing.assert_allclose(place.matrices, np.tile(np.eye(6), (3, 2, 1, 1)), atol=1e-15)
    assert not place.curvature.any()


def test_points_that_bend_the_wire_sharper_than_it_is_thick_are_refused(tmp_path):
    """1 mm to and fro at 32 points a turn; the thesis's section, which knows of no curvature, takes them."""
    turn = np.arange(65) / 32
    radius = 20.0 + np.where(np.arange(65) % 2, 1.0, -1.0)
    angle, file = 2 * np.pi * turn, tmp_path / "points.csv"
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), 12.0 * turn], axis=1)
    np.savetxt(file, points, delimiter=",", header="x,y,z", comments="")
    data = {"spring": {"file": str(file), "wire_diameter": 5.0}, "loading": [{"to": {"travel": 1}}], "ends": "clamped"}
    with pytest.raises(InputError, match=r"spring: the wire of radius 2.5 mm is bent to a radius of 1\.\d+ mm"):
        Analysis(check(data), MPI.COMM_SELF)
    Analysis(check(data | {"mesh": {"section": {"kind": "plane"}}}), MPI.COMM_SELF)
