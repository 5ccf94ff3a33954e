"""Polygons and curved placement against the compliance of the curved wire under an axial force."""

import numpy as np
import pytest
from scipy.integrate import quad

from coilset.meshes.springs.placement import gauss_points
from coilset.meshes.springs.spring import SpringSpec
from coilset.verification.spring_references.representation import polygon_nodes

ν = 0.3
ξ, W = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3), np.array([0.5, 0.5])


def compliance(position, tangent, length, wire):
    """∫ T²/GJ + M²/EI ds for the force 1 on the axis, times G π/32; the moment of the force is c × e_z."""
    moment = np.cross(position, [0, 0, 1.0])
    twist = np.sum(moment * tangent, axis=-1)
    bend2 = np.sum(moment**2, axis=-1) - twist**2
    return np.sum(W * length * (twist**2 + bend2 / (1 + ν)) / wire**4)


def of_polygon(nodes, wire):
    chord = np.diff(nodes, axis=0)
    length = np.linalg.norm(chord, axis=1)
    position = nodes[:-1, None] + chord[:, None] * ξ[:, None]
    return compliance(position, (chord / length[:, None])[:, None], length[:, None], wire)


def of_curve(spring, turns):
    position, tangent, length = gauss_points(spring, turns[:-1], turns[1:], ξ)
    return compliance(position, tangent, length, spring.wire_diameter(turns[:-1, None] + np.diff(turns)[:, None] * ξ))


@pytest.fixture(scope="module")
def cylinder():
    return SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=4, pitch=12.0).build()


@pytest.fixture(scope="module")
def helix_compliance():
    # cos α = πD/ds: the torque is F r cos α and the moment F r sin α; ds = √((πD)² + p²) for a turn
    speed = np.hypot(np.pi * 40, 12)
    sin, cos = 12 / speed, np.pi * 40 / speed
    return 4 * speed * 20**2 * (cos**2 + sin**2 / (1 + ν)) / 5**4


def test_inscribed_polygon_is_too_stiff_with_the_square_of_the_length(cylinder, helix_compliance):
    nodes = [polygon_nodes(cylinder, cylinder.stations(n)) for n in (16, 32, 64)]
    error = [1 - of_polygon(polygon, 5.0) / helix_compliance for polygon in nodes]
    # sinc(π/16) · (cos²(π/16) + sin²(π/16)/3.9) = 1 − 0.0345
    assert error[0] == pytest.approx(0.0345, abs=3e-4)
    np.testing.assert_allclose(np.log2(np.divide(error[:-1], error[1:])), 2, atol=0.05)


def test_polygon_of_the_wire_length(cylinder):
    nodes = polygon_nodes(cylinder, cylinder.stations(16), keep="length")
    length = np.linalg.norm(np.diff(nodes, axis=0), axis=1).sum()
    assert length == pytest.approx(cylinder.wire_length, rel=1e-12)


def test_polygon_of_the_same_compliance(cylinder, helix_compliance):
    # the factor leaves out the pitch, whose share is sin²α = 0.9 % here
    nodes = polygon_nodes(cylinder, cylinder.stations(16), keep="compliance", poisson=ν)
    assert of_polygon(nodes, 5.0) == pytest.approx(helix_compliance, rel=4e-4)


def test_curved_placement_is_exact_for_the_helix(cylinder, helix_compliance):
    assert of_curve(cylinder, cylinder.stations(16)) == pytest.approx(helix_compliance, rel=1e-12)


def test_curved_placement_converges_with_order_four():
    # r(t) = 30 − 3 t: the integrand is not constant; the reference by adaptive quadrature of the plain formulas
    cone = SpringSpec(
        wire_diameter=5.0, mean_diameter={"shape": "cone", "bottom": 60.0, "top": 30.0}, turns=5, pitch=14.0
    ).build()

    def integrand(t):
        r, ds = 30 - 3 * t, np.sqrt((2 * np.pi * (30 - 3 * t)) ** 2 + 9 + 14**2)
        cos = 2 * np.pi * r / ds
        return ds * r**2 * (cos**2 + (1 - cos**2) / (1 + ν)) / 5**4

    exact = quad(integrand, 0, 5, epsabs=0, epsrel=1e-13)[0]
    # few elements, so that the error stands above round-off; by hand, as a mesh takes four a turn or more
    error = [abs(of_curve(cone, np.linspace(0, 5, n + 1)) / exact - 1) for n in (2, 4, 8)]
    assert error[0] < 1e-4
    np.testing.assert_allclose(np.log2(np.divide(error[:-1], error[1:])), 4, atol=0.2)
