"""The warning that contact is off by a coarse mesh, against the cubic through points of a circle."""

import numpy as np
import pytest

from coilset.model.core.case import check
from coilset.model.physics.accuracy.contact_fineness import coarse_mesh_warnings, distance

WIRE, DIAMETER, PITCH = 5.0, 40.0, 5.5


def spring(turns=3.0):
    entries = {"wire_diameter": WIRE, "mean_diameter": DIAMETER, "turns": turns, "pitch": PITCH}
    return check({"spring": entries, "loading": [{"to": "block"}]}).spring.build()


@pytest.mark.parametrize("elements", [6, 8, 16])
def test_distance_from_a_circle(elements):
    """In the first element the cubic's slopes are those of one parabola: its middle is 3/8, 6/8, −1/8 of three points.

    Round the axis the middle moves, too, but does not rise with it: off the wire by that times the sine of its slope.
    """
    angle = 2 * np.pi / elements
    points = 0.5 * DIAMETER * np.exp(1j * angle * np.arange(3))
    middle = np.dot([3 / 8, 6 / 8, -1 / 8], points) * np.exp(-0.5j * angle)
    found, turn = distance(spring(), np.arange(3 * elements + 1) / elements)
    slope = np.arctan2(PITCH, np.pi * DIAMETER)
    assert found == pytest.approx(np.hypot(middle.real - 0.5 * DIAMETER, middle.imag * np.sin(slope)) / WIRE, rel=3e-3)
    assert min(turn, 3.0 - turn) == pytest.approx(0.5 / elements)


def test_only_coarse_meshes_are_warned_of():
    meshes = {n: coarse_mesh_warnings(spring(), np.arange(3 * n + 1) / n) for n in (5, 16)}
    assert meshes[16] == []
    (warning,) = meshes[5]
    assert warning.name == "contact mesh"
    assert warning.value > warning.limit == 0.02
