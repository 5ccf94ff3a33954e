"""The gauge by which wires that are not round touch: closed forms, derivatives, and how they stand on each other."""

import numpy as np
import pytest

from coilset.meshes.sections.boundary import Boundary
from coilset.meshes.sections.shapes import Egg, Oval, rectangle
from coilset.model.core.contact.gauge import extremes, gauge
from coilset.model.physics.outlines.faces import gauge_table

HEIGHT = 5.0
OUT = 0.6, 0.8
WIRES = {"oval": Oval(4.0, 5.0), "rectangle": rectangle(8.0, 5.0, 0.5), "egg": Egg(2.5, 1.5, 1.6)}


def section(name, angle=0.0):
    boundary = Boundary.of(WIRES[name], angle)
    height = float(np.ptp(boundary.polygon[:, 1]))
    return boundary.moved(-0.5 * (boundary.low + boundary.high)).scaled(2.0 / height, 2.0 / height)


def at(q, table):
    """N, ∇N and ∇²N."""
    N, *rest = gauge(*q, *OUT, table)
    xx, xy, xz, yy, yz, zz = rest[3:]
    return N, np.array(rest[:3]), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def test_an_ellipse_scales_what_is_across():
    """N of a wire 4 wide and 5 high is |(5/4 q_r, q_t, q_z)| but for the part along the wire."""
    table = gauge_table(section("oval"))
    for q in np.random.default_rng(1).normal(size=(20, 3)):
        r, t = q[:2] @ OUT, q[:2] @ [-OUT[1], OUT[0]]
        assert at(q, table)[0] == pytest.approx(np.sqrt((1.25 * r) ** 2 + t**2 + q[2] ** 2), rel=2e-6)
    assert extremes(table) == pytest.approx((1.0, 1.25), rel=1e-4)


def test_a_flat_face_counts_its_distance():
    """Above the middle half of a rectangle N is the height, with no force aside, whatever the offset."""
    table = gauge_table(section("rectangle"))
    for aside in (0.0, 1.0, -4.0):
        N, slope, bend = at([OUT[0] * aside, OUT[1] * aside, 5.2], table)
        assert pytest.approx(5.2, rel=1e-9) == N
        assert slope == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)
        assert np.abs(bend[:, 2]).max() < 1e-6


@pytest.mark.parametrize("name", WIRES)
@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_wires_touch_where_the_gauge_is_their_height(name, angle):
    """The boundary of b − b′ by the block's rule, in wire heights: N = 2 r there, also of wire that is turned."""
    one = section(name, angle)
    table = gauge_table(one)
    for aside in (-1.0, -0.3, 0.0, 0.5, 1.1):
        height = float(one.touching(np.array(aside)))
        assert height > 0.1
        assert at([OUT[0] * aside, OUT[1] * aside, height], table)[0] == pytest.approx(2.0, rel=2e-4), aside


@pytest.mark.parametrize("name", WIRES)
def test_derivatives_of_the_gauge(name):
    """∇N and ∇²N by central differences, not near a corner's ends, where κ″ jumps."""
    table, step = gauge_table(section(name, 0.1)), 1e-5
    for q in np.random.default_rng(2).normal((0.0, 0.0, 3.0), size=(12, 3)):
        _, slope, bend = at(q, table)
        around = [(at(q + step * e, table), at(q - step * e, table)) for e in np.eye(3)]
        assert slope == pytest.approx([(a[0] - b[0]) / (2 * step) for a, b in around], abs=1e-8)
        np.testing.assert_allclose(bend, [(a[1] - b[1]) / (2 * step) for a, b in around], atol=2e-5)
